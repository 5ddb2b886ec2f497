//! Along the target.

use mesh_core::{Point3, Positions, Vector3};

use super::ball::Ball;
use crate::Pair;

/// Moves each vertex along the target, by its weight's share of `by`:
///
/// `x'ᵥ = xᵥ + c(c(xᵥ) + wᵥ by) − c(xᵥ)`
///
/// where c is the closest place of the target: a vertex keeps its offset from the surface, so that one on it stays on it.
pub(super) fn slide(pair: &Pair, ball: &Ball, x: &mut Positions, by: Vector3) {
    let target = pair.target.draped_over();
    let before = target.closest_points(&ball.points(x));
    let weights = ball.0.iter().map(|&(_, weight)| weight);
    let moved = before.iter().zip(weights);
    let moved: Vec<Point3> = moved.map(|(hit, weight)| hit.point + by * weight).collect();
    let after = target.closest_points(&moved);
    let ways = after.iter().zip(&before).map(|(a, b)| a.point - b.point);
    let places = ball.points(x).into_iter().zip(ways);
    let places = places.map(|(p, way)| p + way).collect();
    ball.put(x, places);
}
