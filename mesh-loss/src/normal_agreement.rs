//! Matched places should face the same way.

use mesh_core::measure::triangle_normal;
use mesh_core::{Positions, Vector3, VertexData};

use crate::gradient::pull_back_normal;
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
                let Some((own, other)) = triangle_normal(corners).zip(pair.normal) else {
                    continue;
                };
                value += share * pair.weight * (1.0 - own.dot(&other));
                let g = pull_back_normal(corners, &(other * (-weight * share * pair.weight)));
                for (&v, g) in pair.triangle.iter().zip(g) {
                    grad[v] += g;
                }
            }
        }
        value
    }
}
