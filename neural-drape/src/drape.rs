//! The stepper: one engine for every parametrisation and every preset.

use std::sync::Arc;

use mesh_core::sampling::SeededRng;
use mesh_core::{
    Landmark, Positions, Profile, Triangulation, UnitFrame, Vector3, VertexData, VertexId,
};
use mesh_loss::{Beyond, HardCorners, Matches, Overlap, SurfaceMatcher};

use crate::config::{Descent, DrapeConfig};
use crate::coverage::{mark_uncovered, Pairing, Target, FAR_BEYOND, N_BEYOND};
use crate::input::{check_finite, check_landmarks};
use crate::network::NetworkMap;
use crate::objective::{self, DistanceLoss, StructuralLoss, TermReport};
use crate::regions::{Follow, Guidance, Regions};
use crate::schedule::{Stage, Weights};
use crate::setting::MAX_COUNT;
use crate::{DrapeError, DrapeInput, DrapeState, Parametrization, Repair};

/// So many times in a run, parts that nothing attracts follow the rest.
const N_FOLLOWS: usize = 5;

/// What one iteration did.
#[derive(Clone, Debug, PartialEq)]
pub struct StepReport {
    /// The iteration, counted from 0.
    pub iteration: usize,
    /// How many there are.
    pub n_iterations: usize,
    /// Each term before the step.
    pub terms: Vec<TermReport>,
    /// Eq. 1, `L = L_d + λ L_s`: Σ weight · value over the terms.
    pub total: f64,
}

/// A drape in progress. Dropping it cancels it; between steps it can be read and its landmarks changed.
///
/// It owns or shares all that it needs, so that a window or another thread can hold it.
pub struct Drape {
    config: DrapeConfig,
    frame: UnitFrame,
    parametrization: Box<dyn Parametrization>,
    landmarks: Vec<Landmark>,
    matcher: SurfaceMatcher,
    structure: StructuralLoss,
    beyond: Beyond,
    pairing: Pairing,
    triangulation: Arc<Triangulation>,
    rest: Arc<Positions>,
    /// In the unit frame.
    initial: Positions,
    is_uncovered: VertexData<bool>,
    guidance: Guidance,
    iteration: usize,
    n_iterations: usize,
    stage_starts: Vec<usize>,
    gradient: VertexData<Vector3>,
    rng: SeededRng,
    profile: Profile,
}

impl Drape {
    /// A drape at its start: [`Self::positions`] are the initial ones.
    ///
    /// # Errors
    /// Inputs of different lengths or of different meshes, a coordinate that is not finite, a mesh without area, a setting
    /// out of range or that asks for more memory than there is; settings that move a network where the cargo feature
    /// `network` is off.
    pub fn new(input: DrapeInput<'_>, config: DrapeConfig) -> Result<Self, DrapeError> {
        let (what, seed) = (config.parametrization.clone(), config.seed);
        Self::with_parametrization(input, config, |initial| {
            what.build(input.triangulation, initial, seed)
        })
    }

