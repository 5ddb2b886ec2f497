//! Parts of the surface that are near in space and far along it keep a gap.

use mesh_core::measure::{area_vector, triangle_normal};
use mesh_core::{Point3, Positions, Vector3, VertexData, VertexId};

use crate::Loss;

/// A barrier between vertices and triangles that come nearer to each other than a gap, or pass through each other.
///
/// `Σₖ aₖ b(σₖ sₖ)` over pairs, `b(s) = ½ (g − s)²/g` for `0 ≤ s ≤ g`, `g/2 − s` for `s < 0` and 0 beyond, with the signed
/// distance s of a vertex from the plane of a triangle, the side σ = ±1 of it where it belongs, the gap g of the pair and the
/// share a of the surface that is the vertex's
///
/// Units: those of the coordinates; ≥ 0, and 0 where all pairs are at least their gap apart; invariant to rigid motion. A
/// triangle without area adds nothing.
/// Source: Li et al. 2020, "Incremental Potential Contact", Eq. 6. Departures: signed distances, and a slope of at most 1
/// in the place of a barrier that is infinite at 0, since the start of a drape may run through itself and all steps share one
/// scale; a mean over the surface, without the stiffness that adapts; vertices and triangles only, no pairs of edges; pairs
/// that are found once ([`crate::ContactSearch`]) and held until they are sought again. Beyond the paper.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contact {
    /// The pairs, by their vertices.
    pub pairs: Vec<ContactPair>,
}

/// A vertex and a triangle that are near in space and far along the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPair {
    /// The vertex.
    pub vertex: VertexId,
    /// The corners of the triangle.
    pub triangle: [VertexId; 3],
    /// 1 where the vertex belongs before the triangle, −1 where it belongs behind it.
    pub side: f64,
    /// How far from it at least.
    pub gap: f64,
    /// How much the pair counts: the share of the surface that is the vertex's.
    pub share: f64,
}

impl Loss for Contact {
    fn accumulate(&self, x: &Positions, weight: f64, grad: &mut VertexData<Vector3>) -> f64 {
        self.pairs
            .iter()
            .map(|pair| pair.accumulate(x, weight, grad))
            .sum()
    }
}

impl ContactPair {
    fn accumulate(&self, x: &Positions, weight: f64, grad: &mut VertexData<Vector3>) -> f64 {
        let corners = self.triangle.map(|v| x[v]);
        let Some(normal) = triangle_normal(corners) else {
            return 0.0;
        };
        let signed = (x[self.vertex] - corners[0]).dot(&normal);
        let (barrier, slope) = barrier(self.side * signed, self.gap);
        if slope != 0.0 {
            // ds = n·(dx − Σ βᵢ dxᵢ) with the coordinates β of the foot of the perpendicular.
            let g = normal * (weight * self.share * slope * self.side);
            grad[self.vertex] += g;
            let foot = x[self.vertex] - normal * signed;
            for (&v, share) in self
                .triangle
                .iter()
                .zip(barycentric(&foot, &corners, &normal))
            {
                grad[v] -= g * share;
            }
        }
        self.share * barrier
    }
}

/// `b(s)` and its derivative.
fn barrier(s: f64, gap: f64) -> (f64, f64) {
    if s >= gap {
        (0.0, 0.0)
    } else if s > 0.0 {
        (0.5 * (gap - s).powi(2) / gap, (s - gap) / gap)
    } else {
        (0.5 * gap - s, -1.0)
    }
}

/// Coordinates of a point of the plane of a triangle with this unit normal; they sum to 1.
fn barycentric(p: &Point3, &[a, b, c]: &[Point3; 3], normal: &Vector3) -> [f64; 3] {
    let area = |b: Point3, c: Point3| area_vector([*p, b, c]).dot(normal);
    let parts = [area(b, c), area(c, a), area(a, b)];
    let total: f64 = parts.iter().sum();
    parts.map(|part| part / total)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair(height: f64, side: f64) -> (Positions, Contact) {
        let corners = [[0., 0., 0.], [4., 0., 0.], [0., 4., 0.], [1., 1., height]];
        let x = corners.map(Point3::from).into_iter().collect();
        let [a, b, c, vertex] = [0, 1, 2, 3].map(VertexId::new);
        let pair = ContactPair {
            vertex,
            triangle: [a, b, c],
            side,
            gap: 0.5,
            share: 2.0,
        };
        (x, Contact { pairs: vec![pair] })
    }

    fn measured(height: f64, side: f64) -> (f64, VertexData<Vector3>) {
        let (x, contact) = pair(height, side);
        let mut gradient = VertexData::new(x.len(), Vector3::zeros());
        (contact.accumulate(&x, 1.0, &mut gradient), gradient)
    }

    #[test]
    fn a_vertex_on_its_side_is_pushed_within_the_gap_only() {
        assert_eq!(measured(0.5, 1.0).0, 0.0);
        // ½ (0.5 − 0.25)² / 0.5, twice; slope −½, twice.
        let (value, gradient) = measured(0.25, 1.0);
        assert!((value - 0.125).abs() < 1e-12);
        assert!((gradient[VertexId::new(3)].z + 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_vertex_on_the_wrong_side_is_pushed_back_through_by_a_bounded_slope() {
        let (value, gradient) = measured(-3.0, 1.0);
        assert!((value - 2.0 * 3.25).abs() < 1e-12);
        assert!((gradient[VertexId::new(3)].z + 2.0).abs() < 1e-12);
        let (value, gradient) = measured(3.0, -1.0);
        assert!((value - 2.0 * 3.25).abs() < 1e-12);
        assert!((gradient[VertexId::new(3)].z - 2.0).abs() < 1e-12);
    }
}
