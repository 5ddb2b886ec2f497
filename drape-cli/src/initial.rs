//! Where a drape starts: the initial deformation, chosen by name.

use mesh_core::Positions;
use mesh_init::{initialize, InitConfig, InitInput};
use serde::{Deserialize, Serialize};

use crate::input::Pair;

/// How the source is brought to its landmarks before it is draped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Start {
    /// Affine, then rotations and scales spread from the landmarks: least distortion
    Standard,
    /// The paper's: affine, then a biharmonic field
    Paper,
    /// The affine map alone
    Affine,
}

impl Start {
    /// The start that belongs to a preset.
    pub(crate) fn of_preset(preset: &str) -> Self {
        if preset == "paper" {
            Self::Paper
        } else {
            Self::Standard
        }
    }
}

/// The source of `pair`, brought to its landmarks.
pub(crate) fn deform(pair: &Pair, start: Start) -> anyhow::Result<Positions> {
    let input = InitInput {
        mesh: &pair.source.mesh,
        rest: &pair.source.rest,
        landmarks: &pair.landmarks,
        target_bounds: pair.target.surface.bounds(),
    };
    let initial = match start {
        Start::Standard => initialize(input, &InitConfig::standard())?,
        Start::Paper => initialize(input, &InitConfig::paper())?,
        Start::Affine => {
            let affine = initialize(input, &InitConfig::paper())?.affine;
            return Ok(pair.source.rest.map(|p| affine.apply(p)));
        }
    };
    Ok(initial.positions)
}