    /// A drape that moves its vertices by a map of your own; `config.parametrization` does not count.
    ///
    /// `make` is given the initial positions in the unit frame of the target, one per vertex; the positions of what it
    /// returns are in that frame, too.
    ///
    /// A drape that only shifts the source as a whole, by 3 parameters t: `x = x₀ + t`, `dL/dt = Σᵢ dL/dxᵢ`.
    ///
    /// ```
    /// use std::sync::Arc;
    /// use mesh_core::{shapes, Positions, TargetSurface, TriangleSoup, Triangulation, Vector3, VertexData};
    /// use neural_drape::{
    ///     Drape, DrapeConfig, DrapeError, DrapeInput, Parametrization, StateReader, StateWriter,
    /// };
    ///
    /// struct Shift(Positions);
    ///
    /// impl Parametrization for Shift {
    ///     fn positions(&self) -> &Positions {
    ///         &self.0
    ///     }
    ///     fn descend(&mut self, gradient: &VertexData<Vector3>, rate: f64) -> Result<(), DrapeError> {
    ///         let sum: Vector3 = gradient.iter().sum();
    ///         let step = sum.try_normalize(1e-12).unwrap_or_default() * rate;
    ///         self.0.iter_mut().for_each(|p| *p -= step);
    ///         Ok(())
    ///     }
    ///     fn set_progress(&mut self, _progress: f64) -> Result<(), DrapeError> {
    ///         Ok(())
    ///     }
    ///     fn displace(&mut self, displacements: &VertexData<Vector3>) {
    ///         self.0.iter_mut().zip(displacements).for_each(|(p, d)| *p += d);
    ///     }
    ///     fn save(&mut self, state: &mut StateWriter) {
    ///         state.points(&self.0);
    ///     }
    ///     fn restore(&mut self, state: &mut StateReader<'_>) -> Result<(), DrapeError> {
    ///         state.points(self.0.iter_mut())
    ///     }
    /// }
    ///
    /// let (mesh, rest) = shapes::quad_sphere(8).into_halfedge()?;
    /// let target: Arc<dyn TargetSurface> = Arc::new(TriangleSoup::new(shapes::icosphere(3))?);
    /// let input = DrapeInput {
    ///     triangulation: &Arc::new(Triangulation::new(&mesh, &rest)),
    ///     initial: &rest.map(|p| p + Vector3::new(0.3, 0.2, 0.0)),
    ///     rest: &Arc::new(rest),
    ///     target: &target,
    ///     landmarks: &[],
    /// };
    /// let start = |initial: &Positions| Ok(Box::new(Shift(initial.clone())) as Box<dyn Parametrization>);
    /// let mut drape = Drape::with_parametrization(input, DrapeConfig::quick(), start)?;
    /// while drape.step()?.is_some() {}
    /// let x = drape.positions();
    /// let centre = x.iter().map(|p| p.coords).sum::<Vector3>() / x.len() as f64;
    /// assert!(centre.norm() < 0.02);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As for [`Self::new`], and what `make` returns.
    pub fn with_parametrization(
        input: DrapeInput<'_>,
        config: DrapeConfig,
        make: impl FnOnce(&Positions) -> Result<Box<dyn Parametrization>, DrapeError>,
    ) -> Result<Self, DrapeError> {
        input.check()?;
        config.check()?;
        config.check_memory(input.rest.len())?;
        let frame = input.target.principal_frame();
        let initial = input.initial.map(|p| frame.to_unit(p));
        let parametrization = make(&initial)?;
        if parametrization.positions().len() != initial.len() {
            return Err(DrapeError::LengthMismatch {
                what: "the parametrization",
                found: parametrization.positions().len(),
                expected: initial.len(),
            });
        }
        let mut rng = SeededRng::new(config.seed);
        let mut matcher = SurfaceMatcher::new(input.triangulation, &initial, input.target, frame);
        let mut beyond = matcher.beyond(&initial, N_BEYOND, FAR_BEYOND, &mut rng);
        let n_iterations = config.stages.iter().map(|s| s.n_iterations).sum();
        let ends_openly = matcher.has_boundary();
        let pairing = Pairing::new(config.overlap, &beyond, ends_openly, n_iterations);
        let is_uncovered = mark_uncovered(
            input.triangulation,
            &initial,
            Target {
                surface: input.target.as_ref(),
                frame: &frame,
            },
            config.overlap,
            &mut beyond,
        );
        let none = Regions::none(initial.len());
        let guidance = Guidance::new(
            input.triangulation,
            input.rest,
            &initial,
            &none,
            &is_uncovered,
        );
        matcher.set_attraction(guidance.attraction());
        let mut drape = Self {
            beyond,
            pairing,
            is_uncovered,
            guidance,
            frame,
            parametrization,
            landmarks: Vec::new(),
            matcher,
            structure: StructuralLoss::new(input.triangulation, input.rest, &initial, &config),
            triangulation: Arc::clone(input.triangulation),
            rest: Arc::clone(input.rest),
            iteration: 0,
            stage_starts: config.stage_starts(),
            n_iterations,
            gradient: VertexData::new(initial.len(), Vector3::zeros()),
            initial,
            rng,
            profile: Profile::off(),
            config,
        };
        drape.set_landmarks(input.landmarks)?;
        Ok(drape)
    }

    /// One iteration; none when the run is over.
    ///
    /// # Errors
    /// The optimisation left the finite numbers.
    pub fn step(&mut self) -> Result<Option<StepReport>, DrapeError> {
        if self.is_finished() {
            return Ok(None);
        }
        let weights = self.config.weights_at(self.iteration);
        let rate = self
            .config
            .learning_rate
            .at(self.iteration, self.n_iterations);
        let progress = self.iteration as f64 / self.n_iterations as f64;
        self.profile.time("preconditioner", || {
            self.parametrization.set_progress(progress)
        })?;
        if self.stage_starts.contains(&self.iteration) {
            let x = self.parametrization.positions();
            self.structure.anchor(&self.triangulation, x);
        }

        let (overlap, mutual) = self.pairing.at(self.iteration, progress);
        let sampling = self.config.sampling.at(self.iteration, overlap, mutual);
        let x = self.parametrization.positions();
        let matches = self
            .matcher
            .resample(x, &sampling, &mut self.rng, &mut self.profile);
        self.guidance.note(&matches, self.pairing.overlap);

        // Eq. 1: L = L_d + λ L_s, the two descended in turn or as one sum.
        let distance = self.add_distance_loss(&matches, &weights);
        self.matcher.recycle(matches);
        if self.config.descent == Descent::Alternating {
            self.descend(rate)?;
        }
        let structure = self.add_structural_loss(&weights);
        self.descend(rate)?;

        self.iteration += 1;
        self.settle()?;
        Ok(Some(StepReport {
            iteration: self.iteration - 1,
            n_iterations: self.n_iterations,
            total: objective::total(&distance, &structure),
            terms: [distance, structure].concat(),
        }))
    }

