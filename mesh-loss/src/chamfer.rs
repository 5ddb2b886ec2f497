//! Eq. 2, first term: the Chamfer distance between the mesh and the target.

use mesh_core::{Positions, Vector3, VertexData};

use crate::{Loss, Matches, SurfaceMatch};

/// Mean distance between matched points, both ways, unsquared.
///
/// `Ch = 1/n Σ wₖ |pₖ − qₖ| + 1/m Σ wₗ |pₗ − qₗ|`
///
/// Units: those of the coordinates. A direction without matches, or a pair at distance 0, adds nothing. The matched
/// points are closest points, so their motion does not enter the gradient (the first-order change of a distance to
/// a closest point is zero along the surface).
/// Source: Mesh Draping, Eq. 2. Departures: pairs carry weights; `paper` sets them to 1.
pub struct Chamfer<'a>(pub &'a Matches);

impl Loss for Chamfer<'_> {
    fn accumulate(&self, x: &Positions, weight: f64, grad: &mut VertexData<Vector3>) -> f64 {
        [&self.0.to_target, &self.0.to_mesh]
            .into_iter()
            .map(|matches| mean_distance(matches, x, weight, grad))
            .sum()
    }
}

fn mean_distance(
    matches: &[SurfaceMatch],
    x: &Positions,
    weight: f64,
    grad: &mut VertexData<Vector3>,
) -> f64 {
    let share = 1.0 / matches.len().max(1) as f64;
    let mut sum = 0.0;
    for pair in matches {
        let offset = pair.offset(x);
        let distance = offset.norm();
        sum += pair.weight * distance;
        if distance > f64::MIN_POSITIVE {
            pair.scatter(&(offset * (weight * share * pair.weight / distance)), grad);
        }
    }
    sum * share
}
