//! The Laplacian of a surface.

use mesh_core::{Point3, Positions, Triangulation, VertexId};
use nalgebra_sparse::CsrMatrix;

use crate::uniform_laplacian::laplacian;

/// A triangle counts as at least this thick: twice its area is at least this share of `|e₁|² + |e₂|² + |e₃|²`.
///
/// 0.29 is equilateral. Cotangents stay below 1/(2 · 1e-5), which leaves ten digits to a factorisation.
const MIN_THICKNESS: f64 = 1e-5;

/// Half the cotangent that one triangle adds to one of its edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CotanWeight {
    /// The ends of the edge, in the order of the triangle.
    pub edge: [VertexId; 2],
    /// `½ cot` of the angle opposite to the edge; negative where that angle is obtuse.
    pub weight: f64,
}

/// Cotangent Laplacian, integrated: divide by the mass of each vertex for the pointwise one.
///
/// `L_ij = −½ (cot α_ij + cot β_ij)`, `L_ii = −Σ_j L_ij`
///
/// One row per vertex of `x`. Positive semi-definite; `L·1 = 0`; linear functions on a flat piece are harmonic.
/// Invariant to rigid motion and uniform scale. Degenerate input: the weights of a triangle are its side products
/// over its area, so the area alone is kept above [a floor](MIN_THICKNESS): that keeps `L` positive semi-definite
/// where clamping single cotangents would not. A triangle shrunk to a point counts as equilateral, so that it still
/// ties its vertices together. Source: Pinkall and Polthier 1993. Departures: the floor.
#[allow(
    rustdoc::private_intra_doc_links,
    reason = "the floor is explained at its constant"
)]
pub fn cotan_laplacian(triangulation: &Triangulation, x: &Positions) -> CsrMatrix<f64> {
    let weights = cotan_weights(triangulation, x);
    laplacian(x.len(), weights.flatten().map(|c| (c.edge, c.weight)))
}

/// The three terms that each triangle adds to [`cotan_laplacian`], in triangle order; the edge opposite to the
/// first corner comes first.
pub fn cotan_weights<'a>(
    triangulation: &'a Triangulation,
    x: &'a Positions,
) -> impl ExactSizeIterator<Item = [CotanWeight; 3]> + 'a {
    triangulation.triangles().iter().map(|&[a, b, c]| {
        let [wa, wb, wc] = half_cotangents([a, b, c].map(|v| x[v]));
        [([b, c], wa), ([c, a], wb), ([a, b], wc)]
            .map(|(edge, weight)| CotanWeight { edge, weight })
    })
}

/// Half the cotangent at each corner: `u·v / (2 |u × v|)`.
fn half_cotangents([a, b, c]: [Point3; 3]) -> [f64; 3] {
    let sides = [c - b, a - c, b - a];
    let squares: f64 = sides.iter().map(|e| e.norm_squared()).sum();
    if squares < f64::MIN_POSITIVE {
        return [0.5 / 3f64.sqrt(); 3];
    }
    let area2 = sides[0]
        .cross(&sides[1])
        .norm()
        .max(MIN_THICKNESS * squares);
    [0, 1, 2].map(|k| -0.5 * sides[(k + 1) % 3].dot(&sides[(k + 2) % 3]) / area2)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cotangents(corners: [[f64; 3]; 3]) -> [f64; 3] {
        half_cotangents(corners.map(Point3::from)).map(|h| 2.0 * h)
    }

    #[test]
    fn closed_forms() {
        let right = cotangents([[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]]);
        for (got, expected) in right.into_iter().zip([0.0, 1.0, 1.0]) {
            assert!((got - expected).abs() < 1e-15);
        }
        let [top, ..] = cotangents([[0.5, 0.75f64.sqrt(), 0.], [0., 0., 0.], [1., 0., 0.]]);
        assert!((top - 1.0 / 3f64.sqrt()).abs() < 1e-15);
    }

    #[test]
    fn degenerate_triangles_stay_finite_and_positive_semi_definite() {
        let flat = cotangents([[0., 0., 0.], [1., 0., 0.], [0.3, 0., 0.]]);
        let [a, b, c] = flat;
        assert!(flat
            .iter()
            .all(|w| w.is_finite() && w.abs() <= 0.5 / MIN_THICKNESS));
        // 3 × 3 Laplacian of one triangle: its only non-trivial principal minors are these.
        assert!(a * b + b * c + c * a >= -1e-6 * (a * b).abs());
        assert!(a + b + c > 0.0);
        assert_eq!(cotangents([[2.0; 3]; 3]), [1.0 / 3f64.sqrt(); 3]);
    }
}
