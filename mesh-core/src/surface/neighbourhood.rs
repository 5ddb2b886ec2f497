//! The surroundings of each point of a cloud: tangent plane, spacing, and whether the surface ends there.

use std::f64::consts::TAU;

use nalgebra::{Matrix3, SymmetricEigen};
use rayon::prelude::*;

use super::point_tree::PointTree;
use crate::{Point3, UnionFind, Vector3};

/// Neighbours that make up a surrounding.
const K: usize = 24;
/// The nearest of them, that make up a plane. Fewer follow noise, more cut corners.
const N_IN_PLANE: usize = 16;
/// A point whose neighbours are farther than this many times what they are from their own is stray. On a surface with
/// even noise the ratio stays below 2; where the density of a cloud steps, points at the step see half of each.
const FAR: f64 = 3.0;
/// A group of fewer than this share of the points, spaced wider than this many times what is usual, is stray, too.
const SMALL: f64 = 0.01;
const SPARSE: f64 = 1.5;
/// Neighbours that are kept for propagation.
pub(super) const N_KEPT: usize = 8;
/// No neighbour.
pub(super) const NONE: u32 = u32::MAX;
/// A gap between the directions to neighbours wider than this (140°) makes a boundary point: on a straight boundary it is
/// 180°. With these three values all points near the boundary of a random flat cloud are found, and fewer than 0.3 % of
/// those inside.
const WIDE: f64 = TAU * 140.0 / 360.0;
/// Neighbours nearer than this share of the farthest do not count for the gap: their directions are accidental.
const NEAR: f64 = 0.4;
/// A boundary runs on: at least this many kept neighbours must be on it, too.
const N_COMPANIONS: usize = 1;
/// Spread across the widest direction, below which neighbours lie on a line: as a share of the spread along it.
const LINE: f64 = 1e-6;

/// What the neighbours of a point tell about the surface there.
#[derive(Clone, Debug)]
pub(super) struct Neighbourhood {
    /// Unit normal of the plane of least squares, of either sign; zero where neighbours lie on a line.
    pub(super) normal: Vector3,
    /// The nearest other points, nearest first, [`NONE`] where the cloud has no more.
    pub(super) nearest: [u32; N_KEPT],
    /// Mean squared distance to the neighbours: proportional to the area the point stands for.
    pub(super) area: f64,
    /// How flat the neighbours lie, from 0 (they fill space, and the normal means nothing) to 1; 1 for a given normal.
    pub(super) flatness: f64,
    /// The way from the point across to the mean of its neighbours.
    to_plane: Vector3,
    /// Whether neighbours leave a wide gap around the normal.
    has_gap: bool,
}

/// The neighbourhood of each point. `normals` are used instead of estimated ones where they are not zero.
pub(super) fn neighbourhoods(
    tree: &PointTree,
    points: &[Point3],
    normals: Option<&[Vector3]>,
) -> Vec<Neighbourhood> {
    // In the order of the tree, where one search finds in the cache what the last one left there.
    let by_slot: Vec<Neighbourhood> = tree
        .rows()
        .par_iter()
        .with_min_len(64)
        .map(|&row| {
            let neighbours = neighbours_of(tree, points, row);
            let given = normals.map(|n| n[row as usize]);
            neighbourhood(points, row as usize, &neighbours, given)
        })
        .collect();
    let slots = (0..points.len() as u32).map(|row| tree.slot(row) as usize);
    slots.map(|slot| by_slot[slot].clone()).collect()
}

/// The nearest other points, nearest first.
pub(super) fn neighbours_of(tree: &PointTree, points: &[Point3], row: u32) -> Vec<u32> {
    let mut neighbours = tree.nearest_rows(&points[row as usize], K + 1);
    neighbours.retain(|&n| n != row);
    neighbours.truncate(K);
    neighbours
}

/// How far points lie off the planes of their neighbours in another way than these neighbours do, as a share of the
/// spacing, in the median: bends are shared, noise is not.
pub(super) fn noise(neighbourhoods: &[Neighbourhood]) -> f64 {
    let shares = neighbourhoods.iter().map(|n| {
        let around = n.nearest.iter().filter(|&&row| row != NONE);
        let (count, sum) = around.fold((0, Vector3::zeros()), |(count, sum), &row| {
            (count + 1, sum + neighbourhoods[row as usize].to_plane)
        });
        (n.to_plane - sum / f64::from(count)).norm() / n.area.sqrt()
    });
    median(shares.filter(|share| share.is_finite()))
}

/// Whether the surface ends at each point: a wide gap, and others with one beside it (after Bendels et al. 2006).
pub(super) fn boundary(neighbourhoods: &[Neighbourhood]) -> Vec<bool> {
    let has_gap = |&&n: &&u32| n != NONE && neighbourhoods[n as usize].has_gap;
    neighbourhoods
        .iter()
        .map(|n| n.has_gap && n.nearest.iter().filter(has_gap).count() >= N_COMPANIONS)
        .collect()
}

