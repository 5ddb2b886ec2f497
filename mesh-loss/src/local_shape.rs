//! Every one-ring stays a turned and scaled copy of itself.

use mesh_core::{nearest_rotation, Positions, Rows, Triangulation, Vector3, VertexData, VertexId};
use nalgebra::Matrix3;

use crate::Loss;

/// How far each one-ring is from a turned and scaled copy of itself at rest, mean over vertices.
///
/// `1/N Σᵢ min over s, R of Σⱼ |eᵢⱼ − s R rᵢⱼ|² / Σⱼ |eᵢⱼ|²`, with `eᵢⱼ = xⱼ − xᵢ` now and `rᵢⱼ` at rest, weighted by
/// `1/|rᵢⱼ|`
///
/// Units: none; in 0..=1; invariant to rigid motion and scale, of the whole and in effect of each neighbourhood. It
/// sees bending as well as stretching, which angles and areas do not. A vertex whose edges have no length adds nothing.
/// Source: beyond the paper, after as-similar-as-possible deformation (Sorkine and Alexa 2007 with a free scale). Off
/// in `paper`.
pub struct LocalShape {
    /// The neighbours of each vertex; the values below lie beside them.
    rings: Rows<u32>,
    rest: Vec<Vector3>,
    weights: Vec<f64>,
    rest_square: Vec<f64>,
}

impl LocalShape {
    /// The term that keeps the one-rings of `rest` over the edges of `triangulation`.
    pub fn new(triangulation: &Triangulation, rest: &Positions) -> Self {
        let p = rest.as_slice();
        let edge = |i: usize, j: u32| p[j as usize] - p[i];
        let rings = Rows::from_lists(triangulation.vertices().map(|v| {
            let around = triangulation.vertex_neighbours(v).iter();
            let around = around.map(|w| w.index() as u32);
            around.filter(move |&j| edge(v.index(), j).norm_squared() > f64::MIN_POSITIVE)
        }));
        let edges: Vec<Vector3> = (0..rings.len())
            .flat_map(|i| rings[i].iter().map(move |&j| edge(i, j)))
            .collect();
        let sum = |i: usize| edges[rings.range(i)].iter().map(|r| r.norm());
        Self {
            rest_square: (0..rings.len())
                .map(|i| sum(i).fold(0.0, |sum, r| sum + r))
                .collect(),
            weights: edges.iter().map(|r| 1.0 / r.norm()).collect(),
            rest: edges,
            rings,
        }
    }
}

impl LocalShape {
    /// Moves each vertex of `free` once, in their order, half the way to where its edges would have it:
    /// `Σⱼ wᵢⱼ (xⱼ + ½ (sᵢRᵢ + sⱼRⱼ)(rᵢ − rⱼ)) / Σⱼ wᵢⱼ`, with the best frames sR of the one-rings.
    ///
    /// Repeated, it undoes folds of a small patch from its surroundings inwards. Vertices without an edge stay.
    pub fn relax(&self, x: &mut Positions, free: &[VertexId]) {
        for &v in free {
            let i = v.index();
            let frame = self.frame(x.as_slice(), i);
            let (mut sum, mut total) = (Vector3::zeros(), 0.0);
            for k in self.ring(i) {
                let j = self.rings.items()[k] as usize;
                let carried = (frame + self.frame(x.as_slice(), j)) * self.rest[k] * 0.5;
                sum += (x.as_slice()[j].coords - carried) * self.weights[k];
                total += self.weights[k];
            }
            if total > 0.0 {
                x[v] = nalgebra::center(&x[v], &(sum / total).into());
            }
        }
    }

    fn ring(&self, i: usize) -> std::ops::Range<usize> {
        self.rings.range(i)
    }

    /// The turn and scale that carry the one-ring of vertex `i` at rest best to where it is.
    fn frame(&self, x: &[mesh_core::Point3], i: usize) -> Matrix3<f64> {
        let mut covariance = Matrix3::zeros();
        for k in self.ring(i) {
            let e = x[self.rings.items()[k] as usize] - x[i];
            covariance += (e * self.weights[k]) * self.rest[k].transpose();
        }
        let rotation = nearest_rotation(&covariance);
        let scale = rotation.dot(&covariance) / self.rest_square[i].max(f64::MIN_POSITIVE);
        rotation * scale
    }
}

impl Loss for LocalShape {
    fn accumulate(&self, x: &Positions, weight: f64, grad: &mut VertexData<Vector3>) -> f64 {
        let share = 1.0 / x.len().max(1) as f64;
        let (x, grad) = (x.as_slice(), grad.as_mut_slice());
        let mut sum = 0.0;
        for i in 0..x.len() {
            let ring = self.ring(i);
            let mut covariance = Matrix3::zeros();
            let mut square = 0.0;
            for k in ring.clone() {
                let e = x[self.rings.items()[k] as usize] - x[i];
                square += self.weights[k] * e.norm_squared();
                covariance += (e * self.weights[k]) * self.rest[k].transpose();
            }
            if square <= f64::MIN_POSITIVE || self.rest_square[i] <= 0.0 {
                continue;
            }
            // max over R of tr(Rᵀ C) = c; then the minimum over s is 1 − c² / (Σ|e|² Σ|r|²).
            let rotation = nearest_rotation(&covariance);
            let c = rotation.dot(&covariance);
            let fit = c / (square * self.rest_square[i]);
            sum += 1.0 - c * fit;

            let scale = 2.0 * weight * share * fit;
            for k in ring {
                let j = self.rings.items()[k] as usize;
                let e = x[j] - x[i];
                let g = (e * (c / square) - rotation * self.rest[k]) * (scale * self.weights[k]);
                grad[j] += g;
                grad[i] -= g;
            }
        }
        sum * share
    }
}
