//! The open boundary of a triangle soup.

use std::collections::HashSet;

use super::weld::Weld;
use crate::ON_SIDE;

/// Which sides and corners of each triangle lie on a boundary: bit `k` is the side opposite corner `k`, bit `3 + k`
/// the corner itself.
pub(super) struct Boundary {
    marks: Vec<u8>,
}

impl Boundary {
    /// Edges that a single triangle uses; doubles of a triangle count as one.
    pub(super) fn new(weld: &Weld) -> Self {
        let mut marks = vec![0u8; weld.triangles.len()];
        let mut vertices = HashSet::new();
        for edge in weld.edges() {
            if let [only] = edge {
                marks[only.triangle as usize] |= 1 << ((only.corner + 2) % 3);
                vertices.extend(only.edge);
            }
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

/// The side marks of `original`, for a double with the same vertices in another order.
fn same_sides(mark: u8, original: &[u32; 3], double: &[u32; 3]) -> u8 {
    (0..3)
        .filter(|&k| (0..3).any(|j| original[j] == double[k] && mark & (1 << j) != 0))
        .map(|k| 1 << k)
        .sum()
}