/// Rows of points that are no part of the surface: each is much farther from its neighbours than those are from theirs
/// (after Breunig et al. 2000, "LOF", with the median in place of the mean), or is in a small and sparse group.
pub(super) fn strays(neighbourhoods: &[Neighbourhood]) -> Vec<u32> {
    let is_alone: Vec<bool> = neighbourhoods
        .iter()
        .map(|n| {
            let around = n.nearest.iter().filter(|&&row| row != NONE);
            let usual = median(around.map(|&row| neighbourhoods[row as usize].area));
            usual > 0.0 && n.area > FAR * FAR * usual
        })
        .collect();
    let group_of = groups(neighbourhoods, &is_alone);
    let mut sizes = vec![0usize; neighbourhoods.len()];
    let mut areas = vec![0.0; neighbourhoods.len()];
    for (&g, n) in group_of.iter().zip(neighbourhoods) {
        sizes[g] += 1;
        areas[g] += n.area;
    }
    let usual = median(neighbourhoods.iter().map(|n| n.area));
    let is_sparse = |g: usize| {
        let is_small = (sizes[g] as f64) < SMALL * neighbourhoods.len() as f64;
        is_small && areas[g] > SPARSE * SPARSE * usual * sizes[g] as f64
    };
    (0..neighbourhoods.len())
        .filter(|&row| is_alone[row] || is_sparse(group_of[row]))
        .map(|row| row as u32)
        .collect()
}

/// The point that stands for the group of each point: points are joined that are among the nearest of each other.
fn groups(neighbourhoods: &[Neighbourhood], is_out: &[bool]) -> Vec<usize> {
    let mut groups = UnionFind::new(neighbourhoods.len());
    for (row, n) in (0u32..).zip(neighbourhoods) {
        let joined = n.nearest.iter().filter(|&&other| {
            other != NONE
                && other > row
                && neighbourhoods[other as usize].nearest.contains(&row)
                && !is_out[row as usize]
                && !is_out[other as usize]
        });
        joined.for_each(|&other| groups.union(row as usize, other as usize));
    }
    let rows = 0..neighbourhoods.len();
    rows.map(|row| groups.find(row)).collect()
}

/// The upper median; 0 of nothing.
pub(super) fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    let middle = values.len() / 2;
    if values.is_empty() {
        return 0.0;
    }
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

fn neighbourhood(
    points: &[Point3],
    row: usize,
    neighbours: &[u32],
    given: Option<Vector3>,
) -> Neighbourhood {
    let offsets: Vec<Vector3> = neighbours
        .iter()
        .map(|&n| points[n as usize] - points[row])
        .collect();
    let (normal, flatness) = match given.filter(|n| *n != Vector3::zeros()) {
        Some(normal) => (normal, 1.0),
        None => {
            let near = offsets.iter().take(N_IN_PLANE).copied();
            let plane = Plane::of(near.chain([Vector3::zeros()]).map(|o| (o, 1.0)));
            (plane.normal, plane.flatness)
        }
    };
    let mut nearest = [NONE; N_KEPT];
    for (kept, &n) in nearest.iter_mut().zip(neighbours) {
        *kept = n;
    }
    let mean = offsets.iter().sum::<Vector3>() / offsets.len().max(1) as f64;
    Neighbourhood {
        to_plane: normal * normal.dot(&mean),
        normal,
        nearest,
        area: offsets.iter().map(Vector3::norm_squared).sum::<f64>() / offsets.len().max(1) as f64,
        flatness,
        has_gap: widest_gap(&offsets, &normal) > WIDE,
    }
}

/// The plane of least squares of weighted points.
pub(super) struct Plane {
    /// Their mean.
    pub(super) mean: Vector3,
    /// The direction in which they spread least, of length 1; zero where they lie on a line.
    pub(super) normal: Vector3,
    /// How flat they lie: 1 while the least spread is below a tenth of the middle one, falling to 0 at three tenths.
    pub(super) flatness: f64,
}

impl Plane {
    pub(super) fn of(weighted: impl Iterator<Item = (Vector3, f64)> + Clone) -> Self {
        let (sum, total) = weighted
            .clone()
            .fold((Vector3::zeros(), 0.0), |(sum, total), (o, w)| {
                (sum + o * w, total + w)
            });
        let mean = sum / total;
        let spread = weighted
            .map(|(o, w)| (o - mean, w))
            .map(|(o, w)| o * o.transpose() * w)
            .sum::<Matrix3<f64>>();
        let eigen = SymmetricEigen::new(spread);
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
        let [least, middle, most] = order;
        let (normal, flatness) = if eigen.eigenvalues[middle] > LINE * eigen.eigenvalues[most] {
            let thickness = eigen.eigenvalues[least].max(0.0) / eigen.eigenvalues[middle];
            let normal = eigen.eigenvectors.column(least).into_owned();
            (normal, ((0.3 - thickness) / 0.2).clamp(0.0, 1.0))
        } else {
            (Vector3::zeros(), 0.0)
        };
        Self {
            mean,
            normal,
            flatness,
        }
    }
}

/// The widest angle around `normal` without a neighbour; 0 without a normal.
fn widest_gap(offsets: &[Vector3], normal: &Vector3) -> f64 {
    let across = normal.cross(&Vector3::ith(normal.iamin(), 1.0));
    let along = normal.cross(&across);
    let near = NEAR * across.norm() * offsets.last().map_or(0.0, Vector3::norm);
    let mut angles: Vec<f64> = offsets
        .iter()
        .map(|o| (o.dot(&across), o.dot(&along)))
        .filter(|&(x, y)| x.hypot(y) > near)
        .map(|(x, y)| y.atan2(x))
        .collect();
    angles.sort_by(f64::total_cmp);
    let Some((first, last)) = angles.first().zip(angles.last()) else {
        return 0.0;
    };
    let around = first + TAU - last;
    angles
        .windows(2)
        .map(|w| w[1] - w[0])
        .fold(around, f64::max)
}
