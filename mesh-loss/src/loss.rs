//! What a loss term is.

use mesh_core::{Positions, Vector3, VertexData};

/// A scalar function of the positions with its gradient.
pub trait Loss {
    /// Returns the value at `x`; adds `weight * dL/dx` into `grad`.
    ///
    /// `x`, `grad`: one entry per vertex, N. The value is not multiplied by `weight`.
    fn accumulate(&self, x: &Positions, weight: f64, grad: &mut VertexData<Vector3>) -> f64;
}
