//! Towards the target.

use mesh_core::measure::vertex_normals;
use mesh_core::{NormalSign, Positions};

use super::ball::Ball;
use crate::Pair;

/// Moves each vertex towards its closest place c of the target: `x'ᵥ = xᵥ + wᵥ (cᵥ − xᵥ)`.
///
/// A place whose surface faces the other way is none: the far side of a thin part does not draw this one through it. Where the
/// target has no sides, every place counts.
pub(super) fn pull(pair: &Pair, ball: &Ball, x: &mut Positions) {
    let target = pair.target.draped_over();
    let closest = target.closest_points(&ball.points(x));
    let normals = vertex_normals(pair.source.triangulation(), x);
    let has_sides = target.normal_sign() == NormalSign::Oriented;
    let places = ball.0.iter().zip(closest).map(|(&(v, weight), hit)| {
        let faces_away = has_sides
            && target
                .normal(&hit.location)
                .is_some_and(|n| n.dot(&normals[v]) < 0.0);
        match faces_away {
            true => x[v],
            false => x[v] + (hit.point - x[v]) * weight,
        }
    });
    let places = places.collect();
    ball.put(x, places);
}
