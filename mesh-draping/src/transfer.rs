//! What is to be draped over what, and how.

use mesh_core::{Landmark, Positions};
use neural_drape::{Regions, StepReport};

use crate::draping::Beginning;
use crate::start::Expected;
use crate::{Draping, Error, Outcome, Pair, Parts, Population, Preset, Source, Stages, Target};

/// What the frames of a motion came to so far, in the target's coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// The result of the first frame, which was draped like any other pair.
    pub first: Positions,
    /// The result of the frame before.
    pub before: Positions,
}

/// A drape that is about to begin.
///
/// ```no_run
/// use mesh_draping::{landmarks, Preset, Source, Target, Transfer};
/// let source = Source::read("horse.obj")?;
/// let target = Target::read("wolf.obj")?;
/// let landmarks = landmarks::read("pairs.json", &source, &target)?;
/// let outcome = Transfer::new(&source, &target, &landmarks, Preset::standard()).run()?;
/// outcome.write("draped.obj")?;
/// # Ok::<(), mesh_draping::Error>(())
/// ```
pub struct Transfer {
    pair: Pair,
    preset: Preset,
    parts: Parts,
    regions: Option<Regions>,
    truth: Option<Positions>,
    stages: Stages,
    expected: Expected,
    is_symmetric: bool,
    is_stand_in_allowed: bool,
}

impl Transfer {
    /// The source draped over the target, led by landmarks ([`crate::landmarks`]).
    pub fn new(source: &Source, target: &Target, landmarks: &[Landmark], preset: Preset) -> Self {
        let pair = Pair {
            source: source.clone(),
            target: target.clone(),
            landmarks: landmarks.to_vec(),
        };
        Self::of_pair(pair, preset)
    }

    /// The source of a pair draped over its target.
    pub fn of_pair(pair: Pair, preset: Preset) -> Self {
        Self {
            pair,
            preset,
            parts: Parts::default(),
            regions: None,
            truth: None,
            stages: Stages::off(),
            expected: Expected::Nothing,
            is_symmetric: false,
            is_stand_in_allowed: true,
        }
    }

    /// Parts of the source are treated in their own way. Without this, inner pieces are found and carried along.
    #[must_use]
    pub fn with_parts(self, parts: Parts) -> Self {
        Self { parts, ..self }
    }

    /// Vertices are treated in these ways; replaces [`Self::with_parts`].
    #[must_use]
    pub fn with_regions(self, regions: Regions) -> Self {
        Self {
            regions: Some(regions),
            ..self
        }
    }

    /// Where each vertex of the source belongs, to judge by; in the target's coordinates.
    #[must_use]
    pub fn with_truth(self, truth: Positions) -> Self {
        Self {
            truth: Some(truth),
            ..self
        }
    }

    /// What each stage takes is measured.
    #[must_use]
    pub fn with_stages(self, stages: Stages) -> Self {
        Self { stages, ..self }
    }

    /// The drape starts from a shape of the source that nearly fits, in the target's coordinates: the result of the frame
    /// before. Landmarks, where there are any, deform it as they deform a drape in progress ([`Draping::set_landmarks`]). No
    /// start is searched, and the run is the end of a whole one: as many iterations as a changed drape gets
    /// ([`Draping::n_more`]), at its last weights and finest steps.
    #[must_use]
    pub fn with_start(self, shape: Positions) -> Self {
        Self {
            expected: Expected::Nearly(shape),
            is_stand_in_allowed: false,
            ..self
        }
    }

    /// The drape is the next frame of a motion: it starts from the result of the frame before, as by [`Self::with_start`], and
    /// holds to the angles and areas of the first frame's result. The same body keeps these, so that they count more than
    /// between two bodies, and lead vertices back that slid along the surface ([`neural_drape::DrapeConfig::following`]).
    #[must_use]
    pub fn with_motion(self, motion: Motion) -> Self {
        Self {
            expected: Expected::Next(motion),
            is_stand_in_allowed: false,
            ..self
        }
    }

    /// The shape of a population that fits best ([`Population::fit`]) is one more start to try: where it comes out clearly
    /// better than the others and all of the source has a counterpart, by the trial that decides between them ([`InitialMethod::Tried`](crate::InitialMethod)), the
    /// drape starts there. At the end, what the target does not show is taken from the population, as far as that explains
    /// what the target shows and nothing folds.
    #[must_use]
    pub fn with_prior(self, population: Population) -> Self {
        Self {
            expected: Expected::OneOf(population),
            ..self
        }
    }

    /// The shape changes evenly along its surface from where the drape starts, by this weight: from the frame before, so that
    /// a motion trembles less, and limbs that turn lag behind ([`mesh_loss::SmoothChange`]). 50 is a good value.
    #[must_use]
    pub fn with_smooth_change(mut self, weight: f64) -> Self {
        self.preset.drape = self.preset.drape.with_smooth_change(weight);
        self
    }

    /// The result is as symmetric as the source: at the end, each vertex goes to the middle between itself and the mirror
    /// image of its opposite, across the plane that lies between them. Where the target is not symmetric, the result
    /// leaves it by as much.
    #[must_use]
    pub fn symmetric(self) -> Self {
        Self {
            is_symmetric: true,
            ..self
        }
    }

    /// A dense source is draped itself, without a coarse stand-in.
    #[must_use]
    pub fn without_stand_in(self) -> Self {
        Self {
            is_stand_in_allowed: false,
            ..self
        }
    }

    /// Finds the initial deformation and sets the drape up, to be stepped.
    ///
    /// # Errors
    /// Landmarks, parts or a start that do not fit the source, a source that shall come out symmetric and is not, a setting out of range, a deformation that cannot be solved for.
    pub fn start(self) -> Result<Draping, Error> {
        let (regions, notes) = match self.regions {
            Some(regions) => (regions, Vec::new()),
            None => {
                let resolved = self.parts.resolve(&self.pair)?;
                (resolved.regions, resolved.notes)
            }
        };
        let beginning = Beginning {
            preset: self.preset,
            regions,
            notes,
            truth: self.truth,
            stages: self.stages,
            expected: self.expected,
            is_symmetric: self.is_symmetric,
            is_stand_in_allowed: self.is_stand_in_allowed,
        };
        Draping::start(self.pair, beginning)
    }

    /// The whole drape.
    ///
    /// # Errors
    /// As [`Self::start`]; or the optimisation left the finite numbers.
    pub fn run(self) -> Result<Outcome, Error> {
        self.run_with(|_| ())
    }

    /// The whole drape; `show` sees every step.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn run_with(self, mut show: impl FnMut(&StepReport)) -> Result<Outcome, Error> {
        let mut draping = self.start()?;
        while let Some(step) = draping.step()? {
            show(&step);
        }
        draping.finish()
    }
}
