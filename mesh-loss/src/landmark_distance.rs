//! Eq. 2, second term: landmarks stay at their targets.

use mesh_core::{Landmark, Positions, Vector3, VertexData};

use crate::Loss;

/// Mean squared distance of the landmarks, over their 3k coordinates, each counting what it [weighs](Landmark::pull).
///
/// `1/(3 Σᵢ wᵢ) Σᵢ wᵢ |v̂ᵢ − uᵢ|²`
///
/// Units: squared units of the coordinates. No landmark gives 0, and one that weighs nothing is none. Weights say what
/// landmarks count beside each other: twice all of them is the same loss.
/// Source: Mesh Draping, Eq. 2. Departures: a mean over coordinates (as the authors' program), not a sum; weights.
pub struct LandmarkDistance<'a>(pub &'a [Landmark]);

impl Loss for LandmarkDistance<'_> {
    fn accumulate(&self, x: &Positions, weight: f64, grad: &mut VertexData<Vector3>) -> f64 {
        let followed = || self.0.iter().filter(|l| l.is_followed());
        let total: f64 = followed().map(Landmark::pull).sum();
        if total <= 0.0 {
            return 0.0;
        }
        let share = 1.0 / (3.0 * total);
        let mut sum = 0.0;
        for landmark in followed() {
            let offset = landmark.source.position(x) - landmark.target;
            sum += landmark.pull() * offset.norm_squared();
            let place = landmark.source;
            for (&v, w) in place.vertices.iter().zip(place.weights) {
                grad[v] += offset * (2.0 * weight * share * landmark.pull() * w);
            }
        }
        sum * share
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh_core::{shapes, Point3, VertexId};

    /// The value and the gradient at the first vertex.
    fn at_rest(landmarks: &[Landmark]) -> (f64, Vector3) {
        let (_, x) = shapes::tetrahedron().into_halfedge().unwrap();
        let mut grad = VertexData::new(x.len(), Vector3::zeros());
        let value = LandmarkDistance(landmarks).accumulate(&x, 0.7, &mut grad);
        (value, grad[VertexId::new(0)])
    }

    fn landmarks() -> [Landmark; 3] {
        [0, 1, 2].map(|v| Landmark::new(VertexId::new(v), Point3::new(0.1, 0.2 * v as f64, 3.0)))
    }

    #[test]
    fn weights_of_one_change_no_bit_of_the_plain_mean() {
        let (_, x) = shapes::tetrahedron().into_halfedge().unwrap();
        let offsets = landmarks().map(|l| l.source.position(&x) - l.target);
        let share = 1.0 / 9.0;
        let sum: f64 = offsets.iter().map(Vector3::norm_squared).sum();
        let (value, gradient) = at_rest(&landmarks());
        assert_eq!(value.to_bits(), (sum * share).to_bits());
        assert_eq!(gradient, offsets[0] * (2.0 * 0.7 * share * 1.0));
    }

    #[test]
    fn a_landmark_of_weight_zero_is_none_and_one_of_two_counts_twice() {
        let mut list = landmarks();
        list[2].weight = 0.0;
        assert_eq!(at_rest(&list), at_rest(&list[..2]));
        let [a, b, _] = landmarks();
        let twice = Landmark {
            weight: 2.0,
            ..a.clone()
        };
        let (weighed, repeated) = (at_rest(&[twice, b.clone()]), at_rest(&[a.clone(), a, b]));
        assert!((weighed.0 - repeated.0).abs() < 1e-12);
        assert!((weighed.1 - repeated.1).norm() < 1e-12);
        list.iter_mut().for_each(|l| l.weight = 0.0);
        assert_eq!(at_rest(&list), (0.0, Vector3::zeros()));
    }
}
