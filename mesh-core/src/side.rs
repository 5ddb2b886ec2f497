//! Sides of faces, sorted by the edges they lie on.

use rayon::prelude::*;

use crate::VertexId;

/// A side of a face: it runs from corner `corner` to the next one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Side {
    /// Its ends, the lower vertex first.
    pub(crate) edge: [VertexId; 2],
    /// Row of the face.
    pub(crate) face: u32,
    /// The corner it leaves, counted along the face.
    pub(crate) corner: u32,
    /// Whether it runs from the lower vertex to the higher.
    pub(crate) is_forward: bool,
}

impl Side {
    /// The corner of a triangle opposite to the side.
    pub(crate) fn opposite(&self) -> usize {
        (self.corner as usize + 2) % 3
    }

    /// The vertices it leaves and arrives at.
    pub(crate) fn ends(&self) -> [VertexId; 2] {
        let [low, high] = self.edge;
        if self.is_forward {
            [low, high]
        } else {
            [high, low]
        }
    }
}

/// The sides of faces (row and loop of vertices), those on one edge together and in order of their faces, edges in order
/// of their vertices.
pub(crate) fn sides_by_edge<'a>(faces: impl Iterator<Item = (usize, &'a [VertexId])>) -> Vec<Side> {
    let mut sides = Vec::with_capacity(3 * faces.size_hint().0);
    for (face, corners) in faces {
        for (corner, &tail) in corners.iter().enumerate() {
            let head = corners[(corner + 1) % corners.len()];
            sides.push(Side {
                edge: [tail.min(head), tail.max(head)],
                face: face as u32,
                corner: corner as u32,
                is_forward: tail < head,
            });
        }
    }
    sides.par_sort_unstable();
    sides
}

/// The sides on each edge.
pub(crate) fn edges(sides: &[Side]) -> impl Iterator<Item = &[Side]> + Clone {
    sides.chunk_by(|a, b| a.edge == b.edge)
}
