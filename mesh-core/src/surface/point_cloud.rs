//! Point cloud as a target.

use super::denoise::{denoised, Denoised};
use super::neighbourhood::{boundary, neighbourhoods, noise, strays};
use super::{propagate, Location, NormalSign, SurfacePoint, SurfaceSample, TargetSurface};
use crate::bvh::BoxTree;
use crate::sampling::SeededRng;
use crate::{Aabb, Point3, TopologyError, Vector3};

/// A target made of points, with normals that are given or estimated.
///
/// Normals come from planes through 16 neighbours where none are given, and are turned outwards as far as the cloud
/// tells (see [`TargetSurface::normal_sign`]). The closest *point* jumps from one point to the next: distances below
/// the spacing of the cloud mean nothing.
///
/// ```
/// use mesh_core::{shapes, Location, Point3, PointCloud, TargetSurface};
/// let cloud = PointCloud::new(shapes::icosphere(3).positions, None)?;
/// let closest = cloud.closest_point(&Point3::new(0.0, 0.0, 2.0));
/// assert!(cloud.normal(&closest.location).is_some_and(|n| n.z > 0.99));
/// # Ok::<(), mesh_core::TopologyError>(())
/// ```
pub struct PointCloud {
    tree: PointTree,
    points: Vec<Point3>,
    /// Zero where there is none.
    normals: Vec<Vector3>,
    has_given_normals: bool,
    sign: NormalSign,
    is_on_boundary: Vec<bool>,
    strays: Vec<u32>,
    /// Root of the mean squared distance to the neighbours of each point.
    spacing: Vec<f64>,
    /// How flat the neighbours of each point lie, 0..=1.
    flatness: Vec<f64>,
    noise: f64,
    bounds: Aabb,
}

impl PointCloud {
    /// The target with these points; `normals`, one per point, of any length: one of length 0 is estimated.
    ///
    /// # Errors
    /// No point, a coordinate that is not finite, or some other number of normals than points.
    pub fn new(points: Vec<Point3>, normals: Option<Vec<Vector3>>) -> Result<Self, TopologyError> {
        check(&points, normals.as_deref())?;
        let bounds = Aabb::of(&points);
        let tree = PointTree::new(&points, bounds);
        let given = normals.map(|normals| normals.iter().map(unit_or_zero).collect::<Vec<_>>());

        let mut around = neighbourhoods(&tree, &points, given.as_deref());
        let sign = propagate::orient(&points, &mut around, given.is_some());
        Ok(Self {
            is_on_boundary: boundary(&around),
            strays: strays(&around),
            noise: noise(&around),
            has_given_normals: given.is_some(),
            flatness: around.iter().map(|n| n.flatness).collect(),
            spacing: around.iter().map(|n| n.area.sqrt()).collect(),
            normals: around.into_iter().map(|n| n.normal).collect(),
            tree,
            points,
            sign,
            bounds,
        })
    }

    /// How many points there are.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Points that lie far from the others, by row, ascending: their neighbours are several times as far from them as
    /// the neighbours are from each other. Sparse regions of an uneven cloud are no strays.
    pub fn strays(&self) -> &[u32] {
        &self.strays
    }

    /// How far points lie off the planes of their neighbours in another way than these neighbours do, as a share of the
    /// root of their mean squared distance, in the median. Exact samples of a surface come to 0.02, sparse ones of
    /// shapes with thin parts to 0.06, noise of half the distance to the next point to 0.15.
    pub fn noise(&self) -> f64 {
        self.noise
    }

    /// The cloud without its noise: points are moved across into the planes of their neighbours, and those that stay far
    /// off are left out. None where the points are exact; see [`Self::noise`].
    pub fn denoised(&self) -> Option<Denoised> {
        denoised(
            &self.tree,
            &self.points,
            &self.normals,
            self.has_given_normals,
            self.noise,
        )
    }

    /// The points, by row.
    pub(super) fn points(&self) -> &[Point3] {
        &self.points
    }

    /// Root of the mean squared distance of each point to its 24 nearest.
    pub(super) fn spacing(&self) -> &[f64] {
        &self.spacing
    }

    /// How flat the neighbours of each point lie, 0..=1; 1 where the normal was given.
    pub(super) fn flatness(&self) -> &[f64] {
        &self.flatness
    }

    /// Whether there is no point: never.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }
}

impl TargetSurface for PointCloud {
    fn closest_point(&self, query: &Point3) -> SurfacePoint {
        self.closest_point_from(query, u32::MAX)
    }

