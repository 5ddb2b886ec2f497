//! Triangles over the different places among the corners of a soup.

use rayon::prelude::*;

use crate::side::{edges, sides_by_edge, Side};
use crate::weld::weld_points;
use crate::{Point3, VertexId};

/// The triangles of a soup whose corners at equal positions are one vertex, and their sides in order of the edges they
/// lie on.
pub(super) struct WeldedTriangles {
    /// The positions of the vertices.
    pub(super) points: Vec<Point3>,
    /// The vertices of each triangle.
    pub(super) triangles: Vec<[VertexId; 3]>,
    /// For each triangle the first with the same three vertices: itself unless it is a double.
    pub(super) originals: Vec<u32>,
    /// The sides of all triangles that are neither doubles nor degenerate, sorted by edge.
    sides: Vec<Side>,
}

impl WeldedTriangles {
    /// Welds corners with exactly equal positions.
    pub(super) fn new(positions: &[Point3], triangles: &[[u32; 3]]) -> Self {
        let (points, vertices) = weld_points(positions, 0.0);
        let welded = |&v: &u32| VertexId::new(vertices[v as usize] as usize);
        let triangles: Vec<[VertexId; 3]> =
            triangles.iter().map(|t| t.each_ref().map(welded)).collect();
        let originals = originals(&triangles);
        let proper = triangles.iter().map(|t| &t[..]).enumerate();
        let proper = proper.filter(|&(row, t)| originals[row] as usize == row && !is_degenerate(t));
        Self {
            sides: sides_by_edge(proper),
            points,
            originals,
            triangles,
        }
    }

    /// The positions of the vertices that triangles use, in order.
    pub(super) fn used_points(&self) -> Vec<Point3> {
        let mut is_used = vec![false; self.points.len()];
        for v in self.triangles.iter().flatten() {
            is_used[v.index()] = true;
        }
        let used = self.points.iter().zip(is_used);
        used.filter_map(|(&p, is_used)| is_used.then_some(p))
            .collect()
    }

    /// `rows` without those that follow two with the same three vertices; none where there are no such.
    pub(super) fn at_most_two_of_each(&self, rows: &[[u32; 3]]) -> Option<Vec<[u32; 3]>> {
        let mut n_seen = vec![0u8; rows.len()];
        let mut is_new = |original: &u32| {
            let seen = &mut n_seen[*original as usize];
            *seen = seen.saturating_add(1);
            *seen <= 2
        };
        let is_kept: Vec<bool> = self.originals.iter().map(&mut is_new).collect();
        let kept = || rows.iter().zip(&is_kept).filter(|(_, kept)| **kept);
        (kept().count() < rows.len()).then(|| kept().map(|(row, _)| *row).collect())
    }

    /// The sides that share an edge, edge by edge.
    pub(super) fn edges(&self) -> impl Iterator<Item = &[Side]> {
        edges(&self.sides)
    }
}

/// Whether two corners of a triangle are the same vertex.
pub(super) fn is_degenerate(t: &[VertexId]) -> bool {
    t[0] == t[1] || t[1] == t[2] || t[2] == t[0]
}

fn originals(triangles: &[[VertexId; 3]]) -> Vec<u32> {
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
