//! A first idea of a deformation, for sources whose real one takes long.
//!
//! It is found on one thread, so that it does not wait for others that have much to do.

use mesh_core::{Landmark, Point3, Positions, Vector3};
use mesh_init::{fit_affine, point_pairs, FramePair, SimilarityPrior};
use mesh_operators::SpaceExtension;

use crate::Scene;

/// Sources with more vertices than this are shown roughly at once, then exactly.
pub(crate) const LARGE: usize = 20_000;
/// Landmarks that count at most.
const MAX_CENTRES: usize = 200;

/// `present`, or the source where the affine map of its landmarks puts it, with what the landmarks still miss spread
/// through space. They are met; the surface itself is not asked.
pub(crate) fn rough(
    scene: &Scene,
    landmarks: &[Landmark],
    present: Option<&Positions>,
) -> Positions {
    let source = &scene.source;
    let placed = match present {
        Some(present) => present.clone(),
        None => {
            let frames = FramePair {
                source: mesh_core::UnitFrame::principal(source.rest.as_slice()),
                target: scene.target.judged().principal_frame(),
            };
            let pairs = point_pairs(landmarks, &source.rest);
            let affine = fit_affine(&pairs, frames, SimilarityPrior::LeaveOneOut);
            source.rest.map(|p| affine.apply(p))
        }
    };
    let from: Vec<Point3> = landmarks
        .iter()
        .map(|l| l.source.position(&placed))
        .collect();
    let missed: Vec<Vector3> = landmarks
        .iter()
        .zip(&from)
        .map(|(l, p)| l.target - p)
        .collect();
    // There is no field without landmarks.
    match SpaceExtension::new(&from, &missed, MAX_CENTRES) {
        Ok(field) => placed.map(|p| p + field.displacement_at(p)),
        Err(_) => placed,
    }
}
