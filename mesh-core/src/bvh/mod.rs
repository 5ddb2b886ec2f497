//! Closest points and first hits on triangles: exact in f64, over an f32 box hierarchy.

mod box32;
mod box_tree;
mod morton;
mod ray;
mod stack;
mod topology;
mod triangle;

pub(crate) use box_tree::BoxTree;
pub use ray::RayHit;
use triangle::squared_distance_to_triangle;
pub use triangle::{closest_point_on_triangle, TrianglePoint};

use rayon::prelude::*;

use crate::{Aabb, Location, Point3, SurfacePoint, Vector3};

/// A hierarchy of boxes around triangles that answers closest-point and ray queries, and follows them as they move.
///
/// Distances are computed in f64 from the corners as given; the f32 boxes are conservative and only prune. Among
/// triangles at the same distance the lowest row wins, so answers depend on neither the hierarchy nor the threads.
/// Degenerate triangles count as the segments or points they are. Corners are expected to be finite.
///
/// ```
/// use mesh_core::{Point3, TriangleBvh};
/// let bvh = TriangleBvh::new(vec![[[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]].map(Point3::from)]);
/// let closest = bvh.closest_point(&Point3::new(0.25, 0.25, 2.0)).expect("there is a triangle");
/// assert_eq!((closest.point, closest.distance_squared), (Point3::new(0.25, 0.25, 0.0), 4.0));
/// ```
#[derive(Clone, Debug)]
pub struct TriangleBvh {
    tree: BoxTree,
    /// In the order of the tree's slots.
    corners: Vec<[Point3; 3]>,
    bounds: Aabb,
}

/// So many queries are one piece of parallel work.
const CHUNK: usize = 256;

/// The best candidate so far.
#[derive(Clone, Copy)]
struct Best {
    row: u32,
    slot: u32,
}

impl TriangleBvh {
    /// The hierarchy of the triangles with these corners; there may be none.
    pub fn new(corners: Vec<[Point3; 3]>) -> Self {
        let bounds = corners.iter().map(triangle_box).fold(Aabb::EMPTY, union);
        let tree = BoxTree::new(bounds, corners.len(), |row| triangle_box(&corners[row]));
        let corners = tree
            .rows()
            .iter()
            .map(|&row| corners[row as usize])
            .collect();
        Self {
            tree,
            corners,
            bounds,
        }
    }

    /// How many triangles there are.
    pub fn len(&self) -> usize {
        self.corners.len()
    }

