//! The open boundary of a triangle soup.

use std::collections::HashSet;

use rayon::prelude::*;

use super::weld::{Side, Weld};
use crate::{Point3, TriangleBvh, Vector3, ON_SIDE};

/// The surface ends at a side that no other triangle shares, unless it goes on this far beyond, ...
const CRACK: f64 = 1.0;
/// ... or no farther than this from there; in longest sides of the triangle. So a gap where a triangle or two are
/// missing, or whose edges do not quite meet, is a crack and no boundary.
const ACROSS: f64 = 0.5;

/// Which sides and corners of each triangle lie on a boundary: bit `k` is the side opposite corner `k`, bit `3 + k`
/// the corner itself.
pub(super) struct Boundary {
    marks: Vec<u8>,
}

impl Boundary {
    /// Edges that a single triangle uses and behind which the surface, the triangles of `bvh`, does not go on; doubles
    /// of a triangle count as one.
    pub(super) fn new(weld: &Weld, bvh: &TriangleBvh) -> Self {
        let mut marks = vec![0u8; weld.triangles.len()];
        let mut vertices = HashSet::new();
        let single = weld.edges().filter_map(|edge| match edge {
            [only] => Some(only),
            _ => None,
        });
        let single: Vec<&Side> = single.collect();
        let is_crack: Vec<bool> = single.par_iter().map(|side| is_crack(side, bvh)).collect();
        for (only, _) in single.iter().zip(is_crack).filter(|(_, crack)| !crack) {
            marks[only.triangle as usize] |= 1 << ((only.corner + 2) % 3);
            vertices.extend(only.edge);
        }
        for (mark, t) in marks.iter_mut().zip(&weld.triangles) {
            for (k, v) in t.iter().enumerate() {
                *mark |= u8::from(vertices.contains(v)) << (3 + k);
            }
        }
        for (row, &original) in weld.originals.iter().enumerate() {
            if original as usize != row {
                marks[row] |= same_sides(
                    marks[original as usize],
                    &weld.triangles[original as usize],
                    &weld.triangles[row],
                );
            }
        }
        Self { marks }
    }

    /// Whether there is none: the surface is closed.
    pub(super) fn is_empty(&self) -> bool {
        self.marks.iter().all(|&mark| mark == 0)
    }

    /// Whether a place lies on a boundary side or corner of triangle `index`.
    pub(super) fn contains(&self, index: u32, barycentric: &[f64; 3]) -> bool {
        let mark = self.marks[index as usize];
        (0..3).any(|k| {
            let on_side = mark & (1 << k) != 0 && barycentric[k] <= ON_SIDE;
            let on_corner = mark & (8 << k) != 0 && barycentric[k] >= 1.0 - ON_SIDE;
            on_side || on_corner
        })
    }
}

/// Whether the surface goes on across a narrow gap behind the side of a triangle.
fn is_crack(side: &Side, bvh: &TriangleBvh) -> bool {
    let corners = bvh.triangle(side.triangle);
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

/// The side marks of `original`, for a double with the same vertices in another order.
fn same_sides(mark: u8, original: &[u32; 3], double: &[u32; 3]) -> u8 {
    (0..3)
        .filter(|&k| (0..3).any(|j| original[j] == double[k] && mark & (1 << j) != 0))
        .map(|k| 1 << k)
        .sum()
}
