//! Eq. 3, first term: corner angles keep their size.

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
pub struct CornerAngle<'a> {
    triangulation: &'a Triangulation,
    reference: Vec<[f64; 3]>,
}

impl<'a> CornerAngle<'a> {
    /// The term that keeps the angles of `reference`.
    pub fn new(triangulation: &'a Triangulation, reference: &Positions) -> Self {
        Self {
            triangulation,
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

impl Loss for CornerAngle<'_> {
    fn accumulate(&self, x: &Positions, weight: f64, grad: &mut VertexData<Vector3>) -> f64 {
        let share = 1.0 / x.len().max(1) as f64;
        let mut sum = 0.0;
        for (t, reference) in self.triangulation.triangles().iter().zip(&self.reference) {
            let [a, b, c] = t.map(|v| x[v]);
            let doubled = area_vector([a, b, c]);
            let length = doubled.norm();
            // Opposite sides: side k faces corner k.
            let sides = [c - b, a - c, b - a];
            let mut at_corner = [Vector3::zeros(); 3];
            for k in 0..3 {
                let (next, last) = ((k + 1) % 3, (k + 2) % 3);
                let (to_next, to_last) = (sides[last], -sides[next]);
                let excess = length.atan2(to_next.dot(&to_last)) - reference[k];
                sum += excess * excess;
                if length > f64::MIN_POSITIVE {
                    // ∂α/∂u = −n × u / |u|², ∂α/∂v = n × v / |v|² for the angle from u to v around n.
                    let scale = 2.0 * weight * share * excess / length;
                    let by_next = doubled.cross(&to_next) * (-scale / to_next.norm_squared());
                    let by_last = doubled.cross(&to_last) * (scale / to_last.norm_squared());
                    at_corner[next] += by_next;
                    at_corner[last] += by_last;
                    at_corner[k] -= by_next + by_last;
                }
            }
            for (&v, g) in t.iter().zip(at_corner) {
                grad[v] += g;
            }
        }
        sum * share
    }
}