    /// Whether there is no triangle.
    pub fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }

    /// The smallest box around all triangles.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// The corners of the triangle in row `index`.
    pub fn triangle(&self, index: u32) -> [Point3; 3] {
        self.corners[self.tree.slot(index) as usize]
    }

    /// Moves the triangles, given in row order: boxes are recomputed, the hierarchy stays.
    ///
    /// Queries stay exact whatever the movement; they slow down where triangles that were neighbours part.
    ///
    /// # Panics
    /// If there are not as many triangles as before.
    pub fn refit(&mut self, corners: impl IntoIterator<Item = [Point3; 3]>) {
        let (mut n, mut bounds) = (0, Aabb::EMPTY);
        for (row, triangle) in corners.into_iter().enumerate() {
            assert!(
                row < self.len(),
                "refit with more than {} triangles",
                self.len()
            );
            self.corners[self.tree.slot(row as u32) as usize] = triangle;
            bounds = union(bounds, triangle_box(&triangle));
            n += 1;
        }
        assert_eq!(n, self.len(), "refit with fewer triangles than before");

        self.bounds = bounds;
        let corners = &self.corners;
        self.tree.refit(bounds, |slot| triangle_box(&corners[slot]));
    }

    /// The closest point over all triangles; none if there is no triangle.
    pub fn closest_point(&self, query: &Point3) -> Option<SurfacePoint> {
        self.search(query, None, |_| true)
    }

    /// The same answer as [`Self::closest_point`], found faster if the triangle in row `hint` is close to `query`.
    ///
    /// A row that does not exist is no hint.
    pub fn closest_point_from(&self, query: &Point3, hint: u32) -> Option<SurfacePoint> {
        self.search(query, Some(hint), |_| true)
    }

    /// The closest point over the triangles whose row `accept` takes; none if it takes none.
    pub fn closest_point_where(
        &self,
        query: &Point3,
        accept: impl Fn(u32) -> bool,
    ) -> Option<SurfacePoint> {
        self.search(query, None, accept)
    }

    /// The closest point to each query, in parallel and in order; empty if there is no triangle.
    ///
    /// Queries are answered along a curve that fills space, each from the hit of the one before: what it looks at is
    /// then at hand already. The answers are those of [`Self::closest_point`].
    pub fn closest_points(&self, queries: &[Point3]) -> Vec<SurfacePoint> {
        let order = morton::order(queries, &self.bounds);
        let of_chunk = |rows: &[u32]| -> Vec<SurfacePoint> {
            let mut hint = u32::MAX;
            let hits = rows.iter().filter_map(|&row| {
                let hit = self.closest_point_from(&queries[row as usize], hint)?;
                hint = hit.location.row();
                Some(hit)
            });
            hits.collect()
        };
        let hits: Vec<Vec<SurfacePoint>> = order.par_chunks(CHUNK).map(of_chunk).collect();
        let Some(&first) = hits.first().and_then(|chunk| chunk.first()) else {
            return Vec::new();
        };
        let mut closest = vec![first; queries.len()];
        for (&row, hit) in order.iter().zip(hits.iter().flatten()) {
            closest[row as usize] = *hit;
        }
        closest
    }

    fn search(
        &self,
        query: &Point3,
        hint: Option<u32>,
        accept: impl Fn(u32) -> bool,
    ) -> Option<SurfacePoint> {
        let mut best: Option<Best> = None;
        let mut nearest = f64::INFINITY;
        let mut visit = |slot: u32| {
            let d = squared_distance_to_triangle(query, &self.corners[slot as usize]);
            // From a point that is no number every distance is none either, and the first will do.
            if d <= nearest || d.is_nan() {
                let row = self.tree.rows()[slot as usize];
                let is_better = d < nearest || best.is_none_or(|b| row < b.row);
                if is_better && accept(row) {
                    best = Some(Best { row, slot });
                    nearest = d;
                }
            }
            nearest
        };

        let bound = match hint {
            Some(row) if (row as usize) < self.len() => visit(self.tree.slot(row)),
            _ => f64::INFINITY,
        };
        self.tree.nearest(query, bound, visit);
        best.map(|b| self.surface_point(query, b))
    }

    fn surface_point(&self, query: &Point3, best: Best) -> SurfacePoint {
        let corners = &self.corners[best.slot as usize];
        let at = closest_point_on_triangle(query, corners);
        SurfacePoint {
            point: at.point(corners),
            distance_squared: at.distance_squared,
            location: Location::Triangle {
                index: best.row,
                barycentric: at.barycentric,
            },
        }
    }

    /// Calls `visit` with the row of every triangle whose box meets `bounds`, in no particular order.
    ///
    /// Boxes are rounded outwards: none that meets `bounds` is left out, one a hair beside it may be visited.
    pub fn for_each_overlapping(&self, bounds: &Aabb, mut visit: impl FnMut(u32)) {
        self.tree
            .overlapping(bounds, |slot| visit(self.tree.rows()[slot as usize]));
    }

    /// The first triangle that the ray from `origin` along `direction` hits, from either side.
    ///
    /// Watertight: a ray does not slip through an edge or corner that triangles share. Of several triangles hit at
    /// the same distance the lowest row is reported. None for a zero direction. A triangle seen edge-on is not hit.
    pub fn first_hit(&self, origin: &Point3, direction: &Vector3) -> Option<RayHit> {
        let ray = ray::Ray::new(origin, direction)?;
        let mut first: Option<RayHit> = None;
        self.tree.along(origin, direction, |slot| {
            if let Some(hit) = ray.hit(
                &self.corners[slot as usize],
                self.tree.rows()[slot as usize],
            ) {
                if first.as_ref().is_none_or(|f| hit.is_before(f)) {
                    first = Some(hit);
                }
            }
            first.as_ref().map_or(f64::INFINITY, |f| f.distance)
        });
        first
    }
}

#[inline(always)]
fn triangle_box([a, b, c]: &[Point3; 3]) -> Aabb {
    let box_of = |p: &Point3| Aabb { min: *p, max: *p };
    union(union(box_of(a), box_of(b)), box_of(c))
}

#[inline(always)]
fn union(a: Aabb, b: Aabb) -> Aabb {
    let low = |axis: usize| {
        if b.min[axis] < a.min[axis] {
            b.min[axis]
        } else {
            a.min[axis]
        }
    };
    let high = |axis: usize| {
        if b.max[axis] > a.max[axis] {
            b.max[axis]
        } else {
            a.max[axis]
        }
    };
    Aabb {
        min: Point3::new(low(0), low(1), low(2)),
        max: Point3::new(high(0), high(1), high(2)),
    }
}
