//! Vertices do not slide along the surface.

use mesh_core::measure::vertex_normals;
use mesh_core::{Positions, Triangulation, Vector3, VertexData};

use crate::Loss;

/// Mean squared motion along the surface away from a reference shape.
///
/// `1/N Σᵢ |(I − nᵢnᵢᵀ)(xᵢ − aᵢ)|²`, with the vertex normals n of the reference a
///
/// Units: squared units of the coordinates; motion along the normals is free. A vertex without a normal is free.
/// Source: beyond the paper. Off in `paper`.
pub struct Drift {
    reference: Positions,
    normals: VertexData<Vector3>,
}

impl Drift {
    /// The term that keeps vertices from sliding away from `reference`.
    pub fn new(triangulation: &Triangulation, reference: &Positions) -> Self {
        Self {
            reference: reference.clone(),
            normals: vertex_normals(triangulation, reference),
        }
    }
}

impl Drift {
    /// The shape from which vertices should not slide away.
    pub fn reference(&self) -> &Positions {
        &self.reference
    }
}

impl Loss for Drift {
    fn accumulate(&self, x: &Positions, weight: f64, grad: &mut VertexData<Vector3>) -> f64 {
        let share = 1.0 / x.len().max(1) as f64;
        let mut sum = 0.0;
        for (((p, a), n), g) in x
            .iter()
            .zip(&self.reference)
            .zip(&self.normals)
            .zip(grad.iter_mut())
        {
            if *n == Vector3::zeros() {
                continue;
            }
            let motion = p - a;
            let along = motion - n * n.dot(&motion);
            sum += along.norm_squared();
            *g += along * (2.0 * weight * share);
        }
        sum * share
    }
}
