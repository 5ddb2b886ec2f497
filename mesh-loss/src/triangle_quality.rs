//! Eq. 4 as a penalty: no skinny triangles.

use std::sync::Arc;

use mesh_core::measure::triangle_quality;
use mesh_core::{Positions, Triangulation, Vector3, VertexData};

use crate::gradient::area_gradient;
use crate::Loss;

/// Penalty on triangles whose quality is below a threshold.
///
/// `mean of (1 − Q_f) over the faces with Q_f < threshold`, `Q_f = 4√3 A / Σ |e|²`
///
/// Units: none. No such face gives 0.
/// Source: Mesh Draping, Eq. 4 and the text after it (threshold 0.1). Departures: the mean (as the authors' program)
/// where the paper leaves sum or mean open; triangles of the fixed triangulation.
pub struct TriangleQuality {
    triangulation: Arc<Triangulation>,
    threshold: f64,
}

impl TriangleQuality {
    /// The penalty on the triangles whose quality is below `threshold`, 0..=1.
    pub fn new(triangulation: &Arc<Triangulation>, threshold: f64) -> Self {
        Self {
            triangulation: Arc::clone(triangulation),
            threshold,
        }
    }
}

impl Loss for TriangleQuality {
    fn accumulate(&self, x: &Positions, weight: f64, grad: &mut VertexData<Vector3>) -> f64 {
        let skinny: Vec<_> = self
            .triangulation
            .triangles()
            .iter()
            .map(|&t| (t, triangle_quality(t.map(|v| x[v]))))
            .filter(|&(_, q)| q < self.threshold)
            .collect();
        let share = 1.0 / skinny.len().max(1) as f64;
        for &(t, _) in &skinny {
            let corners = t.map(|v| x[v]);
            for (&v, g) in t.iter().zip(quality_gradient(corners)) {
                grad[v] -= g * (weight * share);
            }
        }
        skinny.iter().fold(0.0, |sum, (_, q)| sum + (1.0 - q)) * share
    }
}

/// `dQ = 4√3 (dA/E − A dE/E²)` with `E = Σ |e|²`, `∂E/∂a = 2 (2a − b − c)`.
fn quality_gradient([a, b, c]: [mesh_core::Point3; 3]) -> [Vector3; 3] {
    let Some(area) = area_gradient([a, b, c]) else {
        return [Vector3::zeros(); 3];
    };
    let edges = (b - a).norm_squared() + (c - b).norm_squared() + (a - c).norm_squared();
    let scale = 4.0 * 3f64.sqrt() / edges;
    let by_edges = [(a - b) + (a - c), (b - c) + (b - a), (c - a) + (c - b)];
    [0, 1, 2].map(|k| (area.corners[k] - by_edges[k] * (2.0 * area.area / edges)) * scale)
}
