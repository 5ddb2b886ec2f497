//! Which of several starts is carried on: each is tried on a coarse stand-in, and judged by what it comes to.

mod trial;

use mesh_core::{Positions, UnitFrame};
use mesh_init::{
    fit_affine, guide, point_pairs, FramePair, GuideConfig, GuideInput, PointPair, SimilarityPrior,
};
use neural_drape::{OverlapMode, Regions};
use rayon::prelude::*;

use crate::stand_in::StandIn;
use crate::{initial_deformation, Error, InitialMethod, InitialShape, Pair, Preset};
use trial::Trial;

/// Vertices of the stand-in that starts are tried on.
const N_VERTICES: usize = 1200;
/// Fewer landmarks do not say how the source is turned.
const ENOUGH_TO_TURN: usize = 3;
/// Another start is taken where it comes to less than this share of what the first comes to: among equals, the plain
/// deformation by landmarks is known to keep proportions.
const CLEARLY_BETTER: f64 = 0.9;

/// Where a drape starts, and what it leaves out.
pub(crate) struct Start {
    pub(crate) shape: InitialShape,
    /// What the settings ask for; both shapes whole where they leave that open and the trials say so.
    pub(crate) overlap: OverlapMode,
}

impl Start {
    /// The start that the settings name; for [`InitialMethod::Best`] the best of several.
    ///
    /// # Errors
    /// As [`initial_deformation`]; or no trial came to an end.
    pub(crate) fn choose(pair: &Pair, preset: &Preset, regions: &Regions) -> Result<Self, Error> {
        let first = initial_deformation(pair, preset.initial)?;
        let asked = preset.drape.overlap;
        if preset.initial != InitialMethod::Best {
            return Ok(Self {
                shape: first,
                overlap: asked,
            });
        }
        let stand_in = StandIn::with_vertices(pair, N_VERTICES)?;
        let starts = starts(pair, &stand_in, &first.positions)?;
        let regions = stand_in.regions(regions);
        let trials: Vec<Trial> = starts
            .par_iter()
            .map(|start| Trial::all(&stand_in.pair, preset, &regions, start))
            .collect::<Result<Vec<_>, Error>>()?
            .into_iter()
            .enumerate()
            .flat_map(|(row, trials)| trials.into_iter().map(move |t| Trial { start: row, ..t }))
            .collect();
        let best = best(&trials);
        if std::env::var("G_SHOW").is_ok() {
            for t in &trials {
                eprintln!("TRIAL {} {:?} cost {:.4} d {:.4} worst {:.4} left {:.3}", t.start, t.overlap, t.cost(), t.distortion, t.worst, t.left_out);
            }
        }
        let shape = match best.start {
            0 => first,
            row => InitialShape {
                positions: stand_in.carry(&starts[row]),
                ..first
            },
        };
        Ok(Self {
            shape,
            overlap: best.overlap,
        })
    }
}

/// The first trial, unless others are clearly better.
fn best(trials: &[Trial]) -> &Trial {
    let least = trials
        .iter()
        .min_by(|a, b| a.cost().total_cmp(&b.cost()))
        .unwrap_or(&trials[0]);
    if least.cost() < CLEARLY_BETTER * trials[0].cost() {
        least
    } else {
        &trials[0]
    }
}

/// Shapes of the stand-in to start from: that of the landmarks alone, then those that are led along the surfaces.
fn starts(pair: &Pair, stand_in: &StandIn, first: &Positions) -> Result<Vec<Positions>, Error> {
    let placed = similar(pair, first);
    let rest = stand_in.pick(&placed);
    let guided = [GuideConfig::stiff(), GuideConfig::soft()]
        .par_iter()
        .map(|config| {
            let input = GuideInput {
                triangulation: stand_in.pair.source.triangulation(),
                rest: &rest,
                landmarks: &stand_in.pair.landmarks,
                target: pair.target.draped_over().as_ref(),
            };
            guide(input, config)
        })
        .collect::<Result<Vec<Positions>, _>>()?;
    Ok(std::iter::once(stand_in.pick(first))
        .chain(guided)
        .collect())
}

/// The source turned, moved and scaled to its landmarks, or, where they are too few, to the shape `first`.
fn similar(pair: &Pair, first: &Positions) -> Positions {
    let rest = pair.source.rest();
    let pairs = if pair.landmarks.len() < ENOUGH_TO_TURN {
        let both = rest.iter().zip(first);
        both.map(|(&source, &target)| PointPair { source, target })
            .collect()
    } else {
        point_pairs(&pair.landmarks, rest)
    };
    let frames = FramePair {
        source: UnitFrame::principal(rest.as_slice()),
        target: pair.target.judged().principal_frame(),
    };
    let map = fit_affine(&pairs, frames, SimilarityPrior::Full);
    rest.map(|p| map.apply(p))
}
