//! Which of several starts is carried on: each is tried on a coarse stand-in, and judged by what it comes to.

mod expected;
mod trial;

use mesh_core::{Landmark, Positions, UnitFrame};
use mesh_init::{
    fit_affine, point_pairs, FramePair, Guide, GuideConfig, GuideInput, InitError, SimilarityPrior,
};
use neural_drape::{DrapeConfig, Regions};
use rayon::prelude::*;

use crate::initial::ENOUGH_TO_STAND;
use crate::stand_in::StandIn;
use crate::{
    adjusted, initial_deformation, Draping, Error, InitialMethod, InitialShape, Pair, Population,
    Preset,
};
pub(crate) use expected::Expected;
use trial::Trial;

/// Vertices of the stand-in that starts are tried on.
const N_VERTICES: usize = 1200;
/// Where the best trial comes to more than this, a network leads one more: pairs that come to less end above Q 0.99 anyhow.
const POOR: f64 = 0.7;

/// What a start is searched for.
pub(crate) struct Search<'a> {
    pub(crate) pair: &'a Pair,
    /// What is draped first in the place of its source.
    pub(crate) stand_in: Option<&'a StandIn>,
    pub(crate) preset: &'a Preset,
    /// Those of what is draped first.
    pub(crate) regions: &'a Regions,
}

impl Search<'_> {
    /// The pair whose source is draped first.
    fn draped_pair(&self) -> &Pair {
        self.stand_in.map_or(self.pair, |s| &s.pair)
    }

    /// Whether starts are tried that the settings know.
    fn is_tried(&self) -> bool {
        matches!(
            self.preset.initial,
            InitialMethod::Tried | InitialMethod::TriedByVertices
        )
    }

    /// The shape of a population that fits best, brought to the landmarks; `near` tells how the target stands where
    /// landmarks do not.
    fn fitted(&self, population: &Population, near: &Positions) -> Result<Positions, Error> {
        let fitted = match self.stand_in {
            Some(stand_in) => stand_in.pick(&population.fit_near(self.pair, &stand_in.carry(near))),
            None => population.fit_near(self.pair, near),
        };
        brought(self.draped_pair(), &fitted)
    }
}

/// A shape that nearly fits, brought to the landmarks.
fn brought(pair: &Pair, shape: &Positions) -> Result<Positions, Error> {
    match pair.n_followed() {
        0 => Ok(shape.clone()),
        _ => adjusted(pair, shape),
    }
}

/// Where a drape starts, and with which settings it goes on from there.
pub(crate) struct Start {
    pub(crate) shape: InitialShape,
    /// The deformation by landmarks, before other starts were tried.
    pub(crate) by_landmarks: Positions,
    /// Those of the preset; where these leave open what lies beyond, and the trials say that nothing does, both shapes are
    /// whole.
    pub(crate) drape: DrapeConfig,
}

impl Start {
    /// The start for what is known of the result.
    ///
    /// # Errors
    /// As [`initial_deformation`] or [`adjusted`].
    pub(crate) fn find(search: &Search<'_>, expected: &Expected) -> Result<Self, Error> {
        match expected {
            Expected::Nothing => Self::choose(search, None),
            Expected::OneOf(population) => Self::choose(search, Some(population)),
            Expected::Nearly(shape) => Self::of_shape(search, shape, DrapeConfig::refining),
            Expected::Next(motion) => {
                Self::of_shape(search, &motion.before, DrapeConfig::following)
            }
        }
    }

    /// The start that the settings name; for [`InitialMethod::Tried`] and [`InitialMethod::TriedByVertices`], and where
    /// there is a population, the best of several.
    fn choose(search: &Search<'_>, population: Option<&Population>) -> Result<Self, Error> {
        let preset = search.preset;
        let shape = initial_deformation(search.draped_pair(), preset.initial)?;
        let mut start = Self {
            by_landmarks: shape.positions.clone(),
            shape,
            drape: preset.drape.clone(),
        };
        if search.is_tried() || population.is_some() {
            // What cannot be tried is passed over: the first start needs no trial.
            let _ = start.improve(search, population);
        }
        Ok(start)
    }

    /// A shape that nearly fits, brought to the landmarks, and the end of a run from there.
    fn of_shape(
        search: &Search<'_>,
        shape: &Positions,
        end_of: impl Fn(&DrapeConfig, usize) -> DrapeConfig,
    ) -> Result<Self, Error> {
        let preset = search.preset;
        let positions = brought(search.draped_pair(), shape)?;
        Ok(Self {
            by_landmarks: positions.clone(),
            shape: InitialShape {
                positions,
                notes: Vec::new(),
            },
            drape: end_of(&preset.drape, Draping::n_more(preset)),
        })
    }

