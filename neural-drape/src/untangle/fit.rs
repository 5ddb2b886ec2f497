//! How far from the target a patch may be moved.

use mesh_core::{Point3, Positions, TargetSurface, TriangleBvh, VertexId};

use super::crossing::Ground;

/// A place this near the target fits, in longest sides of the surface: less than the worst distances of a run tolerate, as
/// places between those that are looked at are a little farther.
const NEAR: f64 = 0.005;

/// A target that must be fitted no worse than it was.
#[derive(Clone, Copy)]
pub(crate) struct Fit<'a> {
    /// The target, in the coordinates of the surface.
    pub(crate) target: &'a dyn TargetSurface,
    /// The longest side of the surface.
    pub(crate) size: f64,
}

impl Fit<'_> {
    /// Whether the triangles `rows` fit the target at `y` where they fitted it at `x`: of their corners and middles, no place
    /// is farther from the target than it was, unless it is near; and what of the target was near is near still.
    pub(super) fn holds(&self, ground: Ground<'_>, rows: &[u32], [x, y]: [&Positions; 2]) -> bool {
        let places = |x: &Positions| places(ground, rows, x);
        let (before, after) = (places(x), places(y));
        let near = NEAR * self.size;
        let mut marks = Vec::new();
        for (old, new) in before.iter().zip(&after) {
            if old == new {
                continue;
            }
            let [was, is] = [old, new].map(|p| self.target.closest_point(p));
            let far = (was.point - old).norm();
            if (is.point - new).norm() > far.max(near) {
                return false;
            }
            marks.push((was.point, far));
        }
        let surface = TriangleBvh::new(corners(ground, rows, y));
        marks.iter().all(|(mark, far)| {
            let hit = surface.closest_point(mark);
            hit.is_none_or(|hit| hit.distance_squared.sqrt() <= far.max(near))
        })
    }
}

fn corners(ground: Ground<'_>, rows: &[u32], x: &Positions) -> Vec<[Point3; 3]> {
    let triangles = ground.triangulation.triangles();
    let rows = rows.iter();
    rows.map(|&row| triangles[row as usize].map(|v: VertexId| x[v]))
        .collect()
}

/// Corners and middles of triangles.
fn places(ground: Ground<'_>, rows: &[u32], x: &Positions) -> Vec<Point3> {
    let of = |[a, b, c]: [Point3; 3]| {
        let middle = (a.coords + b.coords + c.coords) / 3.0;
        [a, b, c, middle.into()]
    };
    corners(ground, rows, x).into_iter().flat_map(of).collect()
}
