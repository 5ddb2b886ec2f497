//! Faces keep facing the way they face in the initial shape.

use std::sync::Arc;

use mesh_core::measure::triangle_normal;
use mesh_core::{Positions, Triangulation, Vector3, VertexData};

use crate::gradient::pull_back_normal;
use crate::Loss;

/// Mean turn of the face normals away from a reference shape.
///
/// `1/F Σ_f (1 − n_f·n̂_f)`
///
/// Units: none; 0 when nothing turned, 2 when everything is inside out. Degenerate faces add nothing.
/// Source: the authors' program, where its weight decays to 0 within each stage. Off in `paper`.
pub struct Flip {
    triangulation: Arc<Triangulation>,
    normals: Vec<Option<Vector3>>,
}

impl Flip {
    /// The term that keeps the normals of `reference`.
    pub fn new(triangulation: &Arc<Triangulation>, reference: &Positions) -> Self {
        Self {
            triangulation: Arc::clone(triangulation),
            normals: triangulation
                .corners(reference)
                .map(triangle_normal)
                .collect(),
        }
    }
}

impl Loss for Flip {
    fn accumulate(&self, x: &Positions, weight: f64, grad: &mut VertexData<Vector3>) -> f64 {
        let share = 1.0 / self.normals.len().max(1) as f64;
        let mut sum = 0.0;
        for (t, reference) in self.triangulation.triangles().iter().zip(&self.normals) {
            let corners = t.map(|v| x[v]);
            let Some((n, m)) = triangle_normal(corners).zip(*reference) else {
                continue;
            };
            sum += 1.0 - n.dot(&m);
            for (&v, g) in t
                .iter()
                .zip(pull_back_normal(corners, &(m * (-weight * share))))
            {
                grad[v] += g;
            }
        }
        sum * share
    }
}
