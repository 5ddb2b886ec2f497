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
    /// The largest distance of a vertex from the target.
    pub(super) fn worst(&self, x: &Positions) -> f64 {
        let distances = self.target.closest_points(x.as_slice());
        let distances = distances.iter().map(|hit| hit.distance_squared.sqrt());
        distances.fold(0.0, f64::max)
    }

    /// How far from the target the triangles `rows` are at `y`, at most, where they were nearer at `x`: corners and middles
    /// from the target, and what of the target was near from them. Zero where nothing is farther than it was.
    pub(super) fn excess(&self, ground: Ground<'_>, rows: &[u32], [x, y]: [&Positions; 2]) -> f64 {
        let places = |x: &Positions| places(ground, rows, x);
        let (before, after) = (places(x), places(y));
        let mut excess = 0.0f64;
        let mut marks = Vec::new();
        for (old, new) in before.iter().zip(&after) {
            if old == new {
                continue;
            }
            let [was, is] = [old, new].map(|p| self.target.closest_point(p));
            let far = was.distance_squared.sqrt();
            let is = is.distance_squared.sqrt();
            if is > far {
                excess = excess.max(is);
            }
            marks.push((was.point, far));
        }
        let surface = TriangleBvh::new(corners(ground, rows, y));
        for (mark, far) in marks {
            let hit = surface.closest_point(&mark);
            let is = hit.map_or(0.0, |hit| hit.distance_squared.sqrt());
            if is > far {
                excess = excess.max(is);
            }
        }
        excess
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
