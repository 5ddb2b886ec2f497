//! Eq. 2, second term: landmarks stay at their targets.

use mesh_core::{Landmark, Positions, Vector3, VertexData};

use crate::Loss;

/// Mean squared distance of the landmarks, over their 3k coordinates.
///
/// `1/3k Σᵢ |v̂ᵢ − uᵢ|²`
///
/// Units: squared units of the coordinates. No landmark gives 0.
/// Source: Mesh Draping, Eq. 2. Departures: a mean over coordinates (as the authors' program), not a sum.
pub struct LandmarkDistance<'a>(pub &'a [Landmark]);

impl Loss for LandmarkDistance<'_> {
    fn accumulate(&self, x: &Positions, weight: f64, grad: &mut VertexData<Vector3>) -> f64 {
        let share = 1.0 / (3 * self.0.len().max(1)) as f64;
        let mut sum = 0.0;
        for landmark in self.0 {
            let offset = landmark.source.position(x) - landmark.target;
            sum += offset.norm_squared();
            let place = landmark.source;
            for (&v, w) in place.vertices.iter().zip(place.weights) {
                grad[v] += offset * (2.0 * weight * share * w);
            }
        }
        sum * share
    }
}
