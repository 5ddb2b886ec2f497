//! Matched places should face the same way.

use mesh_core::measure::area_vector;
use mesh_core::{Positions, Vector3, VertexData};

use crate::gradient::pull_back_area_vector;
use crate::{Loss, Matches};

/// Mean disagreement of the normals of matched places, both ways.
///
/// `Σ over both ways of 1/n Σ wₖ (1 − nₖ·n′ₖ)`
///
/// Units: none; 0 when all agree, 2 a way when all oppose. Pairs without a normal on either side add nothing.
/// Source: the authors' program (there −n·n′, the same gradient).
pub struct NormalAgreement<'a>(pub &'a Matches);

impl Loss for NormalAgreement<'_> {
    fn accumulate(&self, x: &Positions, weight: f64, grad: &mut VertexData<Vector3>) -> f64 {
        let mut value = 0.0;
        for matches in [&self.0.to_target, &self.0.to_mesh] {
            let share = 1.0 / matches.len().max(1) as f64;
            for pair in matches {
                let corners = pair.triangle.map(|v| x[v]);
                let doubled = area_vector(corners);
                let length = doubled.norm();
                let Some(other) = pair.normal.filter(|_| length > f64::MIN_POSITIVE) else {
                    continue;
                };
                let own = doubled / length;
                let agreement = own.dot(&other);
                value += share * pair.weight * (1.0 - agreement);
                // ∂(−n·m)/∂N = −(m − (n·m) n) / |N|
                let scale = -weight * share * pair.weight / length;
                let by_area_vector = (other - own * agreement) * scale;
                for (&v, g) in pair
                    .triangle
                    .iter()
                    .zip(pull_back_area_vector(corners, &by_area_vector))
                {
                    grad[v] += g;
                }
            }
        }
        value
    }
}
