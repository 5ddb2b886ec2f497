//! A drape in progress: stepped, paused, changed and resumed by whoever holds it.

use mesh_core::{Landmark, Positions};
use mesh_init::InitInput;
use mesh_metrics::Counterparts;
use neural_drape::network::NetworkMap;
use neural_drape::{
    Drape, DrapeConfig, DrapeError, DrapeInput, DrapeState, Regions, Repair, StepReport,
};

use crate::ending::{decided_overlap, left_out, repaired, Incomplete};
use crate::stages::{DRAPING, REFINING};
use crate::stand_in::StandIn;
use crate::start::{Expected, Search, Start};
use crate::symmetric::Opposites;
use crate::{
    BrushInput, Error, History, Moves, Note, Outcome, Pair, Population, Preset, Stages, Stroke,
};

/// Iterations on a dense source itself, after its stand-in was draped.
const N_REFINING: usize = 60;
/// A drape that is changed gets at least this share of the settings' iterations (the paper: 500 of 1500).
const MORE_ITERATIONS: (usize, usize) = (1, 3);

/// A drape in progress. It owns all it needs and can move to another thread ([`Self::spawn`] does so). Not stepping it is
/// a pause, dropping it cancels it.
///
/// A dense source is draped by a coarse stand-in first, which carries it, and is then refined itself: one run to whoever
/// steps it.
///
/// ```
/// use mesh_core::shapes;
/// use mesh_draping::{Preset, Seams, Source, Target, Transfer};
/// let source = Source::of_soup(shapes::quad_sphere(4), Seams::EXACT)?;
/// let target = Target::of_soup(shapes::icosphere(2))?;
/// let mut preset = Preset::quick();
/// preset.drape.stages.iter_mut().for_each(|stage| stage.n_iterations = 3);
/// let mut draping = Transfer::new(&source, &target, &[], preset).start()?;
/// while let Some(step) = draping.step()? {
///     println!("{} of {}: {}", step.iteration + 1, step.n_iterations, step.total);
/// }
/// let outcome = draping.finish()?;
/// assert_eq!(outcome.draped.len(), source.rest().len());
/// # Ok::<(), mesh_draping::Error>(())
/// ```
pub struct Draping {
    pair: Pair,
    preset: Preset,
    truth: Option<Positions>,
    regions: Regions,
    /// The source brought to its landmarks, in the target's coordinates.
    by_landmarks: Positions,
    /// Where it started, likewise.
    initial: Positions,
    drape: Drape,
    /// What is draped in the place of the source, as long as it is.
    stand_in: Option<StandIn>,
    /// Iterations of the stand-in, once the source itself is draped.
    n_before: usize,
    /// Iterations that come after the present drape.
    n_after: usize,
    /// What was assumed, and what the stand-in left out.
    notes: Vec<Note>,
    history: History,
    stages: Stages,
    /// What the target does not show is taken from these shapes at the end.
    prior: Option<Population>,
    /// Where the result shall be symmetric.
    opposites: Option<Opposites>,
}

/// What a drape starts from beside its pair.
pub(crate) struct Beginning {
    pub(crate) preset: Preset,
    pub(crate) regions: Regions,
    pub(crate) notes: Vec<Note>,
    pub(crate) truth: Option<Positions>,
    pub(crate) stages: Stages,
    pub(crate) expected: Expected,
    pub(crate) is_symmetric: bool,
    pub(crate) is_stand_in_allowed: bool,
}

impl Draping {
    /// Finds the initial deformation, and sets the drape up.
    pub(crate) fn start(pair: Pair, beginning: Beginning) -> Result<Self, Error> {
        let Beginning {
            preset,
            regions,
            mut notes,
            truth,
            mut stages,
            expected,
            is_symmetric,
            is_stand_in_allowed,
        } = beginning;
        let opposites = is_symmetric.then(|| Opposites::of(&pair.source));
        let opposites = opposites.transpose()?;
        pair.check_landmarks(&pair.landmarks)?;
        pair.check_lengths(&regions, truth.as_ref())?;
        expected.check(&pair)?;
        let is_dense = is_stand_in_allowed && StandIn::is_needed(&pair, &preset);
        let stand_in = is_dense.then(|| stages.time("stand-in", || StandIn::new(&pair)));
        let stand_in = stand_in.transpose()?;
        let draped_pair = stand_in.as_ref().map_or(&pair, |s| &s.pair);
        let on_stand_in = stand_in.as_ref().map(|s| s.regions(&regions));
        let first_regions = on_stand_in.unwrap_or_else(|| regions.clone());
        let search = Search {
            pair: &pair,
            stand_in: stand_in.as_ref(),
            preset: &preset,
            regions: &first_regions,
        };
        let Start {
            shape,
            by_landmarks,
            drape: config,
        } = stages.time("initial deformation", || Start::find(&search, &expected))?;
        let initial = shape.positions;
        notes.extend(shape.notes);
        let mut drape = stages.time_with_parts(DRAPING, |parts| {
            parts.time("set-up", || {
                set_up(draped_pair, config, &initial, &first_regions)
            })
        })?;
        expected.hold(&mut drape)?;
        let (by_landmarks, initial) = carried(stand_in.as_ref(), by_landmarks, initial);
        let mut draping = Self {
            by_landmarks,
            initial,
            n_after: if stand_in.is_some() { N_REFINING } else { 0 },
            n_before: 0,
            pair,
            preset,
            truth,
            regions,
            drape,
            stand_in,
            notes,
            history: History::default(),
            stages,
            prior: expected.into_population(),
            opposites,
        };
        draping.drape.set_profile(draping.stages.fresh_parts());
        Ok(draping)
    }

