//! Target surfaces: what can be draped onto. A target needs no connectivity.

mod denoise;
mod exposure;
mod neighbourhood;
mod open_boundary;
mod orientation;
mod patches;
mod point_cloud;
mod point_tree;
mod propagate;
mod stray;
mod surfels;
mod triangle_soup;
mod welded;

pub use exposure::is_exposed;
pub use patches::Patches;
pub use point_cloud::{Denoised, PointCloud};
pub use stray::Strays;
pub use surfels::SurfelCloud;
pub use triangle_soup::TriangleSoup;

use rayon::prelude::*;

use crate::sampling::SeededRng;
use crate::{Aabb, Point3, UnitFrame, Vector3};

/// A place on a target surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Location {
    /// Inside a triangle, on its edge or corner.
    Triangle {
        /// Row of the triangle.
        index: u32,
        /// Weights of its corners, each ≥ 0, summing to 1.
        barycentric: [f64; 3],
    },
    /// A point of a cloud.
    Point {
        /// Row of the point.
        index: u32,
    },
}

impl Location {
    /// Row of the triangle or point: a hint for the next query nearby.
    pub const fn row(&self) -> u32 {
        match *self {
            Self::Triangle { index, .. } | Self::Point { index } => index,
        }
    }
}

/// The closest point of a surface to a query.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Where it is.
    pub point: Point3,
    /// Squared distance to the query, in squared units of the coordinates.
    pub distance_squared: f64,
    /// Which part of the surface it is on.
    pub location: Location,
}

/// A random point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceSample {
    /// Where it is.
    pub point: Point3,
    /// Which part of the surface it is on.
    pub location: Location,
}

/// How far the sign of a surface's normals can be trusted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NormalSign {
    /// Normals point outwards (or at least all to one side).
    Oriented,
    /// Only the line of a normal means something.
    Unoriented,
}

/// A shape to drape onto: a triangle soup (any defects) or a point cloud.
pub trait TargetSurface: Send + Sync {
    /// The point of the surface closest to `query`; the lowest row among equals.
    fn closest_point(&self, query: &Point3) -> SurfacePoint;

    /// The same answer, found faster if the triangle or point in row `hint` is close to `query`; a row that does not
    /// exist is no hint.
    fn closest_point_from(&self, query: &Point3, hint: u32) -> SurfacePoint;

    /// The closest point to each query, in parallel; the same bits whatever the thread count.
    fn closest_points(&self, queries: &[Point3]) -> Vec<SurfacePoint> {
        queries
            .par_iter()
            .with_min_len(64)
            .map(|q| self.closest_point(q))
            .collect()
    }

    /// `n` random places, uniform by area, or over the points of a cloud.
    fn sample(&self, n: usize, rng: &mut SeededRng) -> Vec<SurfaceSample>;

    /// The corners of the triangles, each once, or the points of the cloud: where samples never fall exactly.
    ///
    /// Positions that no triangle uses are left out.
    fn vertices(&self) -> Vec<Point3>;

    /// Unit normal at a place of this surface; none where the surface is degenerate.
    fn normal(&self, location: &Location) -> Option<Vector3>;

    /// Whether the sign of [`Self::normal`] means something.
    fn normal_sign(&self) -> NormalSign;

    /// Whether the place lies on an open boundary of the surface: the edge of a hole, the end of a scan. Cracks are none.
    fn is_on_boundary(&self, location: &Location) -> bool;

    /// The surface divided among places on it, which tells what hangs together along it; none of a cloud, whose points
    /// nothing joins.
    fn patches(&self, _places: &[SurfaceSample]) -> Option<Patches> {
        None
    }

    /// The smallest box around the surface.
    fn bounds(&self) -> Aabb;

    /// The frame of the surface along its principal axes: what deformations measure lengths in, so that they do not
    /// depend on how the surface is turned.
    fn principal_frame(&self) -> UnitFrame {
        UnitFrame::principal(&self.vertices())
    }
}
