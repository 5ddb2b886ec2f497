//! Open boundaries: where a surface of triangles ends.

use crate::{VertexData, VertexId, ON_SIDE};

/// Which sides, corners and vertices of triangles lie on an open boundary.
///
/// Side `k` of a triangle is the one opposite to its corner `k`: the places whose barycentric weight `k` is 0. A corner
/// lies on the boundary where its vertex is an end of a boundary side of any triangle.
#[derive(Clone, Debug, PartialEq)]
pub struct Boundary {
    /// Bit `k` for the side opposite to corner `k` of a triangle, bit `3 + k` for the corner itself.
    marks: Vec<u8>,
    is_vertex: VertexData<bool>,
}

impl Boundary {
    /// The boundary whose sides are these: rows of triangles with the corner opposite to the side.
    pub(crate) fn new(
        n_vertices: usize,
        triangles: &[[VertexId; 3]],
        sides: impl IntoIterator<Item = (u32, usize)>,
    ) -> Self {
        let mut marks = vec![0u8; triangles.len()];
        let mut is_vertex = VertexData::new(n_vertices, false);
        for (t, k) in sides {
            let triangle = triangles[t as usize];
            marks[t as usize] |= 1 << k;
            for end in [triangle[(k + 1) % 3], triangle[(k + 2) % 3]] {
                is_vertex[end] = true;
            }
        }
        for (mark, triangle) in marks.iter_mut().zip(triangles) {
            for (k, &v) in triangle.iter().enumerate() {
                *mark |= u8::from(is_vertex[v]) << (3 + k);
            }
        }
        Self { marks, is_vertex }
    }

    /// Marks the sides of triangle `row`, which has the vertices of `original` in some order, as those of that one are.
    pub(crate) fn copy_sides(&mut self, triangles: &[[VertexId; 3]], original: u32, row: u32) {
        let [first, double] = [original, row].map(|t| triangles[t as usize]);
        let is_open =
            |k: &usize| (0..3).any(|j| first[j] == double[*k] && self.is_side(original, j));
        let marks: u8 = (0..3).filter(is_open).map(|k| 1 << k).sum();
        self.marks[row as usize] |= marks;
    }

    /// Whether there is none: the surface is closed.
    pub fn is_empty(&self) -> bool {
        self.marks.iter().all(|&mark| mark == 0)
    }

    /// Whether the side of triangle `t` that is opposite to its corner `k` lies on the boundary.
    ///
    /// # Panics
    /// If there is no such triangle.
    pub fn is_side(&self, t: u32, k: usize) -> bool {
        self.marks[t as usize] & (1 << k) != 0
    }

    /// Whether a boundary side ends at the vertex.
    ///
    /// # Panics
    /// If there is no such vertex.
    pub fn is_vertex(&self, v: VertexId) -> bool {
        self.is_vertex[v]
    }

    /// Whether the place with these weights of the corners of triangle `t` lies on a boundary side or corner.
    ///
    /// # Panics
    /// If there is no such triangle.
    pub fn contains(&self, t: u32, barycentric: &[f64; 3]) -> bool {
        let mark = self.marks[t as usize];
        (0..3).any(|k| {
            let on_side = mark & (1 << k) != 0 && barycentric[k] <= ON_SIDE;
            let on_corner = mark & (8 << k) != 0 && barycentric[k] >= 1.0 - ON_SIDE;
            on_side || on_corner
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two triangles over a square whose diagonal is shared.
    fn square() -> (Vec<[VertexId; 3]>, Boundary) {
        let triangles = [[0, 1, 2], [0, 2, 3]]
            .map(|t| t.map(VertexId::new))
            .to_vec();
        let boundary = Boundary::new(5, &triangles, [(0, 0), (0, 2), (1, 0), (1, 1)]);
        (triangles, boundary)
    }

    #[test]
    fn sides_corners_and_vertices_are_on_it_and_the_diagonal_is_not() {
        let (_, boundary) = square();
        assert!(!boundary.is_empty());
        assert_eq!(
            [0, 1, 2].map(|k| boundary.is_side(0, k)),
            [true, false, true]
        );
        assert!((0..4).all(|v| boundary.is_vertex(VertexId::new(v))));
        assert!(!boundary.is_vertex(VertexId::new(4)));
        assert!(boundary.contains(0, &[0.0, 0.5, 0.5]));
        assert!(!boundary.contains(0, &[0.5, 0.0, 0.5]));
        assert!(boundary.contains(1, &[1.0, 0.0, 0.0]));
        assert!(!boundary.contains(1, &[0.4, 0.3, 0.3]));
    }

    #[test]
    fn a_double_has_the_sides_of_its_original() {
        let (mut triangles, _) = square();
        triangles.push([2, 1, 0].map(VertexId::new));
        let mut boundary = Boundary::new(4, &triangles, [(0, 0), (1, 0)]);
        boundary.copy_sides(&triangles, 0, 2);
        assert_eq!(
            [0, 1, 2].map(|k| boundary.is_side(2, k)),
            [false, false, true]
        );
    }
}
