//! Vertices as they are drawn with a picture: once for each place that they have on it.

use std::collections::HashMap;

/// A place on a picture.
pub(crate) type Uv = [f32; 2];

/// The vertices of a shape, and copies of those that lie on a seam of its picture.
#[derive(Clone, Debug, Default)]
pub(crate) struct Seams {
    /// The place of every vertex on the picture, then that of every copy; none where no triangle has the vertex.
    pub(crate) uvs: Vec<Option<Uv>>,
    /// The vertex that each copy is one of.
    pub(crate) copies: Vec<u32>,
    /// The corners of the triangles: vertices, or copies, which are counted on from the vertices.
    pub(crate) corners: Vec<[u32; 3]>,
}

impl Seams {
    /// Of triangles with the places of their corners on the picture. A vertex itself has the first place that it is
    /// given; each further one is a copy.
    pub(crate) fn new(
        n_vertices: usize,
        triangles: impl Iterator<Item = ([u32; 3], [Uv; 3])>,
    ) -> Self {
        let mut seams = Self {
            uvs: vec![None; n_vertices],
            ..Self::default()
        };
        let mut known = HashMap::new();
        for (vertices, uvs) in triangles {
            let corners = [0, 1, 2].map(|k| seams.drawn(vertices[k], uvs[k], &mut known));
            seams.corners.push(corners);
        }
        seams
    }

    /// The vertex, or the copy of it, that has this place. Copies are known by vertex and bits of their place.
    fn drawn(&mut self, vertex: u32, uv: Uv, known: &mut HashMap<(u32, [u32; 2]), u32>) -> u32 {
        let own = self.uvs[vertex as usize].get_or_insert(uv);
        let bits = uv.map(f32::to_bits);
        if own.map(f32::to_bits) == bits {
            return vertex;
        }
        *known.entry((vertex, bits)).or_insert_with(|| {
            self.uvs.push(Some(uv));
            self.copies.push(vertex);
            (self.uvs.len() - 1) as u32
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two triangles with a common side.
    fn seams(second: [Uv; 3]) -> Seams {
        let first = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]];
        let triangles = [([0, 1, 2], first), ([0, 2, 3], second)];
        Seams::new(5, triangles.into_iter())
    }

    #[test]
    fn what_has_no_seam_has_no_copies() {
        let seams = seams([[0.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        assert_eq!(seams.corners, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!((seams.copies.len(), seams.uvs[4]), (0, None));
    }

    #[test]
    fn a_vertex_on_a_seam_is_drawn_once_for_each_place() {
        let seams = seams([[0.5, 0.0], [1.0, 1.0], [f32::NAN, 1.0]]);
        assert_eq!(seams.corners, [[0, 1, 2], [5, 2, 3]]);
        assert_eq!(seams.copies, [0]);
        assert_eq!((seams.uvs.len(), seams.uvs[5]), (6, Some([0.5, 0.0])));
    }
}
