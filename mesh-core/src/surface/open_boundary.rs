//! Where a triangle soup ends, cracks apart.

use rayon::prelude::*;

use super::welded::WeldedTriangles;
use crate::side::Side;
use crate::{Boundary, Point3, TriangleBvh, Vector3};

/// The surface ends at a side that no other triangle shares, unless it goes on this far beyond, ...
const CRACK: f64 = 1.0;
/// ... or no farther than this from there; in longest sides of the triangle. So a gap where a triangle or two are
/// missing, or whose edges do not quite meet, is a crack and no boundary.
const ACROSS: f64 = 0.5;

/// The edges that a single triangle uses and behind which the surface, the triangles of `bvh`, does not go on; doubles
/// of a triangle count as one.
pub(super) fn open_boundary(welded: &WeldedTriangles, bvh: &TriangleBvh) -> Boundary {
    let single = welded.edges().filter_map(|edge| match edge {
        [only] => Some(only),
        _ => None,
    });
    let single: Vec<&Side> = single.collect();
    let is_crack: Vec<bool> = single.par_iter().map(|side| is_crack(side, bvh)).collect();
    let open = single.iter().zip(is_crack).filter(|(_, crack)| !crack);
    let open = open.map(|(side, _)| (side.face, side.opposite()));
    let mut boundary = Boundary::new(welded.points.len(), &welded.triangles, open);
    for (row, &original) in (0u32..).zip(&welded.originals) {
        if original != row {
            boundary.copy_sides(&welded.triangles, original, row);
        }
    }
    boundary
}

/// Whether the surface goes on across a narrow gap behind the side of a triangle.
fn is_crack(side: &Side, bvh: &TriangleBvh) -> bool {
    let corners = bvh.triangle(side.face);
    let [a, b, c]: [Point3; 3] = [0, 1, 2].map(|k| corners[(side.corner as usize + k) % 3]);
    let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
    let along = (b - a).try_normalize(0.0).unwrap_or_default();
    let inwards: Vector3 = (c - a) - along * along.dot(&(c - a));
    let Some(inwards) = inwards.try_normalize(0.0) else {
        return false;
    };
    let beyond = nalgebra::center(&a, &b) - inwards * (CRACK * longest);
    let limit = (ACROSS * longest).powi(2);
    bvh.closest_point(&beyond)
        .is_some_and(|hit| hit.distance_squared < limit)
}
