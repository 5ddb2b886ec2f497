//! A displacement known at scattered points, extended smoothly to all of space.

use faer::linalg::solvers::{PartialPivLu, Solve};
use faer::Mat;
use mesh_core::{Point3, UnitFrame, Vector3};
use nalgebra::Matrix3;

use crate::SolveError;

/// Points nearer to each other than this share of the longest side of their box count as one centre.
const MIN_SPACING: f64 = 1e-9;
/// A direction in which the centres spread less than this share of their largest spread gets no affine part.
const MIN_SPREAD: f64 = 1e-3;

/// Smooth displacement field over space that takes given values at given points.
///
/// `d(p) = Σᵢ wᵢ |p − cᵢ| + A (p − o) + b`, with `Σᵢ wᵢ = 0` and `Σᵢ wᵢ (cᵢ − o)ᵀ = 0`
///
/// The kernel is the fundamental solution of the biharmonic equation in space, so of all fields through these values
/// this one bends least, and far away it becomes affine. It serves whatever a surface carries along: pieces without a
/// landmark, hair, collision hulls. Points and displacements in any one unit. Degenerate input: where the centres
/// lie on a plane, a line or a point, the affine part acts within it and ignores the other directions.
/// Source: Duchon 1977. Departures: centres are thinned.
#[derive(Clone, Debug, PartialEq)]
pub struct SpaceExtension {
    /// The centres and their weights.
    pub kernels: Vec<Kernel>,
    /// `o`: where the affine part is anchored.
    pub origin: Point3,
    /// `A`: the linear part.
    pub linear: Matrix3<f64>,
    /// `b`: the displacement that the affine part gives at the origin.
    pub constant: Vector3,
}

/// One centre of a [`SpaceExtension`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kernel {
    /// `cᵢ`
    pub center: Point3,
    /// `wᵢ`: displacement per unit of distance.
    pub weight: Vector3,
}

impl SpaceExtension {
    /// The field with displacement `displacements[i]` at `points[i]`, through at most `max_centres` of the points:
    /// those that farthest-point sampling picks. A dense system of that size is solved once.
    ///
    /// # Errors
    /// There is no point, or a coordinate is not finite.
    ///
    /// # Panics
    /// If there is not one displacement for each point.
    pub fn new(
        points: &[Point3],
        displacements: &[Vector3],
        max_centres: usize,
    ) -> Result<Self, SolveError> {
        assert_eq!(
            points.len(),
            displacements.len(),
            "one displacement for each point"
        );
        let frame = UnitFrame::principal(points);
        let chosen = farthest_points(points, max_centres, MIN_SPACING * frame.scale);
        let centres: Vec<Vector3> = chosen
            .iter()
            .map(|&i| frame.to_unit(&points[i]).coords)
            .collect();
        let values: Vec<Vector3> = chosen.iter().map(|&i| displacements[i]).collect();
        let axes = spanned_axes(&centres);
        let solved = interpolate(&centres, &axes, &values)?;

        let (weights, affine) = solved.split_at(centres.len());
        let kernels = chosen.iter().zip(weights).map(|(&i, weight)| Kernel {
            center: points[i],
            weight: weight / frame.scale,
        });
        let slopes = axes.iter().zip(&affine[1..]);
        Ok(Self {
            kernels: kernels.collect(),
            origin: frame.center,
            linear: slopes
                .map(|(axis, slope)| slope * axis.transpose())
                .sum::<Matrix3<f64>>()
                / frame.scale,
            constant: affine[0],
        })
    }

    /// The displacement at `p`.
    pub fn displacement_at(&self, p: &Point3) -> Vector3 {
        let affine = self.linear * (p - self.origin) + self.constant;
        let terms = self
            .kernels
            .iter()
            .map(|k| k.weight * (p - k.center).norm());
        terms.fold(affine, |sum, term| sum + term)
    }
}

/// Rows of up to `n` points, each as far as can be from those before it, none nearer than `spacing`.
fn farthest_points(points: &[Point3], n: usize, spacing: f64) -> Vec<usize> {
    let mut nearest = vec![f64::INFINITY; points.len()];
    let mut chosen = Vec::with_capacity(n.min(points.len()));
    let mut candidate = points.first().map(|_| (0, f64::INFINITY));
    while let Some((i, squared)) = candidate.filter(|_| chosen.len() < n) {
        if squared <= spacing * spacing {
            break;
        }
        chosen.push(i);
        candidate = None;
        for (j, (distance, p)) in nearest.iter_mut().zip(points).enumerate() {
            *distance = distance.min((p - points[i]).norm_squared());
            if candidate.is_none_or(|(_, far)| *distance > far) {
                candidate = Some((j, *distance));
            }
        }
    }
    chosen
}

/// The principal directions in which the centres spread.
fn spanned_axes(centres: &[Vector3]) -> Vec<Vector3> {
    let mean = centres.iter().sum::<Vector3>() / centres.len().max(1) as f64;
    let covariance: Matrix3<f64> = centres
        .iter()
        .map(|c| (c - mean) * (c - mean).transpose())
        .sum();
    let eigen = covariance.symmetric_eigen();
    let largest = eigen.eigenvalues.max();
    (0..3)
        .filter(|&k| eigen.eigenvalues[k] > MIN_SPREAD * MIN_SPREAD * largest)
        .map(|k| eigen.eigenvectors.column(k).into_owned())
        .collect()
}

/// Solves `[K P; Pᵀ 0] [w; a] = [d; 0]` with `K_ij = |cᵢ − cⱼ|` and rows `(1, axes · cᵢ)` of `P`.
fn interpolate(
    centres: &[Vector3],
    axes: &[Vector3],
    values: &[Vector3],
) -> Result<Vec<Vector3>, SolveError> {
    let (n, size) = (centres.len(), centres.len() + 1 + axes.len());
    let polynomial = |i: usize, k: usize| {
        if k == 0 {
            1.0
        } else {
            axes[k - 1].dot(&centres[i])
        }
    };
    let system = Mat::from_fn(size, size, |i, j| match (i < n, j < n) {
        (true, true) => (centres[i] - centres[j]).norm(),
        (true, false) => polynomial(i, j - n),
        (false, true) => polynomial(j, i - n),
        (false, false) => 0.0,
    });
    let right = Mat::from_fn(size, 3, |i, axis| values.get(i).map_or(0.0, |d| d[axis]));
    let solved = PartialPivLu::new(system.as_ref()).solve(&right);

    let rows: Vec<Vector3> = (0..size)
        .map(|i| Vector3::new(solved[(i, 0)], solved[(i, 1)], solved[(i, 2)]))
        .collect();
    if n == 0 || rows.iter().any(|row| !row.iter().all(|x| x.is_finite())) {
        return Err(SolveError::SingularField { n_centres: n });
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn farthest_points_spread_and_skip_copies() {
        let points = [0.0, 0.1, 1.0, 0.0, 0.5].map(|x| Point3::new(x, 0.0, 0.0));
        assert_eq!(farthest_points(&points, 3, 1e-9), [0, 2, 4]);
        assert_eq!(farthest_points(&points, 9, 1e-9), [0, 2, 4, 1]);
        assert!(farthest_points(&points, 0, 1e-9).is_empty());
        assert!(farthest_points(&[], 3, 1e-9).is_empty());
    }
}
