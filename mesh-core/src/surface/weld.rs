//! Which corners of triangles are the same point, and which sides the same edge.

use rayon::prelude::*;

use crate::Point3;

/// Triangles over welded vertices, and their sides in order of the edges they lie on.
pub(super) struct Weld {
    /// The welded vertices of each triangle.
    pub(super) triangles: Vec<[u32; 3]>,
    /// For each triangle the first with the same three vertices: itself unless it is a double.
    pub(super) originals: Vec<u32>,
    /// The sides of all triangles that are neither doubles nor degenerate, sorted by edge.
    sides: Vec<Side>,
}

/// A side of a triangle: from corner `side` to the next.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Side {
    /// Its ends, the lower vertex first.
    pub(super) edge: [u32; 2],
    /// Row of the triangle.
    pub(super) triangle: u32,
    /// The corner it leaves.
    pub(super) corner: u8,
    /// Whether it runs from the lower vertex to the higher.
    pub(super) is_forward: bool,
}

impl Weld {
    /// Welds corners with exactly equal positions.
    pub(super) fn new(positions: &[Point3], triangles: &[[u32; 3]]) -> Self {
        let vertices = welded(positions);
        let triangles: Vec<[u32; 3]> = triangles
            .iter()
            .map(|t| t.map(|v| vertices[v as usize]))
            .collect();
        let originals = originals(&triangles);
        let mut sides: Vec<Side> = (0u32..)
            .zip(&triangles)
            .filter(|&(row, t)| originals[row as usize] == row && !is_degenerate(t))
            .flat_map(|(row, t)| sides(row, t))
            .collect();
        sides.par_sort_unstable();
        Self {
            triangles,
            originals,
            sides,
        }
    }

    /// The welded vertices that triangles use, in order.
    pub(super) fn used_vertices(&self) -> impl Iterator<Item = u32> {
        let mut used: Vec<u32> = self.triangles.iter().flatten().copied().collect();
        used.par_sort_unstable();
        used.dedup();
        used.into_iter()
    }

    /// The sides that share an edge, edge by edge.
    pub(super) fn edges(&self) -> impl Iterator<Item = &[Side]> {
        self.sides.chunk_by(|a, b| a.edge == b.edge)
    }
}

/// Whether two corners are the same vertex.
fn is_degenerate([a, b, c]: &[u32; 3]) -> bool {
    a == b || b == c || c == a
}

fn sides(triangle: u32, t: &[u32; 3]) -> [Side; 3] {
    [0u8, 1, 2].map(|corner| {
        let (tail, head) = (t[corner as usize], t[(corner as usize + 1) % 3]);
        Side {
            edge: [tail.min(head), tail.max(head)],
            triangle,
            corner,
            is_forward: tail < head,
        }
    })
}

/// For each position the lowest row with an equal one.
fn welded(positions: &[Point3]) -> Vec<u32> {
    // Adding zero turns −0 into +0.
    let key = |row: u32| positions[row as usize].coords.map(|c| c + 0.0);
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    order.par_sort_unstable_by(|&a, &b| {
        let (p, q) = (key(a), key(b));
        let by_axis = |axis: usize| p[axis].total_cmp(&q[axis]);
        by_axis(0).then(by_axis(1)).then(by_axis(2)).then(a.cmp(&b))
    });
    let mut vertices = vec![0; positions.len()];
    for group in order.chunk_by(|&a, &b| key(a) == key(b)) {
        for &row in group {
            vertices[row as usize] = group[0];
        }
    }
    vertices
}

fn originals(triangles: &[[u32; 3]]) -> Vec<u32> {
    let sorted = |row: u32| {
        let mut t = triangles[row as usize];
        t.sort_unstable();
        t
    };
    let mut order: Vec<u32> = (0..triangles.len() as u32).collect();
    order.par_sort_unstable_by_key(|&row| (sorted(row), row));
    let mut originals = vec![0; triangles.len()];
    for group in order.chunk_by(|&a, &b| sorted(a) == sorted(b)) {
        for &row in group {
            originals[row as usize] = group[0];
        }
    }
    originals
}
