//! Which of several starts is carried on: each is tried on a coarse stand-in, and judged by what it comes to.

mod trial;

use mesh_core::{Positions, UnitFrame};
use mesh_init::{
    fit_affine, point_pairs, FramePair, Guide, GuideConfig, GuideInput, InitError, SimilarityPrior,
};
use neural_drape::{DrapeConfig, Regions};
use rayon::prelude::*;

use crate::initial::ENOUGH_TO_STAND;
use crate::stand_in::StandIn;
use crate::{initial_deformation, Error, InitialMethod, InitialShape, Pair, Preset};
use trial::Trial;

/// Vertices of the stand-in that starts are tried on.
const N_VERTICES: usize = 1200;

/// Where a drape starts, and with which settings it goes on from there.
pub(crate) struct Start {
    pub(crate) shape: InitialShape,
    /// Those of the preset; where these leave open what lies beyond, and the trials say that nothing does, both shapes are
    /// whole.
    pub(crate) drape: DrapeConfig,
}

impl Start {
    /// The start that the settings name; for [`InitialMethod::Tried`] the best of several.
    ///
    /// # Errors
    /// As [`initial_deformation`].
    pub(crate) fn choose(pair: &Pair, preset: &Preset, regions: &Regions) -> Result<Self, Error> {
        let mut start = Self {
            shape: initial_deformation(pair, preset.initial)?,
            drape: preset.drape.clone(),
        };
        if preset.initial == InitialMethod::Tried {
            // What cannot be tried is passed over: the first start needs no trial.
            let _ = start.improve(pair, preset, regions);
        }
        Ok(start)
    }

    /// Tries this start and those that are led along the surfaces, and becomes the best of them.
    ///
    /// # Errors
    /// This start cannot be tried; nothing is changed.
    fn improve(&mut self, pair: &Pair, preset: &Preset, regions: &Regions) -> Result<(), Error> {
        let stand_in = StandIn::with_vertices(pair, N_VERTICES)?;
        let regions = stand_in.regions(regions);
        let trial = |start: &Positions| Trial::best(&stand_in.pair, preset, &regions, start);
        let (own, led) = rayon::join(
            || trial(&stand_in.pick(&self.shape.positions)),
            || -> Vec<Trial> {
                let led = led(pair, &stand_in);
                let trials: Vec<Result<Trial, Error>> = led.par_iter().map(trial).collect();
                trials.into_iter().flatten().collect()
            },
        );
        let own = own?;
        let better = led
            .iter()
            .filter(|led| led.is_better_start_than(&own))
            .min_by(|a, b| a.cost().total_cmp(&b.cost()));
        if let Some(better) = better {
            self.shape.positions = stand_in.carry(&better.positions);
        }
        self.drape.overlap = better.unwrap_or(&own).overlap;
        Ok(())
    }
}

/// Shapes of the stand-in that are led along the surfaces.
fn led(pair: &Pair, stand_in: &StandIn) -> Vec<Positions> {
    if pair.landmarks.len() < ENOUGH_TO_STAND {
        return Vec::new();
    }
    let rest = stand_in.pick(&similar(pair));
    let guide = Guide::new(GuideInput {
        triangulation: stand_in.pair.source.triangulation(),
        rest: &rest,
        landmarks: &stand_in.pair.landmarks,
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
