//! Which of several starts is carried on: each is tried on a coarse stand-in, and judged by what it comes to.

mod trial;

use mesh_core::{Positions, UnitFrame};
use mesh_init::{
    fit_affine, guide, point_pairs, FramePair, GuideConfig, GuideInput, SimilarityPrior,
};
use neural_drape::{DrapeConfig, DrapeError, Regions};
use rayon::prelude::*;

use crate::stand_in::StandIn;
use crate::{initial_deformation, Error, InitialMethod, InitialShape, Pair, Preset};
use trial::Trial;

/// Vertices of the stand-in that starts are tried on.
const N_VERTICES: usize = 1200;
/// Fewer landmarks do not say how the source is turned, nor where on the body a place is: no start is led by them.
const ENOUGH_TO_LEAD: usize = 3;
/// Another start is taken where it comes to less than this share of what the first comes to: among equals, the plain
/// deformation by landmarks is known to keep proportions.
const CLEARLY_BETTER: f64 = 0.9;
/// A start whose Dirichlet energy comes to more than this above that of the first is not taken: it is nearer because it is
/// stretched.
const MORE_DISTORTED: f64 = 0.05;

/// Where a drape starts, and with which settings it goes on from there.
pub(crate) struct Start {
    pub(crate) shape: InitialShape,
    /// Those of the preset; where these leave open what lies beyond, and the trials say that nothing does, both shapes are
    /// whole.
    pub(crate) drape: DrapeConfig,
}

impl Start {
    /// The start that the settings name; for [`InitialMethod::Best`] the best of several.
    ///
    /// # Errors
    /// As [`initial_deformation`]; or no trial came to an end.
    pub(crate) fn choose(pair: &Pair, preset: &Preset, regions: &Regions) -> Result<Self, Error> {
        let first = initial_deformation(pair, preset.initial)?;
        if preset.initial != InitialMethod::Best {
            return Ok(Self {
                shape: first,
                drape: preset.drape.clone(),
            });
        }
        // What cannot be tried is passed over: the first start needs no trial.
        let tried = Self::tried(pair, preset, regions, &first);
        Ok(tried.unwrap_or_else(|_| Self {
            shape: first,
            drape: preset.drape.clone(),
        }))
    }

    /// The best of several starts, `first` among them.
    fn tried(
        pair: &Pair,
        preset: &Preset,
        regions: &Regions,
        first: &InitialShape,
    ) -> Result<Self, Error> {
        let stand_in = StandIn::with_vertices(pair, N_VERTICES)?;
        let starts = starts(pair, &stand_in, &first.positions);
        let regions = stand_in.regions(regions);
        let trials: Vec<Result<Trial, Error>> = starts
            .par_iter()
            .map(|start| Trial::best(&stand_in.pair, preset, &regions, start))
            .collect();
        let mut trials = trials.into_iter();
        let Some(of_first) = trials.next().transpose()? else {
            return Err(DrapeError::NoArea.into());
        };
        let of_others: Vec<Trial> = trials.flatten().collect();
        let (best, is_first) = best(&of_first, &of_others.iter().collect::<Vec<_>>());
        let drape = DrapeConfig {
            overlap: best.overlap,
            ..preset.drape.clone()
        };
        let positions = if is_first {
            first.positions.clone()
        } else {
            stand_in.carry(&best.positions)
        };
        Ok(Self {
            shape: InitialShape {
                positions,
                notes: first.notes.clone(),
            },
            drape,
        })
    }
}

/// The trial from the first start unless that from one of the others is clearly better, and whether it is. Each start is
/// given by its own best trial.
fn best<'t>(of_first: &'t Trial, of_others: &[&'t Trial]) -> (&'t Trial, bool) {
    let limit = of_first.distortion + MORE_DISTORTED;
    let others = of_others.iter().filter(|t| t.distortion <= limit);
    match others.min_by(|a, b| a.cost().total_cmp(&b.cost())) {
        Some(other) if other.cost() < CLEARLY_BETTER * of_first.cost() => (other, false),
        _ => (of_first, true),
    }
}

/// Shapes of the stand-in to start from: that of the landmarks alone, then those that are led along the surfaces.
fn starts(pair: &Pair, stand_in: &StandIn, first: &Positions) -> Vec<Positions> {
    if pair.landmarks.len() < ENOUGH_TO_LEAD {
        return vec![stand_in.pick(first)];
    }
    let rest = stand_in.pick(&similar(pair));
    let guided: Vec<Option<Positions>> = [GuideConfig::stiff(), GuideConfig::soft()]
        .par_iter()
        .map(|config| {
            let input = GuideInput {
                triangulation: stand_in.pair.source.triangulation(),
                rest: &rest,
                landmarks: &stand_in.pair.landmarks,
                target: pair.target.draped_over().as_ref(),
            };
            guide(input, config).ok()
        })
        .collect();
    let guided = guided.into_iter().flatten();
    std::iter::once(stand_in.pick(first))
        .chain(guided)
        .collect()
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
