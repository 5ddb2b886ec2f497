//! Every one-ring stays a turned and scaled copy of itself.

use mesh_core::{Positions, Triangulation, Vector3, VertexData, VertexId};
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
    starts: Vec<u32>,
    neighbours: Vec<u32>,
    rest: Vec<Vector3>,
    weights: Vec<f64>,
    rest_square: Vec<f64>,
}

impl LocalShape {
    /// The term that keeps the one-rings of `rest` over the edges of `triangulation`.
    pub fn new(triangulation: &Triangulation, rest: &Positions) -> Self {
        let mut sides: Vec<[u32; 2]> = triangulation
            .triangles()
            .iter()
            .flat_map(|&[a, b, c]| [[a, b], [b, a], [b, c], [c, b], [c, a], [a, c]])
            .map(|pair| pair.map(|v| v.index() as u32))
            .collect();
        sides.sort_unstable();
        sides.dedup();
        let p = rest.as_slice();
        let edge = |&[i, j]: &[u32; 2]| p[j as usize] - p[i as usize];
        sides.retain(|side| edge(side).norm_squared() > f64::MIN_POSITIVE);

        let edges: Vec<Vector3> = sides.iter().map(edge).collect();
        let mut starts = vec![0u32; p.len() + 1];
        let mut rest_square = vec![0.0; p.len()];
        for ([i, _], r) in sides.iter().zip(&edges) {
            starts[*i as usize + 1] += 1;
            rest_square[*i as usize] += r.norm();
        }
        for i in 0..p.len() {
            starts[i + 1] += starts[i];
        }
        Self {
            starts,
            neighbours: sides.iter().map(|s| s[1]).collect(),
            weights: edges.iter().map(|r| 1.0 / r.norm()).collect(),
            rest: edges,
            rest_square,
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
                let j = self.neighbours[k] as usize;
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
        self.starts[i] as usize..self.starts[i + 1] as usize
    }

    /// The turn and scale that carry the one-ring of vertex `i` at rest best to where it is.
    fn frame(&self, x: &[mesh_core::Point3], i: usize) -> Matrix3<f64> {
        let mut covariance = Matrix3::zeros();
        for k in self.ring(i) {
            let e = x[self.neighbours[k] as usize] - x[i];
            covariance += (e * self.weights[k]) * self.rest[k].transpose();
        }
        let rotation = closest_rotation(&covariance);
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
                let e = x[self.neighbours[k] as usize] - x[i];
                square += self.weights[k] * e.norm_squared();
                covariance += (e * self.weights[k]) * self.rest[k].transpose();
            }
            if square <= f64::MIN_POSITIVE || self.rest_square[i] <= 0.0 {
                continue;
            }
            // max over R of tr(Rᵀ C) = c; then the minimum over s is 1 − c² / (Σ|e|² Σ|r|²).
            let rotation = closest_rotation(&covariance);
            let c = rotation.dot(&covariance);
            let fit = c / (square * self.rest_square[i]);
            sum += 1.0 - c * fit;

            let scale = 2.0 * weight * share * fit;
            for k in ring {
                let j = self.neighbours[k] as usize;
                let e = x[j] - x[i];
                let g = (e * (c / square) - rotation * self.rest[k]) * (scale * self.weights[k]);
                grad[j] += g;
                grad[i] -= g;
            }
        }
        sum * share
    }
}

/// The rotation R that makes tr(Rᵀ C) largest, from the two larger singular vectors of C.
fn closest_rotation(c: &Matrix3<f64>) -> Matrix3<f64> {
    let (v1, v2) = larger_eigenvectors(c.transpose() * c);
    let (c1, c2) = (c * v1, c * v2);
    let Some(u1) = c1.try_normalize(f64::MIN_POSITIVE) else {
        return Matrix3::identity();
    };
    let Some(u2) = (c2 - u1 * u1.dot(&c2)).try_normalize(f64::MIN_POSITIVE) else {
        return Matrix3::identity();
    };
    u1 * v1.transpose() + u2 * v2.transpose() + u1.cross(&u2) * v1.cross(&v2).transpose()
}

/// Unit eigenvectors of the two larger eigenvalues of a symmetric matrix, by Jacobi rotations.
fn larger_eigenvectors(mut a: Matrix3<f64>) -> (Vector3, Vector3) {
    let mut v = Matrix3::identity();
    let size = a.norm_squared();
    for _ in 0..8 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if a[(p, q)] * a[(p, q)] <= 1e-32 * size {
                continue;
            }
            let theta = 0.5 * (a[(q, q)] - a[(p, p)]) / a[(p, q)];
            let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
            let cos = 1.0 / (t * t + 1.0).sqrt();
            let sin = t * cos;
            rotate(&mut a, &mut v, (p, q), (cos, sin));
        }
        let off = a[(0, 1)].powi(2) + a[(0, 2)].powi(2) + a[(1, 2)].powi(2);
        if off <= 1e-31 * size {
            break;
        }
    }
    let smallest = (0..3).fold(0, |s, k| if a[(k, k)] < a[(s, s)] { k } else { s });
    let (k, l) = ((smallest + 1) % 3, (smallest + 2) % 3);
    let (large, small) = if a[(k, k)] >= a[(l, l)] {
        (k, l)
    } else {
        (l, k)
    };
    (v.column(large).into(), v.column(small).into())
}

/// `a ← Jᵀ a J`, `v ← v J` for a rotation J in the plane (p, q).
fn rotate(
    a: &mut Matrix3<f64>,
    v: &mut Matrix3<f64>,
    (p, q): (usize, usize),
    (cos, sin): (f64, f64),
) {
    for k in 0..3 {
        let (kp, kq) = (a[(k, p)], a[(k, q)]);
        a[(k, p)] = cos * kp - sin * kq;
        a[(k, q)] = sin * kp + cos * kq;
    }
    for k in 0..3 {
        let (pk, qk) = (a[(p, k)], a[(q, k)]);
        a[(p, k)] = cos * pk - sin * qk;
        a[(q, k)] = sin * pk + cos * qk;
        let (kp, kq) = (v[(k, p)], v[(k, q)]);
        v[(k, p)] = cos * kp - sin * kq;
        v[(k, q)] = sin * kp + cos * kq;
    }
}
