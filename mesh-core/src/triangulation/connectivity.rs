//! Which vertices and triangles of a triangulation touch each other, all listed once.

use crate::side::{edges, sides_by_edge};
use crate::{Boundary, Rows, TriangleFans, UnionFind, VertexId};

/// Connected pieces of a mesh.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pieces {
    /// The piece of each vertex, numbered from 0 in the order of their first vertices.
    pub of_vertex: Vec<u32>,
    /// How many pieces there are.
    pub n: usize,
}

/// What touches what among triangles.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Connectivity {
    /// The triangles themselves, and those at each vertex.
    pub(super) fans: TriangleFans,
    /// Ends of each edge, the lower vertex first, in order.
    pub(super) edges: Vec<[VertexId; 2]>,
    /// The triangles with a side on each edge, ascending.
    pub(super) edge_triangles: Rows<u32>,
    /// The edge opposite to each corner of each triangle.
    pub(super) triangle_edges: Vec<[u32; 3]>,
    /// The other ends of the edges at each vertex, ascending.
    pub(super) vertex_neighbours: Rows<VertexId>,
    pub(super) boundary: Boundary,
    pub(super) pieces: Pieces,
}

impl Connectivity {
    pub(super) fn new(n_vertices: usize, triangles: Vec<[VertexId; 3]>) -> Self {
        let loops = triangles.iter().map(|t| &t[..]).enumerate();
        let sides = sides_by_edge(loops);
        let mut triangle_edges = vec![[0; 3]; triangles.len()];
        for (row, on_edge) in (0u32..).zip(edges(&sides)) {
            for side in on_edge {
                triangle_edges[side.face as usize][side.opposite()] = row;
            }
        }
        let single = edges(&sides).filter(|on_edge| on_edge.len() == 1);
        let single = single.map(|on_edge| (on_edge[0].face, on_edge[0].opposite()));
        let boundary = Boundary::new(n_vertices, &triangles, single);
        let edge_triangles = Rows::from_lists(edges(&sides).map(|e| e.iter().map(|s| s.face)));
        let edges: Vec<[VertexId; 2]> = edges(&sides).map(|on_edge| on_edge[0].edge).collect();
        let ends = edges
            .iter()
            .flat_map(|&[a, b]| [(a.index(), b), (b.index(), a)]);
        Self {
            vertex_neighbours: Rows::from_pairs(n_vertices, ends),
            pieces: pieces(n_vertices, &edges),
            fans: TriangleFans::new(n_vertices, triangles),
            edges,
            edge_triangles,
            triangle_edges,
            boundary,
        }
    }
}

fn pieces(n_vertices: usize, edges: &[[VertexId; 2]]) -> Pieces {
    let mut sets = UnionFind::new(n_vertices);
    edges
        .iter()
        .for_each(|&[a, b]| sets.union(a.index(), b.index()));
    let mut piece_of_root = vec![None; n_vertices];
    let mut n = 0;
    let of_vertex = (0..n_vertices)
        .map(|v| {
            *piece_of_root[sets.find(v)].get_or_insert_with(|| {
                n += 1;
                n as u32 - 1
            })
        })
        .collect();
    Pieces { of_vertex, n }
}
