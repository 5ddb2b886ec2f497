//! Where a drape starts: the source brought to its landmarks.

use mesh_core::{Positions, UnitFrame};
use mesh_init::{find_pose, initialize, point_pairs, InitConfig, InitInput, Pose, PoseInput};
use serde::{Deserialize, Serialize};

use crate::{Error, Note, Pair};

/// How the source is brought to its landmarks before it is draped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum InitialMethod {
    /// The best of several starts: that of [`Self::Standard`], and two that are led by distances along the surfaces
    /// ([`mesh_init::Guide`]). Each is tried on a coarse stand-in before the drape begins; to [`initial_deformation`],
    /// which drapes nothing, the same as [`Self::Standard`].
    Tried,
    /// The same, but no network leads where all of them are poor: what it gives is measured against this.
    TriedByVertices,
    /// Affine, then rotations and scales spread from the landmarks: least distortion ([`InitConfig::standard`]).
    Standard,
    /// The paper's: affine, then a biharmonic field ([`InitConfig::paper`]).
    Paper,
    /// The affine map alone.
    Affine,
}

impl InitialMethod {
    /// How landmarks spread; none where the affine map is all.
    pub fn config(self) -> Option<InitConfig> {
        match self {
            Self::Tried | Self::TriedByVertices | Self::Standard => Some(InitConfig::standard()),
            Self::Paper => Some(InitConfig::paper()),
            Self::Affine => None,
        }
    }
}

/// Fewer landmarks leave the way the source stands open: it is searched.
pub(crate) const ENOUGH_TO_STAND: usize = 3;

/// A source brought to its landmarks.
#[derive(Clone, Debug, PartialEq)]
pub struct InitialShape {
    /// One position per vertex of the source, in the target's coordinates.
    pub positions: Positions,
    /// What had to be assumed.
    pub notes: Vec<Note>,
}

/// The source of `pair`, brought to its landmarks; where these are fewer than three, in the pose that fits best.
///
/// # Errors
/// Landmarks that do not fit the source, or a deformation that cannot be solved for.
pub fn initial_deformation(pair: &Pair, method: InitialMethod) -> Result<InitialShape, Error> {
    let (source, landmarks) = (&pair.source, &pair.landmarks);
    let pose = (pair.n_followed() < ENOUGH_TO_STAND)
        .then(|| search_pose(pair))
        .flatten();
    let placed = match &pose {
        Some(pose) => source.rest().map(|p| pose.apply(p)),
        None => source.rest().as_ref().clone(),
    };
    let input = InitInput {
        triangulation: source.triangulation(),
        rest: &placed,
        landmarks,
        target_frame: match &pose {
            Some(_) => UnitFrame::principal(placed.as_slice()),
            None => pair.target.judged().principal_frame(),
        },
    };
    let positions = match method.config() {
        Some(config) => initialize(input, &config)?.positions,
        None => {
            let affine = initialize(input, &InitConfig::paper())?.affine;
            placed.map(|p| affine.apply(p))
        }
    };
    let notes = pose.iter().flat_map(|p| assumed(p, pair.n_followed()));
    Ok(InitialShape {
        notes: notes.collect(),
        positions,
    })
}

fn search_pose(pair: &Pair) -> Option<Pose> {
    find_pose(PoseInput {
        triangulation: pair.source.triangulation(),
        rest: pair.source.rest(),
        target: pair.target.draped_over().as_ref(),
        landmarks: &point_pairs(&pair.landmarks, pair.source.rest()),
        seed: 0,
    })
}

/// What was assumed about the way the source stands.
fn assumed(pose: &Pose, n_landmarks: usize) -> Vec<Note> {
    let mut notes = vec![Note::PoseAssumed {
        n_landmarks,
        turn_deg: pose.turn_deg,
        cost: pose.cost,
    }];
    let rival = pose.rival;
    notes.extend(rival.map(|(turn_deg, cost)| Note::PoseAmbiguous { turn_deg, cost }));
    notes
}
