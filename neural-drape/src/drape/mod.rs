//! The stepper: one engine for every parametrisation and every preset.

mod changes;
mod resume;

use std::sync::{Arc, Mutex, PoisonError};

use mesh_core::sampling::SeededRng;
use mesh_core::{
    Landmark, Positions, Profile, Triangulation, UnitFrame, Vector3, VertexData, VertexId,
};
use mesh_loss::{Beyond, Matches, Overlap, SurfaceMatcher};

use crate::config::{Descent, DrapeConfig};
use crate::contact::Apart;
use crate::coverage::{mark_uncovered, Pairing, Target, FAR_BEYOND, N_BEYOND};
use crate::input::check_length;
use crate::network::{NetworkMap, Shapes};
use crate::objective::{self, DistanceLoss, StructuralLoss, TermReport};
use crate::regions::{Follow, Guidance, Regions};
use crate::schedule::Weights;
use crate::{Crossings, DrapeError, DrapeInput, Fit, Parametrization, Repair};

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
    apart: Option<Apart>,
    iteration: usize,
    n_iterations: usize,
    stage_starts: Vec<usize>,
    gradient: VertexData<Vector3>,
    rng: SeededRng,
    profile: Profile,
    /// What [`Self::finish`] came to when it was asked last.
    ended: Mutex<Option<End>>,
}

/// The last stage, and what it was computed from.
struct End {
    positions: Positions,
    held: Vec<VertexId>,
    repair: Repair,
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
            let rest = input.rest;
            what.build(input.triangulation, Shapes { rest, initial }, seed)
        })
    }

    /// A drape that moves its vertices by a map of your own; `config.parametrization` does not count.
    ///
    /// `make` is given the initial positions in the unit frame of the target, one per vertex; the positions of what it
    /// returns are in that frame, too. [`Parametrization`] has an example.
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
        let n_moved = parametrization.positions().len();
        check_length("the parametrization", n_moved, initial.len())?;
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
            apart: config
                .contact
                .map(|contact| Apart::new(contact, input.triangulation, input.rest)),
            triangulation: Arc::clone(input.triangulation),
            rest: Arc::clone(input.rest),
            iteration: 0,
            stage_starts: config.stage_starts(),
            n_iterations,
            gradient: VertexData::new(initial.len(), Vector3::zeros()),
            initial,
            rng,
            profile: Profile::off(),
            ended: Mutex::default(),
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
        if let Some(position) = self.config.sampling.draws_from(self.iteration) {
            self.rng.set_word_position(position);
        }
        let x = self.parametrization.positions();
        let matches = self
            .matcher
            .resample(x, &sampling, &mut self.rng, &mut self.profile);
        self.guidance.note(&matches, self.pairing.overlap);

        // Eq. 1: L = L_d + λ L_s, the two descended in turn, each with the penalty of Eq. 4, or as one sum.
        let distance = self.add_distance_loss(&matches, &weights);
        self.matcher.recycle(matches);
        if self.config.descent == Descent::Alternating {
            self.add_skinny_penalty(&weights);
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

    /// The vertices that landmarks hold; a curve leads its vertices, but holds none of them.
    fn marked(&self) -> impl Iterator<Item = VertexId> + '_ {
        let marked = self.landmarks.iter().filter(|l| l.curve.is_none());
        marked.flat_map(|l| l.source.vertices)
    }

    /// What the last stage leaves where it is: vertices of landmarks and of rigid bodies.
    fn held(&self) -> Vec<VertexId> {
        self.marked().chain(self.guidance.rigid()).collect()
    }

    /// The result: the positions, without the new folds, skinny triangles and crossings that can be taken out if the settings
    /// ask for it ([`crate::repair`]). The drape stays as it is and can go on. Asked again, it is not computed again.
    ///
    /// Crossings stay in a shape that was moved by [`Self::displace`] after the last step: it is as someone wants it.
    pub fn finish(&self) -> Repair {
        let positions = self.positions();
        let held = self.held();
        let mut last = self.ended.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(end) = last.as_ref() {
            if end.positions == positions && end.held == held {
                return end.repair.clone();
            }
        }
        let repair = self.last_stage(&positions, &held);
        *last = Some(End {
            repair: repair.clone(),
            positions,
            held,
        });
        repair
    }

    fn last_stage(&self, positions: &Positions, held: &[VertexId]) -> Repair {
        if !self.config.repair {
            let defects = crate::repair::defects(&self.triangulation, &self.rest, positions);
            return Repair {
                positions: positions.clone(),
                left: defects.clone(),
                before: defects,
            };
        }
        let is_placed = self.structure.anchored_at() == self.parametrization.positions();
        let crossings = if is_placed {
            Crossings::Stay
        } else {
            Crossings::Part(Some(Fit {
                target: self.matcher.target().as_ref(),
                attraction: self.attraction(),
            }))
        };
        crate::repair(&self.triangulation, &self.rest, positions, held, crossings)
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

    /// Adds the gradient of the penalty on skinny triangles at the present positions (Eq. 4).
    fn add_skinny_penalty(&mut self, weights: &Weights) {
        let terms = [self.structure.skinny(weights)];
        let x = self.parametrization.positions();
        objective::accumulate(&terms, x, &mut self.gradient, &mut self.profile);
    }

    /// Adds λ dL_s/dx at the present positions (Eq. 3), and the penalty of Eq. 4.
    fn add_structural_loss(&mut self, weights: &Weights) -> Vec<TermReport> {
        let x = self.parametrization.positions();
        if let Some(apart) = &mut self.apart {
            let (done, all) = (self.iteration, self.n_iterations);
            self.profile
                .time("contact search", || apart.update(done, all, x));
        }
        let mut terms = self.structure.terms(weights).to_vec();
        terms.extend(self.apart.as_ref().map(Apart::term));
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