    /// One iteration; none when the run is over.
    ///
    /// # Errors
    /// The optimisation left the finite numbers.
    pub fn step(&mut self) -> Result<Option<StepReport>, Error> {
        let stage = self.stage();
        let drape = &mut self.drape;
        let step = match self.stages.time(stage, || drape.step())? {
            Some(step) => step,
            None if self.stand_in.is_some() => {
                self.refine()?;
                return self.step();
            }
            None => return Ok(None),
        };
        let step = StepReport {
            iteration: self.n_before + step.iteration,
            n_iterations: self.n_iterations(),
            ..step
        };
        self.history.record(&step);
        Ok(Some(step))
    }

    fn stage(&self) -> &'static str {
        match self.n_before {
            0 => DRAPING,
            _ => REFINING,
        }
    }

    /// The stand-in is draped: it carries the source, which is draped itself from now on.
    fn refine(&mut self) -> Result<(), Error> {
        let end = self.last_stage();
        let Some(stand_in) = self.stand_in.take() else {
            return Ok(());
        };
        self.notes.push(Note::StandIn {
            n_vertices: stand_in.n_vertices(),
            n_source: self.pair.source.rest().len(),
        });
        self.notes.extend(left_out(&self.drape));
        let overlap = decided_overlap(&self.drape, self.preset.drape.overlap);
        let config = DrapeConfig {
            overlap,
            ..self.preset.drape.refining(N_REFINING)
        };
        let carried = stand_in.carry(&end.positions);
        self.n_before = self.drape.n_iterations();
        self.n_after = 0;
        let (pair, regions) = (&self.pair, &self.regions);
        self.drape = self.stages.time_with_parts(REFINING, |parts| {
            parts.time("set-up", || set_up(pair, config, &carried, regions))
        })?;
        self.drape.set_profile(self.stages.fresh_parts());
        Ok(())
    }

    /// The last stage of the present drape; what its parts took is noted.
    fn last_stage(&mut self) -> Repair {
        let stage = self.stage();
        self.stages.add_parts(self.drape.profile());
        let drape = &self.drape;
        self.stages
            .time_with_parts(stage, |parts| parts.time("last stage", || drape.finish()))
    }

    /// How many iterations are done.
    pub fn iteration(&self) -> usize {
        self.n_before + self.drape.iteration()
    }

    /// How many iterations the run has.
    pub fn n_iterations(&self) -> usize {
        self.n_before + self.drape.n_iterations() + self.n_after
    }

    /// Whether no iteration is left.
    pub fn is_over(&self) -> bool {
        self.iteration() >= self.n_iterations()
    }

    /// Where the vertices of the source are now, in the target's coordinates; when the run is over, after its last stage.
    pub fn positions(&self) -> Positions {
        match &self.stand_in {
            Some(stand_in) => stand_in.carry(&self.drape.positions()),
            None if self.is_over() => self.drape.finish().positions,
            None => self.drape.positions(),
        }
    }

    /// Where the drape started, in the target's coordinates.
    pub fn initial(&self) -> &Positions {
        &self.initial
    }

    /// Source, target and the landmarks that hold now.
    pub fn pair(&self) -> &Pair {
        &self.pair
    }

    /// The settings.
    pub fn preset(&self) -> &Preset {
        &self.preset
    }

    /// What was assumed and decided so far.
    pub fn notes(&self) -> &[Note] {
        &self.notes
    }

    /// Which parts of either shape the run takes as having a counterpart on the other.
    pub fn counterparts(&self) -> Counterparts {
        let overlap = self.drape.overlap();
        let attraction = match &self.stand_in {
            Some(_) => &self.regions.attraction,
            None => self.drape.attraction(),
        };
        Counterparts {
            of_vertices: attraction.map(|&a| a > 0.0),
            target_ends: overlap.mesh_exceeds,
            mesh_ends: overlap.target_exceeds,
        }
    }

    /// The network that moves the vertices; none where there is none, or where it alone does not, as where the result is made
    /// symmetric.
    pub fn network(&self) -> Option<NetworkMap> {
        let is_alone = self.opposites.is_none();
        is_alone.then(|| self.drape.network()).flatten()
    }

    /// Goes on with other landmarks: they deform the present shape, and the run gets more iterations if few are left.
    ///
    /// Source: Mesh Draping, Interactive Mode.
    ///
    /// # Errors
    /// Landmarks that do not fit the source, or a deformation that cannot be solved for.
    pub fn set_landmarks(&mut self, landmarks: Vec<Landmark>) -> Result<(), Error> {
        self.pair.check_landmarks(&landmarks)?;
        let draped_pair = match &self.stand_in {
            Some(stand_in) => Pair {
                landmarks: stand_in.landmarks(&landmarks),
                ..stand_in.pair.clone()
            },
            None => Pair {
                landmarks: landmarks.clone(),
                ..self.pair.clone()
            },
        };
        let present = self.drape.positions();
        let moved = adjusted(&draped_pair, &present)?;
        self.drape.set_landmarks(&draped_pair.landmarks)?;
        let moves = moved.iter().zip(&present).map(|(m, p)| m - p);
        self.drape.displace(&moves.collect())?;
        if let Some(stand_in) = &mut self.stand_in {
            stand_in.pair = draped_pair;
        }
        self.pair.landmarks = landmarks;
        self.ensure_time();
        Ok(())
    }

    /// Goes on with other regions; the run gets more iterations if few are left.
    ///
    /// # Errors
    /// Not one entry per vertex of the source, or an attraction outside 0..=1.
    pub fn set_regions(&mut self, regions: Regions) -> Result<(), Error> {
        self.pair.check_lengths(&regions, None)?;
        self.treat(&regions)?;
        self.regions = regions;
        self.ensure_time();
        Ok(())
    }

    /// Hands the regions of the source to what is draped.
    fn treat(&mut self, regions: &Regions) -> Result<(), DrapeError> {
        match &self.stand_in {
            Some(stand_in) => self.drape.set_regions(&stand_in.regions(regions)),
            None => self.drape.set_regions(regions),
        }
    }

    /// Brushes the present shape, as [`Self::positions`] tells it; the drape goes on from there. Rigid regions stay as they
    /// are. What moved comes back, for [`Self::displace`] to take it back. The run gets no more iterations by this.
    ///
    /// # Errors
    /// A stroke whose numbers no brush has; nothing moved.
    pub fn brush(&mut self, stroke: &Stroke) -> Result<Moves, Error> {
        stroke.check()?;
        let mut brushed = self.positions();
        let input = BrushInput {
            pair: &self.pair,
            held: &self.regions.rigid,
        };
        stroke.apply(input, &mut brushed);
        let present = match &self.stand_in {
            Some(stand_in) => stand_in.carry(&self.drape.positions()),
            None => self.drape.positions(),
        };
        let moves = Moves::between(&present, &brushed);
        self.displace(&moves)?;
        Ok(moves)
    }

    /// Moves vertices, in the target's coordinates; the drape goes on from there.
    ///
    /// # Errors
    /// A move that is not finite; nothing moved.
    pub fn displace(&mut self, moves: &Moves) -> Result<(), Error> {
        let moves = moves.spread(self.pair.source.rest().len());
        match &self.stand_in {
            Some(stand_in) => self.drape.displace(&stand_in.moves(&moves))?,
            None => self.drape.displace(&moves)?,
        }
        Ok(())
    }

    /// Gives the run more iterations.
    pub fn extend(&mut self, n_iterations: usize) {
        self.drape.extend(n_iterations);
    }

    /// How many iterations a drape gets that is to go on: a third of those of its settings.
    pub fn n_more(preset: &Preset) -> usize {
        let n: usize = preset.drape.stages.iter().map(|s| s.n_iterations).sum();
        (n * MORE_ITERATIONS.0 / MORE_ITERATIONS.1).max(1)
    }

    /// What changed gets time to settle.
    fn ensure_time(&mut self) {
        let left = self.drape.n_iterations() - self.drape.iteration();
        let least = Self::n_more(&self.preset);
        if left < least {
            self.drape.extend(least - left);
        }
    }

    /// What the drape has come to, to go on from later with [`Self::restore`].
    pub fn state(&mut self) -> DrapeState {
        self.drape.state()
    }

    /// Goes on where a drape that started from the same had come to, with the landmarks and regions that held there.
    ///
    /// A source with a stand-in can be restored as long as the stand-in is draped.
    ///
    /// # Errors
    /// The state is that of another drape, or damaged; this drape is then of no more use.
    pub fn restore(
        &mut self,
        state: &DrapeState,
        landmarks: Vec<Landmark>,
        regions: Regions,
    ) -> Result<(), Error> {
        self.pair.check_landmarks(&landmarks)?;
        self.pair.check_lengths(&regions, None)?;
        match &mut self.stand_in {
            Some(stand_in) => {
                stand_in.pair.landmarks = stand_in.landmarks(&landmarks);
                self.drape.set_landmarks(&stand_in.pair.landmarks)?;
            }
            None => self.drape.set_landmarks(&landmarks)?,
        }
        if regions != self.regions {
            self.treat(&regions)?;
        }
        self.drape.restore(state)?;
        (self.pair.landmarks, self.regions) = (landmarks, regions);
        Ok(())
    }

    /// Ends the drape where it is: the last stage, the judge, the explanation.
    ///
    /// # Errors
    /// The result cannot be judged.
    pub fn finish(mut self) -> Result<Outcome, Error> {
        let end = self.last_stage();
        let draped = match &self.stand_in {
            Some(stand_in) => stand_in.carry(&end.positions),
            None => end.positions.clone(),
        };
        let draped = self.completed(draped);
        let draped = match &self.opposites {
            Some(opposites) => opposites.symmetrised(&draped),
            None => draped,
        };
        let is_refined = self.n_before > 0;
        if self.stand_in.is_none() {
            if !is_refined {
                self.notes.extend(left_out(&self.drape));
            }
            self.notes.extend(repaired(&end, &self.pair));
        }
        let report = {
            let (pair, truth) = (&self.pair, self.truth.as_ref());
            self.stages.time("figures", || pair.judge(&draped, truth))?
        };
        let counterparts = self.counterparts();
        let explanation = {
            let pair = &self.pair;
            self.stages.time("explanation", || {
                crate::explain::explain(pair, &draped, &report, &counterparts)
            })
        };
        Ok(Outcome {
            network: self.network(),
            pair: self.pair,
            preset: self.preset,
            by_landmarks: self.by_landmarks,
            initial: self.initial,
            draped,
            report,
            explanation,
            history: self.history,
            notes: self.notes,
            stages: self.stages,
        })
    }
}