    /// Where the vertices are now, in the target's coordinates.
    pub fn positions(&self) -> Positions {
        self.parametrization
            .positions()
            .map(|p| self.frame.from_unit(p))
    }

    /// Treats parts of the source as free or rigid from now on. Rigid ones take their shape at once.
    ///
    /// # Errors
    /// Not one entry per vertex, or an attraction outside 0..=1; nothing changed.
    pub fn set_regions(&mut self, regions: &Regions) -> Result<(), DrapeError> {
        regions.check(self.gradient.len())?;
        self.guidance = Guidance::new(
            &self.triangulation,
            &self.rest,
            &self.initial,
            regions,
            &self.is_uncovered,
        );
        self.matcher.set_attraction(self.guidance.attraction());
        self.settle()
    }

    /// Puts bodies and carried pieces where they belong.
    fn settle(&mut self) -> Result<(), DrapeError> {
        let period = (self.n_iterations / N_FOLLOWS).max(1);
        let is_end = self.is_finished();
        let follow = if is_end && self.pairing.overlap.mesh_exceeds {
            Follow::End
        } else if is_end {
            Follow::Pieces
        } else if self.iteration.is_multiple_of(period) {
            Follow::All
        } else {
            Follow::Bodies
        };
        let marked: Vec<VertexId> = self.marked().collect();
        let x = self.parametrization.positions();
        let correction = self.profile.time("regions", || {
            self.guidance
                .correction(&self.triangulation, x, follow, &marked)
        })?;
        if let Some(moves) = correction {
            self.parametrization.displace(&moves);
        }
        Ok(())
    }