    /// Tries this start, those that are led along the surfaces and that of a population, and becomes the best of them; where
    /// all are poor, a network leads the best of them once more.
    ///
    /// # Errors
    /// This start cannot be tried; nothing is changed.
    fn improve(
        &mut self,
        search: &Search<'_>,
        population: Option<&Population>,
    ) -> Result<(), Error> {
        let (pair, preset) = (search.draped_pair(), search.preset);
        let stand_in = StandIn::with_vertices(pair, N_VERTICES)?;
        let regions = stand_in.regions(search.regions);
        let first = stand_in.pick(&self.shape.positions);
        let trial = |start: Positions| -> Result<Tried, Error> {
            let trial = Trial::best(&stand_in.pair, preset, &regions, &start)?;
            Ok(Tried { start, trial })
        };
        let (own, mut others) = rayon::join(
            || trial(first),
            || -> Vec<Tried> {
                let starts = match search.is_tried() {
                    true => led(pair, &stand_in),
                    false => Vec::new(),
                };
                let trials: Vec<Result<Tried, Error>> = starts.into_par_iter().map(trial).collect();
                trials.into_iter().flatten().collect()
            },
        );
        let own = own?;
        // Where a part has no counterpart, a shape that fits the rest is no better start; that part is completed at the end.
        let prior = population.filter(|_| !own.trial.is_any_left_out);
        let fitted = prior.and_then(|p| search.fitted(p, &self.shape.positions).ok());
        others.extend(fitted.and_then(|x| trial(stand_in.pick(&x)).ok()));
        let cost = |tried: &&Tried| tried.trial.cost();
        let cheapest = |a: &&Tried, b: &&Tried| cost(a).total_cmp(&cost(b));
        let better = others
            .iter()
            .filter(|other| other.trial.is_better_start_than(&own.trial));
        let chosen = &better.min_by(cheapest).unwrap_or(&own).trial;
        let best = others.iter().chain([&own]).min_by(cheapest).unwrap_or(&own);
        // Without landmarks a smooth map drifts, and a rigid body is none to it.
        let can_lead = preset.initial == InitialMethod::Tried
            && pair.n_followed() >= ENOUGH_TO_STAND
            && regions.is_none();
        let guided = (can_lead && cost(&best) > POOR)
            .then(|| Trial::guided(&stand_in.pair, preset, &regions, &best.start));
        let guided = guided.and_then(Result::ok);
        let guided = guided.filter(|guided| guided.is_better_start_than(chosen));
        let taken = guided.as_ref().unwrap_or(chosen);
        if !std::ptr::eq(taken, &own.trial) {
            self.shape.positions = stand_in.carry(&taken.positions);
        }
        self.drape.overlap = taken.overlap;
        Ok(())
    }
}

/// A start of the stand-in, and what it came to.
struct Tried {
    start: Positions,
    trial: Trial,
}

/// Shapes of the stand-in that are led along the surfaces.
fn led(pair: &Pair, stand_in: &StandIn) -> Vec<Positions> {
    if pair.n_followed() < ENOUGH_TO_STAND {
        return Vec::new();
    }
    let rest = stand_in.pick(&similar(pair));
    let landmarks = Landmark::followed(&stand_in.pair.landmarks);
    let guide = Guide::new(GuideInput {
        triangulation: stand_in.pair.source.triangulation(),
        rest: &rest,
        landmarks: &landmarks,
        target: pair.target.draped_over().as_ref(),
    });
    let Ok(guide) = guide else {
        return Vec::new();
    };
    let configs = [GuideConfig::stiff(), GuideConfig::soft()];
    let starts: Vec<Result<Positions, InitError>> =
        configs.par_iter().map(|c| guide.start(c)).collect();
    starts.into_iter().flatten().collect()
}

/// The source turned, moved and scaled to its landmarks.
fn similar(pair: &Pair) -> Positions {
    let rest = pair.source.rest();
    let frames = FramePair {
        source: UnitFrame::principal(rest.as_slice()),
        target: pair.target.judged().principal_frame(),
    };
    let pairs = point_pairs(&pair.landmarks, rest);
    let map = fit_affine(&pairs, frames, SimilarityPrior::Full);
    rest.map(|p| map.apply(p))
}
