//! Eq. 3, first term: corner angles keep their size.

use std::sync::Arc;

use mesh_core::measure::{area_vector, corner_angle};
use mesh_core::{Positions, Triangulation, Vector3, VertexData};

use crate::Loss;

/// Squared change of the corner angles around each vertex, mean over vertices.
///
/// `1/N Σᵢ Σ over corners j at i of (α̂ⱼ − αⱼ)²`, in squared radians
///
/// A degenerate triangle counts in the value and has no gradient.
/// Source: Mesh Draping, Eq. 3. Departures: polygons are measured on the fixed triangulation; which shape gives the
/// angles αⱼ is the caller's choice (the paper: rest; the authors' program: initial).
pub struct CornerAngle {
    triangulation: Arc<Triangulation>,
    reference: Vec<[f64; 3]>,
}

impl CornerAngle {
    /// The term that keeps the angles of `reference`.
    pub fn new(triangulation: &Arc<Triangulation>, reference: &Positions) -> Self {
        Self {
            triangulation: Arc::clone(triangulation),
            reference: triangulation
                .corners(reference)
                .map(|[a, b, c]| {
                    [
                        corner_angle(a, b, c),
                        corner_angle(b, c, a),
                        corner_angle(c, a, b),
                    ]
                })
                .collect(),
        }
    }
}

impl Loss for CornerAngle {
    fn accumulate(&self, x: &Positions, weight: f64, grad: &mut VertexData<Vector3>) -> f64 {
        let share = 1.0 / x.len().max(1) as f64;
        let mut sum = 0.0;
        for (t, reference) in self.triangulation.triangles().iter().zip(&self.reference) {
            let [a, b, c] = t.map(|v| x[v]);
            let doubled = area_vector([a, b, c]);
            let length = doubled.norm();
            // Opposite sides: side k faces corner k.
            let sides = [c - b, a - c, b - a];
            let excess = differences(angles(length, &sides), reference);
            sum += excess.iter().map(|e| e * e).sum::<f64>();
            if length <= f64::MIN_POSITIVE {
                continue;
            }
            // ∂α/∂u = −n × u / |u|², ∂α/∂v = n × v / |v|² for the angle from u to v around n.
            let scale = 2.0 * weight * share / length;
            let turn = sides.map(|side| doubled.cross(&side) * (scale / side.norm_squared()));
            let mut at_corner = [Vector3::zeros(); 3];
            for k in 0..3 {
                let (next, last) = ((k + 1) % 3, (k + 2) % 3);
                let (by_next, by_last) = (turn[last] * excess[k], turn[next] * excess[k]);
                at_corner[next] -= by_next;
                at_corner[last] -= by_last;
                at_corner[k] += by_next + by_last;
            }
            for (&v, g) in t.iter().zip(at_corner) {
                grad[v] += g;
            }
        }
        sum * share
    }
}

/// The corner angles of a triangle of doubled area `length`: they sum to π.
#[inline]
fn angles(length: f64, sides: &[Vector3; 3]) -> [f64; 3] {
    let angle = |k: usize| length.atan2(-sides[(k + 1) % 3].dot(&sides[(k + 2) % 3]));
    let [alpha, beta] = [angle(0), angle(1)];
    let gamma = if length > f64::MIN_POSITIVE {
        std::f64::consts::PI - alpha - beta
    } else {
        angle(2)
    };
    [alpha, beta, gamma]
}

fn differences(a: [f64; 3], b: &[f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}
