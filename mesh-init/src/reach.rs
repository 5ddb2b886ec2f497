//! Which vertices are joined to which by triangles.

use mesh_core::{Triangulation, VertexData, VertexId};

/// Whether a path of triangles leads from a vertex of `from` to each vertex.
pub(crate) fn is_reached(triangulation: &Triangulation, from: &[VertexId]) -> VertexData<bool> {
    let pieces = triangulation.pieces();
    let mut is_piece_reached = vec![false; pieces.n];
    for v in from {
        is_piece_reached[pieces.of_vertex[v.index()] as usize] = true;
    }
    let of_vertex = pieces.of_vertex.iter();
    of_vertex.map(|&p| is_piece_reached[p as usize]).collect()
}

/// `held` and every vertex that no path of triangles joins to it: what a solve must keep in place.
pub(crate) fn held_and_unreached(
    triangulation: &Triangulation,
    held: &[VertexId],
) -> Vec<VertexId> {
    let is_reached = is_reached(triangulation, held);
    let unreached = is_reached.ids().filter(|&v| !is_reached[v]);
    held.iter().copied().chain(unreached).collect()
}