    /// The vertices that landmarks hold.
    fn marked(&self) -> impl Iterator<Item = VertexId> + '_ {
        self.landmarks.iter().flat_map(|l| l.source.vertices)
    }

    /// The result: the positions, without the new folds and new skinny triangles that can be taken out if the settings
    /// ask for it ([`crate::repair`]). The drape stays as it is and can go on.
    pub fn finish(&self) -> Repair {
        let positions = self.positions();
        if self.config.repair {
            let held: Vec<VertexId> = self.marked().collect();
            crate::repair(&self.triangulation, &self.rest, &positions, &held)
        } else {
            let defects = crate::repair::defects(&self.triangulation, &self.rest, &positions);
            Repair {
                positions,
                left: defects.clone(),
                before: defects,
            }
        }
    }

    /// Replaces the landmarks from the next step on.
    ///
    /// # Errors
    /// A landmark names a vertex that is not there, or its place or target is not finite; the old landmarks stay.
    pub fn set_landmarks(&mut self, landmarks: &[Landmark]) -> Result<(), DrapeError> {
        check_landmarks(landmarks, self.gradient.len())?;
        self.landmarks = landmarks.to_vec();
        for landmark in &mut self.landmarks {
            landmark.target = self.frame.to_unit(&landmark.target);
        }
        Ok(())
    }

    /// Moves every vertex by its entry, in the target's coordinates; the optimiser keeps its state.
    ///
    /// Source: Mesh Draping, Interactive Mode, where landmarks that are added deform the present result.
    ///
    /// # Errors
    /// Not one finite displacement per vertex; nothing moved.
    pub fn displace(&mut self, displacements: &VertexData<Vector3>) -> Result<(), DrapeError> {
        if displacements.len() != self.gradient.len() {
            return Err(DrapeError::LengthMismatch {
                what: "the displacement",
                found: displacements.len(),
                expected: self.gradient.len(),
            });
        }
        check_finite("the displacement", displacements.iter())?;
        let scale = self.frame.scale;
        self.parametrization
            .displace(&displacements.map(|d| d / scale));
        let x = self.parametrization.positions();
        self.structure.anchor(&self.triangulation, x);
        Ok(())
    }

    /// Adds iterations to the run, with the weights that it would have ended with; vertices stay anchored where they
    /// were. A run has at most 10⁹ iterations.
    pub fn extend(&mut self, n_iterations: usize) {
        let n_iterations = n_iterations.min(MAX_COUNT.saturating_sub(self.n_iterations));
        if let Some(&Stage { to, .. }) = self.config.stages.last() {
            self.config.stages.push(Stage {
                n_iterations,
                from: to,
                to,
            });
            self.n_iterations += n_iterations;
        }
    }

    /// What the drape has come to, to go on from later with [`Self::restore`].
    pub fn state(&mut self) -> DrapeState {
        DrapeState::write(|state| {
            state.count(self.iteration);
            state.count(self.n_iterations);
            state.word_position(self.rng.word_position());
            let hard = self.matcher.hard_corners();
            state.counts(&hard.of_mesh);
            state.counts(&hard.of_target);
            state.points(self.structure.anchored_at());
            self.guidance.save(state);
            self.parametrization.save(state);
        })
    }

    /// Goes on where a drape of the same inputs and settings had come to. Landmarks stay those of this drape.
    ///
    /// # Errors
    /// The state is that of another drape, or damaged; this drape is then of no more use.
    pub fn restore(&mut self, state: &DrapeState) -> Result<(), DrapeError> {
        let mut reader = state.reader();
        let (iteration, n_iterations) = (reader.count()?, reader.count()?);
        let possible = self.n_iterations..=MAX_COUNT;
        if iteration > n_iterations || !possible.contains(&n_iterations) {
            return Err(DrapeError::ForeignState);
        }
        self.extend(n_iterations - self.n_iterations);
        self.iteration = iteration;
        self.rng.set_word_position(reader.word_position()?);
        let hard = HardCorners {
            of_mesh: reader.counts()?,
            of_target: reader.counts()?,
        };
        if !self.matcher.set_hard_corners(hard) {
            return Err(DrapeError::ForeignState);
        }
        let mut anchor = self.structure.anchored_at().clone();
        reader.points(anchor.iter_mut())?;
        self.structure.anchor(&self.triangulation, &anchor);
        self.guidance.restore(&mut reader)?;
        self.parametrization.restore(&mut reader)?;
        reader.finish()
    }

    /// The network behind the positions, as a map in the target's coordinates; none for explicit vertices, and once
    /// the vertices were displaced.
    pub fn network(&self) -> Option<NetworkMap> {
        let network = self.parametrization.network()?;
        Some(network.outside(&self.frame))
    }

    /// Measures from now on what each part of a step takes; [`Profile::off`] stops that.
    pub fn set_profile(&mut self, profile: Profile) {
        self.profile = profile;
    }

    /// What the parts of the steps took, by name: refit, sampling, closest points either way, every term by its own
    /// name, solves and step.
    pub fn profile(&self) -> &Profile {
        &self.profile
    }

    /// How many iterations are done.
    pub fn iteration(&self) -> usize {
        self.iteration
    }

    /// Whether the run is over: [`Self::step`] does nothing until it is extended.
    pub fn is_finished(&self) -> bool {
        self.iteration >= self.n_iterations
    }

    /// How many iterations the run has.
    pub fn n_iterations(&self) -> usize {
        self.n_iterations
    }

    /// How much of each shape lay beyond the other at the start.
    pub fn beyond(&self) -> Beyond {
        self.beyond
    }

    /// Whether parts of the mesh without a counterpart on the target are left out, beside those beyond its boundary.
    pub fn is_mesh_part_left_out(&self) -> bool {
        self.pairing.overlap.mesh_exceeds || self.is_uncovered.iter().any(|&u| u)
    }

    /// How strongly each vertex is attracted: what [`Regions`] say, and 0 where the target has no counterpart.
    pub fn attraction(&self) -> &VertexData<f64> {
        self.guidance.attraction()
    }

    /// Which parts beyond are left out.
    pub fn overlap(&self) -> Overlap {
        self.pairing.overlap
    }

    /// Adds dL_d/dx at the present positions (Eq. 2).
    fn add_distance_loss(&mut self, matches: &Matches, weights: &Weights) -> Vec<TermReport> {
        let loss = DistanceLoss::new(matches, &self.landmarks, &self.config);
        let x = self.parametrization.positions();
        let (gradient, profile) = (&mut self.gradient, &mut self.profile);
        objective::accumulate(&loss.terms(weights), x, gradient, profile)
    }

    /// Adds λ dL_s/dx at the present positions (Eq. 3).
    fn add_structural_loss(&mut self, weights: &Weights) -> Vec<TermReport> {
        let terms = self.structure.terms(weights);
        let x = self.parametrization.positions();
        objective::accumulate(&terms, x, &mut self.gradient, &mut self.profile)
    }

    /// One step of the optimiser against the gradient, which is zero afterwards.
    fn descend(&mut self, rate: f64) -> Result<(), DrapeError> {
        self.profile.time("solves and step", || {
            self.parametrization.descend(&self.gradient, rate)
        })?;
        let is_finite = |p: &mesh_core::Point3| p.coords.iter().all(|c| c.is_finite());
        if !self.parametrization.positions().iter().all(is_finite) {
            return Err(DrapeError::Diverged {
                iteration: self.iteration,
            });
        }
        self.gradient.iter_mut().for_each(|g| *g = Vector3::zeros());
        Ok(())
    }
}
