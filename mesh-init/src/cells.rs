//! How the surface around each vertex has turned: what every locally rigid or similar deformation is built from.

use mesh_core::{Positions, Triangulation, Vector3, VertexData, VertexId};
use mesh_operators::cotan_weights;
use nalgebra::Matrix3;

/// The cells of a surface at rest: each vertex with all sides of the triangles around it ("spokes and rims").
///
/// Sides are weighted by half the cotangent of the angle opposite to them in their triangle.
#[derive(Clone, Debug)]
pub(crate) struct Cells {
    triangles: Vec<CellTriangle>,
}

#[derive(Clone, Debug)]
struct CellTriangle {
    corners: [VertexId; 3],
    edges: [CellEdge; 3],
}

/// A side from the first to the second of `ends`, and what it was at rest.
#[derive(Clone, Debug)]
struct CellEdge {
    ends: [VertexId; 2],
    weight: f64,
    rest: Vector3,
}

impl Cells {
    pub(crate) fn new(triangulation: &Triangulation, rest: &Positions) -> Self {
        let weights = cotan_weights(triangulation, rest);
        let triangle = |(&corners, weights): (&[VertexId; 3], [mesh_operators::CotanWeight; 3])| {
            CellTriangle {
                corners,
                edges: weights.map(|w| CellEdge {
                    ends: w.edge,
                    weight: w.weight,
                    rest: rest[w.edge[1]] - rest[w.edge[0]],
                }),
            }
        };
        Self {
            triangles: triangulation
                .triangles()
                .iter()
                .zip(weights)
                .map(triangle)
                .collect(),
        }
    }

    /// `S_i = Σ w e e₀ᵀ` over the sides `e` (`e₀` at rest) of the cell: the best rotation maximises `tr(Rᵀ S_i)`.
    pub(crate) fn covariances(&self, x: &Positions) -> VertexData<Matrix3<f64>> {
        let mut covariances = VertexData::new(x.len(), Matrix3::zeros());
        for triangle in &self.triangles {
            let outer = triangle
                .edges
                .iter()
                .map(|s| (x[s.ends[1]] - x[s.ends[0]]) * s.rest.transpose() * s.weight);
            let sum: Matrix3<f64> = outer.sum();
            for v in triangle.corners {
                covariances[v] += sum;
            }
        }
        covariances
    }

    /// `Σ w |e₀|²` over the sides of the cell: four times the area of its triangles.
    pub(crate) fn rest_squares(&self, n_vertices: usize) -> VertexData<f64> {
        let mut squares = VertexData::new(n_vertices, 0.0);
        for triangle in &self.triangles {
            let sum: f64 = triangle
                .edges
                .iter()
                .map(|s| s.weight * s.rest.norm_squared())
                .sum();
            for v in triangle.corners {
                squares[v] += sum;
            }
        }
        squares
    }

    /// `δ_i = Σ_j w_ij F (p_i − p_j)`, the Laplacian of the rest shape with each triangle transformed by `F`, the
    /// mean frame of its corners: the solution of `L x = δ` has the sides nearest to those.
    pub(crate) fn transformed_laplacian(&self, frames: &VertexData<Matrix3<f64>>) -> Vec<Vector3> {
        let mut delta = vec![Vector3::zeros(); frames.len()];
        for triangle in &self.triangles {
            let frame = triangle
                .corners
                .iter()
                .map(|&v| frames[v])
                .sum::<Matrix3<f64>>()
                / 3.0;
            for side in &triangle.edges {
                let turned = frame * side.rest * side.weight;
                delta[side.ends[1].index()] += turned;
                delta[side.ends[0].index()] -= turned;
            }
        }
        delta
    }

    /// `Σ_i Σ_e w |e − F_i e₀|² / 3` over all cells.
    pub(crate) fn energy(&self, x: &Positions, frames: &VertexData<Matrix3<f64>>) -> f64 {
        let of_triangle = |t: &CellTriangle| -> f64 {
            let side = |s: &CellEdge, v: VertexId| {
                s.weight * (x[s.ends[1]] - x[s.ends[0]] - frames[v] * s.rest).norm_squared()
            };
            t.corners
                .iter()
                .map(|&v| t.edges.iter().map(|s| side(s, v)).sum::<f64>())
                .sum()
        };
        self.triangles.iter().map(of_triangle).sum::<f64>() / 3.0
    }
}
