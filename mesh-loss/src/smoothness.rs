//! Neighbours move alike.

use mesh_core::{Positions, Triangulation, Vector3, VertexData, VertexId};

use crate::Loss;

/// Unevenness of the displacement from a reference shape.
///
/// `1/N Σᵢ |dᵢ − mean of dⱼ over the one-ring of i|² / h²`, with `d = x − reference` and h the mean edge length of the
/// reference
///
/// Units: none; 0 for any displacement that is the same, or varies linearly over a regular mesh. Vertices without an
/// edge add nothing.
/// Source: beyond the paper. Off in `paper`.
pub struct Smoothness {
    reference: Positions,
    edges: Vec<[VertexId; 2]>,
    inverse_degree: VertexData<f64>,
    inverse_edge_squared: f64,
}

impl Smoothness {
    /// The term that keeps the displacement from `reference` smooth over the edges of `triangulation`.
    pub fn new(triangulation: &Triangulation, reference: &Positions) -> Self {
        let edges = triangulation.edges();
        let mut degree = VertexData::new(reference.len(), 0.0);
        let mut length = 0.0;
        for &[a, b] in &edges {
            degree[a] += 1.0;
            degree[b] += 1.0;
            length += (reference[a] - reference[b]).norm();
        }
        let mean = length / edges.len().max(1) as f64;
        Self {
            reference: reference.clone(),
            edges,
            inverse_degree: degree.map(|&d: &f64| if d > 0.0 { 1.0 / d } else { 0.0 }),
            inverse_edge_squared: if mean > 0.0 { 1.0 / (mean * mean) } else { 0.0 },
        }
    }
}

impl Loss for Smoothness {
    fn accumulate(&self, x: &Positions, weight: f64, grad: &mut VertexData<Vector3>) -> f64 {
        let mut unevenness = VertexData::new(x.len(), Vector3::zeros());
        for &[a, b] in &self.edges {
            let difference = (x[a] - self.reference[a]) - (x[b] - self.reference[b]);
            unevenness[a] += difference * self.inverse_degree[a];
            unevenness[b] -= difference * self.inverse_degree[b];
        }
        let share = self.inverse_edge_squared / x.len().max(1) as f64;
        for &[a, b] in &self.edges {
            let g = (unevenness[a] * self.inverse_degree[a]
                - unevenness[b] * self.inverse_degree[b])
                * (2.0 * weight * share);
            grad[a] += g;
            grad[b] -= g;
        }
        unevenness.iter().map(Vector3::norm_squared).sum::<f64>() * share
    }
}