    fn closest_point_from(&self, query: &Point3, hint: u32) -> SurfacePoint {
        let (index, distance_squared) = self.tree.nearest(query, hint);
        SurfacePoint {
            point: self.points[index as usize],
            distance_squared,
            location: Location::Point { index },
        }
    }

    fn sample(&self, n: usize, rng: &mut SeededRng) -> Vec<SurfaceSample> {
        let mut sample = || {
            let index = rng.below(self.points.len());
            SurfaceSample {
                point: self.points[index],
                location: Location::Point {
                    index: index as u32,
                },
            }
        };
        (0..n).map(|_| sample()).collect()
    }

    fn vertices(&self) -> Vec<Point3> {
        self.points.clone()
    }

    fn normal(&self, location: &Location) -> Option<Vector3> {
        match location {
            Location::Point { index } => {
                Some(self.normals[*index as usize]).filter(|n| *n != Vector3::zeros())
            }
            Location::Triangle { .. } => None,
        }
    }

    fn normal_sign(&self) -> NormalSign {
        self.sign
    }

    fn is_on_boundary(&self, location: &Location) -> bool {
        match location {
            Location::Point { index } => self.is_on_boundary[*index as usize],
            Location::Triangle { .. } => false,
        }
    }

    fn bounds(&self) -> Aabb {
        self.bounds
    }
}

fn check(points: &[Point3], normals: Option<&[Vector3]>) -> Result<(), TopologyError> {
    if points.is_empty() {
        return Err(TopologyError::NoPoints);
    }
    let is_finite = |p: &Point3| p.coords.iter().all(|c| c.is_finite());
    if let Some(vertex) = points.iter().position(|p| !is_finite(p)) {
        return Err(TopologyError::NonFiniteCoordinate { vertex });
    }
    match normals {
        Some(normals) if normals.len() != points.len() => Err(TopologyError::NormalCount {
            n_normals: normals.len(),
            n_points: points.len(),
        }),
        _ => Ok(()),
    }
}

/// Zero also for a normal that is not finite.
fn unit_or_zero(n: &Vector3) -> Vector3 {
    n.try_normalize(0.0)
        .filter(|n| n.iter().all(|c| c.is_finite()))
        .unwrap_or_default()
}

/// A box tree over points, and the points in its order.
pub(super) struct PointTree {
    tree: BoxTree,
    points: Vec<Point3>,
}

impl PointTree {
    pub(super) fn of(points: &[Point3]) -> Self {
        Self::new(points, Aabb::of(points))
    }

    fn new(points: &[Point3], bounds: Aabb) -> Self {
        let of_row = |row: usize| Aabb {
            min: points[row],
            max: points[row],
        };
        let tree = BoxTree::new(bounds, points.len(), of_row);
        let points = tree
            .rows()
            .iter()
            .map(|&row| points[row as usize])
            .collect();
        Self { tree, points }
    }

    /// The row of each point, in an order in which neighbours are close.
    pub(super) fn rows(&self) -> &[u32] {
        self.tree.rows()
    }

    /// The place of a row in that order.
    pub(super) fn slot(&self, row: u32) -> u32 {
        self.tree.slot(row)
    }

    /// The nearest point, the lowest row among equals, and its squared distance; sooner if that in row `hint` is near.
    fn nearest(&self, query: &Point3, hint: u32) -> (u32, f64) {
        let mut best = (0, f64::INFINITY);
        if (hint as usize) < self.points.len() {
            let hinted = self.points[self.tree.slot(hint) as usize];
            best = (hint, (hinted - query).norm_squared());
        }
        self.tree.nearest(query, best.1, |slot| {
            let d = (self.points[slot as usize] - query).norm_squared();
            let row = self.tree.rows()[slot as usize];
            if d < best.1 || (d == best.1 && row < best.0) {
                best = (row, d);
            }
            best.1
        });
        best
    }

    /// The `k` nearest points, nearest first, the lower row first among equals.
    pub(super) fn nearest_rows(&self, query: &Point3, k: usize) -> Vec<u32> {
        let mut best: Vec<(f64, u32)> = Vec::with_capacity(k + 1);
        self.tree.nearest(query, f64::INFINITY, |slot| {
            let candidate = (
                (self.points[slot as usize] - query).norm_squared(),
                self.tree.rows()[slot as usize],
            );
            let at = best.partition_point(|&b| b < candidate);
            if at < k {
                best.truncate(k - 1);
                best.insert(at, candidate);
            }
            best.get(k - 1).map_or(f64::INFINITY, |b| b.0)
        });
        best.into_iter().map(|(_, row)| row).collect()
    }
}
