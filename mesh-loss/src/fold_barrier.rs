//! No edge folds over.

use mesh_core::measure::triangle_normal;
use mesh_core::{Positions, Triangulation, TriangulationEdge, Vector3, VertexData};

use crate::gradient::pull_back_normal;
use crate::Loss;

/// Penalty on edges whose two faces turn against each other more than at rest.
///
/// `3/N Σ over interior edges of max(0, min(n₁·n₂ at rest, limit) − n₁·n₂)²`
///
/// Units: none; 0 while no edge bends past the limit. Edges at a degenerate face add nothing.
/// Source: beyond the paper. Off in `paper`.
pub struct FoldBarrier<'a> {
    triangulation: &'a Triangulation,
    edges: Vec<TriangulationEdge>,
    limits: Vec<f64>,
}

impl<'a> FoldBarrier<'a> {
    /// The barrier for a mesh whose rest shape is `rest`; `limit` in −1..=1 is the cosine at which an edge that was
    /// flatter at rest begins to count.
    pub fn new(triangulation: &'a Triangulation, rest: &Positions, limit: f64) -> Self {
        let edges = triangulation.interior_edges();
        let normals = normals(triangulation, rest);
        let limits = edges
            .iter()
            .map(|e| {
                let [n, m] = e.triangles.map(|t| normals[t]);
                n.zip(m).map_or(limit, |(n, m)| n.dot(&m).min(limit))
            })
            .collect();
        Self {
            triangulation,
            edges,
            limits,
        }
    }
}

impl Loss for FoldBarrier<'_> {
    fn accumulate(&self, x: &Positions, weight: f64, grad: &mut VertexData<Vector3>) -> f64 {
        let share = 3.0 / x.len().max(1) as f64;
        let normals = normals(self.triangulation, x);
        let mut sum = 0.0;
        for (edge, limit) in self.edges.iter().zip(&self.limits) {
            let [one, two] = edge.triangles;
            let Some((n, m)) = normals[one].zip(normals[two]) else {
                continue;
            };
            let excess = limit - n.dot(&m);
            if excess <= 0.0 {
                continue;
            }
            sum += excess * excess;
            let scale = -2.0 * weight * share * excess;
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

fn normals(triangulation: &Triangulation, x: &Positions) -> Vec<Option<Vector3>> {
    triangulation.corners(x).map(triangle_normal).collect()
}
