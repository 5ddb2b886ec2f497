//! The open boundary of the moving mesh.

use mesh_core::{Triangulation, VertexData, VertexId, ON_SIDE};

/// The open boundary of the mesh.
pub(crate) struct Boundary {
    triangles: Vec<[VertexId; 3]>,
    is_vertex: VertexData<bool>,
    /// Whether the side opposite to each corner belongs to no other triangle.
    is_side: Vec<[bool; 3]>,
}

impl Boundary {
    pub(crate) fn new(triangulation: &Triangulation, n_vertices: usize) -> Self {
        let triangles = triangulation.triangles().to_vec();
        let side = |t: &[VertexId; 3], k: usize| {
            let (a, b) = (t[(k + 1) % 3], t[(k + 2) % 3]);
            (a.min(b), a.max(b))
        };
        let mut sides: Vec<_> = triangles
            .iter()
            .flat_map(|t| [0, 1, 2].map(|k| side(t, k)))
            .collect();
        sides.sort_unstable();
        let is_single = |s: &(VertexId, VertexId)| {
            let first = sides.partition_point(|other| other < s);
            sides.get(first + 1) != Some(s)
        };
        let is_side: Vec<[bool; 3]> = triangles
            .iter()
            .map(|t| [0, 1, 2].map(|k| is_single(&side(t, k))))
            .collect();
        let mut is_vertex = VertexData::new(n_vertices, false);
        for (t, open) in triangles.iter().zip(&is_side) {
            for k in (0..3).filter(|&k| open[k]) {
                is_vertex[t[(k + 1) % 3]] = true;
                is_vertex[t[(k + 2) % 3]] = true;
            }
        }
        Self {
            triangles,
            is_vertex,
            is_side,
        }
    }

    /// Whether the mesh is closed.
    pub(crate) fn is_empty(&self) -> bool {
        !self.is_vertex.iter().any(|&is| is)
    }

    /// Whether the place in triangle `t` lies on the boundary.
    pub(crate) fn holds(&self, t: usize, barycentric: [f64; 3]) -> bool {
        (0..3).any(|k| {
            let is_on_side = self.is_side[t][k] && barycentric[k] <= ON_SIDE;
            let is_on_corner =
                self.is_vertex[self.triangles[t][k]] && barycentric[k] >= 1.0 - ON_SIDE;
            is_on_side || is_on_corner
        })
    }
}
