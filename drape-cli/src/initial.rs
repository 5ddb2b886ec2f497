//! Where a drape starts: the initial deformation, chosen by name.

use mesh_core::{Positions, UnitFrame};
use mesh_init::{find_pose, initialize, point_pairs, InitConfig, InitInput, Pose, PoseInput};
use serde::{Deserialize, Serialize};

use crate::input::Pair;

/// The study of the paper's terms that starts from the affine map alone.
pub(crate) const STUDY_OF_START: &str = "study-affine-start";

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
    /// How landmarks spread; none where the affine map is all.
    pub(crate) fn config(self) -> Option<InitConfig> {
        match self {
            Self::Standard => Some(InitConfig::standard()),
            Self::Paper => Some(InitConfig::paper()),
            Self::Affine => None,
        }
    }

    /// The start that belongs to a preset.
    pub(crate) fn of_preset(preset: &str) -> Self {
        match preset {
            "paper" => Self::Paper,
            STUDY_OF_START => Self::Affine,
            _ => Self::Standard,
        }
    }
}

/// Fewer landmarks leave the way the source stands open: it is searched.
const ENOUGH_TO_STAND: usize = 3;

/// A source brought to its landmarks.
pub(crate) struct Initial {
    /// In the target's coordinates.
    pub(crate) positions: Positions,
    /// What had to be assumed, in words.
    pub(crate) assumed: Vec<String>,
}

/// The source of `pair`, brought to its landmarks; where these are too few, in the pose that fits best.
pub(crate) fn deform(pair: &Pair, start: Start) -> anyhow::Result<Initial> {
    let pose = (pair.landmarks.len() < ENOUGH_TO_STAND)
        .then(|| pose(pair))
        .flatten();
    let placed = match &pose {
        Some(pose) => pair.source.rest.map(|p| pose.apply(p)),
        None => pair.source.rest.as_ref().clone(),
    };
    let input = InitInput {
        mesh: &pair.source.mesh,
        rest: &placed,
        landmarks: &pair.landmarks,
        target_frame: match &pose {
            Some(_) => UnitFrame::principal(placed.as_slice()),
            None => pair.target.surface.principal_frame(),
        },
    };
    let positions = match start.config() {
        Some(config) => initialize(input, &config)?.positions,
        None => {
            let affine = initialize(input, &InitConfig::paper())?.affine;
            placed.map(|p| affine.apply(p))
        }
    };
    let assumed = pose.iter().flat_map(|p| assumed(p, pair.landmarks.len()));
    Ok(Initial {
        assumed: assumed.collect(),
        positions,
    })
}

fn pose(pair: &Pair) -> Option<Pose> {
    find_pose(PoseInput {
        triangulation: &pair.source.triangulation,
        rest: &pair.source.rest,
        target: pair.target.over.as_ref(),
        landmarks: &point_pairs(&pair.landmarks, &pair.source.rest),
        seed: 0,
    })
}

/// What was assumed about the way the source stands.
fn assumed(pose: &Pose, n_landmarks: usize) -> Vec<String> {
    let by = match n_landmarks {
        0 => "no landmarks: the way the source stands was found by its shape alone".to_owned(),
        1 => "1 landmark: the way the source stands was found by its shape".to_owned(),
        n => format!("{n} landmarks: the way the source stands was found by its shape"),
    };
    let turn = if pose.turn_deg < 5.0 {
        "as the files stand".to_owned()
    } else {
        format!("turned by {:.0}°", pose.turn_deg)
    };
    let mut lines = vec![format!(
        "{by} ({turn}, {:.1} % of the longest side off on the mean); look at the picture",
        100.0 * pose.cost
    )];
    lines.extend(pose.rival.map(|(angle, cost)| {
        format!(
            "turned by another {angle:.0}° the source fits nearly as well ({:.1} % off): mark two or three places to \
             decide which is front",
            100.0 * cost
        )
    }));
    lines
}
