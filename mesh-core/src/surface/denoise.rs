//! The surface among points that scatter about it.

use rayon::prelude::*;

use super::neighbourhood::{median, neighbours_of, Plane};
use super::point_cloud::PointTree;
use super::PointCloud;
use crate::{Point3, Vector3};

/// A cloud is exact whose noise ([`PointCloud::noise`]) is below the first of these, and is moved into the planes of its
/// neighbours if it is above the second; in between, part of the way. Exact clouds come to 0.02, sparse ones of shapes
/// with thin parts to 0.06, noise of half the distance to the next point to 0.15.
const NOISE: [f64; 2] = [0.08, 0.12];
/// Neighbours count for a plane by this power of the cosine between normals: sheets that meet at an angle stay apart.
const SHARPNESS: i32 = 4;
/// However their normals differ, neighbours count this much.
const LEAST_WEIGHT: f64 = 1e-3;
/// Points farther off their plane than this many times the median are not moved: there the plane is wrong, or they are
/// no part of the surface; if they still are so far off when all are moved, they are left out.
const MOST: f64 = 4.0;

/// A cloud without its noise.
pub struct Denoised {
    /// The points in the planes of their neighbours.
    pub cloud: PointCloud,
    /// How far points lay off these planes, in the median, in the units of the coordinates.
    pub scatter: f64,
    /// Points that were left out: they lie off the surface that the others make up.
    pub n_left_out: usize,
}

/// Each point in the plane of its neighbours, without those that stay far off; none where the points are exact.
///
/// `p + s·n nᵀ(m − p)`, where `m` and `n` are mean and normal of the plane of least squares of the 24 nearest, which
/// count by `(nᵢ·nⱼ)⁴`, and `s` in 0..=1 grows with the noise. One step of moving least squares (after Alexa et al.
/// 2003) with normals that keep edges sharp (after Öztireli et al. 2009). Parallel walls closer than the neighbours are
/// not told apart: the signs of noisy normals are not known.
pub(super) fn denoised(
    tree: &PointTree,
    points: &[Point3],
    normals: &[Vector3],
    has_normals: bool,
    noise: f64,
) -> Option<Denoised> {
    let step = ((noise - NOISE[0]) / (NOISE[1] - NOISE[0])).min(1.0);
    if step.is_nan() || step <= 0.0 {
        return None;
    }
    let off = to_planes(tree, points, normals);
    let scatter = typical(&off);
    let moved: Vec<Point3> = points
        .iter()
        .zip(&off)
        .map(|(p, d)| {
            p + if d.norm() > MOST * scatter {
                Vector3::zeros()
            } else {
                d * step
            }
        })
        .collect();

    let left = to_planes(&PointTree::of(&moved), &moved, normals);
    let most = MOST / step * typical(&left);
    let is_kept: Vec<bool> = left.iter().map(|d| d.norm() <= most).collect();
    let kept = |row: &usize| is_kept[*row];
    let rows: Vec<usize> = (0..points.len()).filter(kept).collect();
    let normals = has_normals.then(|| rows.iter().map(|&row| normals[row]).collect());
    let cloud = PointCloud::new(rows.iter().map(|&row| moved[row]).collect(), normals).ok()?;
    Some(Denoised {
        cloud,
        scatter,
        n_left_out: points.len() - rows.len(),
    })
}

/// The way from each point across to the plane of its neighbours; zero where they lie on a line.
fn to_planes(tree: &PointTree, points: &[Point3], normals: &[Vector3]) -> Vec<Vector3> {
    let to_plane = |row: usize| {
        let around = neighbours_of(tree, points, row as u32);
        let weight = |n: usize| normals[row].dot(&normals[n]).powi(SHARPNESS) + LEAST_WEIGHT;
        let of = |n: u32| (points[n as usize] - points[row], weight(n as usize));
        let plane = Plane::of(around.into_iter().map(of));
        plane.normal * plane.normal.dot(&plane.mean)
    };
    let rows = 0..points.len();
    rows.into_par_iter()
        .with_min_len(64)
        .map(to_plane)
        .collect()
}

fn typical(off: &[Vector3]) -> f64 {
    median(off.iter().map(Vector3::norm))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{shapes, TargetSurface};

    fn cloud(points: Vec<Point3>) -> PointCloud {
        PointCloud::new(points, None).unwrap()
    }

    /// A ball of 2 562 points, 0.07 apart, off by up to `noise`.
    fn ball(noise: f64) -> Vec<Point3> {
        let mut points = shapes::icosphere(4).positions;
        for (k, p) in points.iter_mut().enumerate() {
            *p *= 1.0 + 2.0 * noise * ((k as f64 * 0.618_034).fract() - 0.5);
        }
        points
    }

    fn off(points: &[Point3]) -> f64 {
        let off = points.iter().map(|p| (p.coords.norm() - 1.0).abs());
        off.sum::<f64>() / points.len() as f64
    }

    #[test]
    fn exact_points_stay() {
        assert!(cloud(ball(0.0)).denoised().is_none());
        assert!(cloud(shapes::open_grid(12, 12).positions)
            .denoised()
            .is_none());
        assert!(cloud(vec![Point3::origin(); 40]).denoised().is_none());
    }

    #[test]
    fn points_that_scatter_are_moved_back() {
        let noisy = cloud(ball(0.05));
        let denoised = noisy.denoised().unwrap();
        assert!(off(&noisy.vertices()) > 0.024);
        // The mean over 25 points, and the arc that they span, leave 0.01.
        assert!(off(&denoised.cloud.vertices()) < 0.013);
        assert!(denoised.n_left_out < 60, "{}", denoised.n_left_out);
        assert!(denoised.scatter > 0.015 && denoised.scatter < 0.05);
    }

    #[test]
    fn points_beside_the_surface_are_left_out() {
        let mut points = ball(0.05);
        let n = points.len();
        let beside: Vec<Point3> = (0..8).map(|k| points[k * 300] * 1.25).collect();
        points.extend(beside);
        let denoised = cloud(points).denoised().unwrap();
        assert!(denoised.n_left_out >= 8);
        let out = denoised.cloud.vertices();
        assert!(out.len() > n - 60);
        assert!(out.iter().all(|p| p.coords.norm() < 1.2));
    }
}
