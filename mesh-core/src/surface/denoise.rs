//! The surface among points that scatter about it.

use rayon::prelude::*;

use super::neighbourhood::{median, neighbours_of, Plane};
use super::point_tree::PointTree;
use crate::{Point3, Vector3};

/// A cloud is exact whose noise ([`super::PointCloud::noise`]) is below the first of these, and is moved into the planes of its
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

/// Points in the planes of their neighbours.
pub(super) struct InPlanes {
    pub(super) points: Vec<Point3>,
    /// The normal that each had.
    pub(super) normals: Vec<Vector3>,
    /// How far they lay off these planes, in the median.
    pub(super) scatter: f64,
}

/// Each point in the plane of its neighbours, without those that stay far off; none where the points are exact.
///
/// `p + s·n nᵀ(m − p)`, where `m` and `n` are mean and normal of the plane of least squares of the 24 nearest, which
/// count by `(nᵢ·nⱼ)⁴`, and `s` in 0..=1 grows with the noise. One step of moving least squares (after Alexa et al.
/// 2003) with normals that keep edges sharp (after Öztireli et al. 2009). Parallel walls closer than the neighbours are
/// not told apart: the signs of noisy normals are not known.
pub(super) fn in_planes(
    tree: &PointTree,
    points: &[Point3],
    normals: &[Vector3],
    noise: f64,
) -> Option<InPlanes> {
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
    let kept = (0..points.len()).filter(|&row| left[row].norm() <= most);
    let (points, normals) = kept.map(|row| (moved[row], normals[row])).unzip();
    Some(InPlanes {
        points,
        normals,
        scatter,
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