impl Draping {
    /// The end of the source's own drape with what the target does not show as the prior expects it.
    fn completed(&mut self, draped: Positions) -> Positions {
        let prior = self.prior.as_ref().filter(|_| self.stand_in.is_none());
        let completion = prior.and_then(|population| {
            let end = Incomplete {
                pair: &self.pair,
                draped: &draped,
                counterparts: &self.counterparts(),
                regions: &self.regions,
            };
            end.completed(population)
        });
        let Some(completion) = completion else {
            return draped;
        };
        self.notes.push(Note::Completed {
            n_vertices: completion.n_moved,
            trust: completion.trust,
        });
        completion.positions
    }
}

/// Two shapes of what is draped first, which may be one, on the source.
fn carried(stand_in: Option<&StandIn>, a: Positions, b: Positions) -> (Positions, Positions) {
    match stand_in {
        Some(stand_in) => stand_in.carry_both(a, b),
        None => (a, b),
    }
}

/// The drape of a pair at its start.
pub(crate) fn set_up(
    pair: &Pair,
    config: DrapeConfig,
    initial: &Positions,
    regions: &Regions,
) -> Result<Drape, Error> {
    let input = DrapeInput {
        triangulation: pair.source.triangulation(),
        rest: pair.source.rest(),
        initial,
        target: pair.target.draped_over(),
        landmarks: &pair.landmarks,
    };
    let mut drape = Drape::new(input, config)?;
    if !regions.is_none() {
        drape.set_regions(regions)?;
    }
    Ok(drape)
}

/// The source of `pair` at `present`, deformed so that its landmarks come to their places.
///
/// # Errors
/// Landmarks that do not fit the source, or a deformation that cannot be solved for.
pub fn adjusted(pair: &Pair, present: &Positions) -> Result<Positions, Error> {
    let input = InitInput {
        triangulation: pair.source.triangulation(),
        rest: pair.source.rest(),
        landmarks: &pair.landmarks,
        target_frame: pair.target.judged().principal_frame(),
    };
    Ok(mesh_init::adjust(input, present)?)
}
