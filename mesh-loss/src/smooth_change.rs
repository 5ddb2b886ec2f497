//! Change is smooth along the surface.

use mesh_core::{Positions, Triangulation, Vector3, VertexData, VertexId};

use crate::Loss;

/// How unevenly a surface changes between one shape and the next, as the frames of a motion.
///
/// `Σ_{ij} |dᵢ − dⱼ|²` over the edges ij, diagonals of polygons included, with the displacements `d = x − a` from the shape
/// before, a
///
/// Units: squared units of the coordinates; a mesh of finer triangles has the same value for the same change. Shifts are free.
/// Degenerate input: no edge gives 0.
/// Source: beyond the paper. Off in every preset.
pub struct SmoothChange {
    edges: Vec<[VertexId; 2]>,
    before: Positions,
}

impl SmoothChange {
    /// The term that keeps the change since `before` smooth.
    pub fn new(triangulation: &Triangulation, before: &Positions) -> Self {
        Self {
            edges: triangulation.edges().to_vec(),
            before: before.clone(),
        }
    }
}

impl Loss for SmoothChange {
    fn accumulate(&self, x: &Positions, weight: f64, grad: &mut VertexData<Vector3>) -> f64 {
        let mut sum = 0.0;
        for &[i, j] in &self.edges {
            let difference = (x[i] - self.before[i]) - (x[j] - self.before[j]);
            sum += difference.norm_squared();
            let pull = difference * (2.0 * weight);
            grad[i] += pull;
            grad[j] -= pull;
        }
        sum
    }
}
