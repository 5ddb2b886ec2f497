//! No edge folds over.

use std::sync::Arc;

use mesh_core::measure::{mean_edge_length, smallest_height, triangle_normal};
use mesh_core::{Positions, Triangulation, TriangulationEdge, Vector3, VertexData, VertexId};

use crate::gradient::pull_back_normal;
use crate::Loss;

/// Penalty on edges whose two faces turn against each other more than at rest.
///
/// `3/N Σ over interior edges of w max(0, min(n₁·n₂ at rest, limit) − n₁·n₂)²`, `w = min(1, 6h/ē)`
///
/// with the smallest height h of the two faces and the mean edge length ē, both at rest. A normal turns by 1/h of what its
/// corners move: without w, the edges of tiny faces would pull so hard that steps shoot past the fold and back.
///
/// Units: none; 0 while no edge bends past the limit. Edges at a degenerate face add nothing.
/// Source: beyond the paper. Off in `paper`.
pub struct FoldBarrier {
    triangulation: Arc<Triangulation>,
    edges: Vec<TriangulationEdge>,
    limits: Vec<f64>,
    weights: Vec<f64>,
}

/// Edges whose faces are at least this high, in mean edge lengths, count in full.
const FULL_HEIGHT: f64 = 1.0 / 6.0;

impl FoldBarrier {
    /// The barrier for a mesh whose rest shape is `rest`; `limit` in −1..=1 is the cosine at which an edge that was
    /// flatter at rest begins to count.
    pub fn new(triangulation: &Arc<Triangulation>, rest: &Positions, limit: f64) -> Self {
        let edges = triangulation.interior_edges();
        let normals = normals(triangulation, rest);
        let limits = edges
            .iter()
            .map(|e| {
                let [n, m] = e.triangles.map(|t| normals[t]);
                n.zip(m).map_or(limit, |(n, m)| n.dot(&m).min(limit))
            })
            .collect();
        let full = FULL_HEIGHT * mean_edge_length(triangulation, rest);
        let height = |t: usize| smallest_height(triangulation.triangles()[t].map(|v| rest[v]));
        let weights = edges
            .iter()
            .map(|e| {
                let [h, k] = e.triangles.map(height);
                (h.min(k) / full).min(1.0)
            })
            .collect();
        Self {
            triangulation: Arc::clone(triangulation),
            edges,
            limits,
            weights,
        }
    }

    /// Rows of the edges at the triangles of these vertices, given in ascending order: the gradient there depends on no
    /// others.
    pub fn edges_near(&self, vertices: &[VertexId]) -> Vec<usize> {
        let is_near = |e: &TriangulationEdge| {
            let corners = e.triangles.map(|t| self.triangulation.triangles()[t]);
            corners
                .as_flattened()
                .iter()
                .any(|v| vertices.binary_search(v).is_ok())
        };
        (0..self.edges.len())
            .filter(|&row| is_near(&self.edges[row]))
            .collect()
    }

    /// [`Loss::accumulate`] of these edges alone.
    pub fn accumulate_edges(
        &self,
        rows: &[usize],
        x: &Positions,
        weight: f64,
        grad: &mut VertexData<Vector3>,
    ) -> f64 {
        let normal = |t: usize| triangle_normal(self.triangulation.triangles()[t].map(|v| x[v]));
        self.accumulate_with(normal, rows.iter().copied(), x, weight, grad)
    }

    fn accumulate_with(
        &self,
        normal: impl Fn(usize) -> Option<Vector3>,
        rows: impl Iterator<Item = usize>,
        x: &Positions,
        weight: f64,
        grad: &mut VertexData<Vector3>,
    ) -> f64 {
        let share = 3.0 / x.len().max(1) as f64;
        let mut sum = 0.0;
        for row in rows {
            let [one, two] = self.edges[row].triangles;
            let Some((n, m)) = normal(one).zip(normal(two)) else {
                continue;
            };
            let excess = self.limits[row] - n.dot(&m);
            if excess <= 0.0 {
                continue;
            }
            sum += self.weights[row] * excess * excess;
            let scale = -2.0 * weight * share * self.weights[row] * excess;
            for (t, other) in [(one, m), (two, n)] {
                let t = self.triangulation.triangles()[t];
                let g = pull_back_normal(t.map(|v| x[v]), &(other * scale));
                for (&v, g) in t.iter().zip(g) {
                    grad[v] += g;
                }
            }
        }
        sum * share
    }
}

impl Loss for FoldBarrier {
    fn accumulate(&self, x: &Positions, weight: f64, grad: &mut VertexData<Vector3>) -> f64 {
        let normals = normals(&self.triangulation, x);
        self.accumulate_with(|t| normals[t], 0..self.edges.len(), x, weight, grad)
    }
}

fn normals(triangulation: &Triangulation, x: &Positions) -> Vec<Option<Vector3>> {
    triangulation.corners(x).map(triangle_normal).collect()
}

#[cfg(test)]
mod tests {
    use mesh_core::{shapes, Triangulation, Vector3, VertexData, VertexId};

    use super::*;

    #[test]
    fn edges_nearby_give_the_gradient_there_to_the_bit() {
        let (mesh, rest) = shapes::quad_sphere(6).into_halfedge().unwrap();
        let triangulation = Arc::new(Triangulation::new(&mesh, &rest));
        let mut x = rest.clone();
        for v in x.ids().step_by(3) {
            x[v] *= 0.4;
        }
        let barrier = FoldBarrier::new(&triangulation, &rest, 0.3);
        let near = [3, 30, 31, 100].map(VertexId::new);
        let rows = barrier.edges_near(&near);
        assert!(rows.len() < triangulation.interior_edges().len() / 4);

        let mut all = VertexData::new(x.len(), Vector3::zeros());
        let mut some = all.clone();
        barrier.accumulate(&x, 0.7, &mut all);
        barrier.accumulate_edges(&rows, &x, 0.7, &mut some);
        assert!(near.iter().any(|&v| all[v] != Vector3::zeros()));
        assert!(near.iter().all(|&v| all[v] == some[v]));
    }
}
