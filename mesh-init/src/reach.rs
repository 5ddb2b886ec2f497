//! Which vertices are joined to which by triangles.

use mesh_core::{Triangulation, VertexData, VertexId};

/// Whether a path of triangles leads from a vertex of `from` to each vertex.
pub(crate) fn is_reached(
    triangulation: &Triangulation,
    n_vertices: usize,
    from: &[VertexId],
) -> VertexData<bool> {
    let mut parent: VertexData<VertexId> = (0..n_vertices).map(VertexId::new).collect();
    for &[a, b, c] in triangulation.triangles() {
        let root = find(&mut parent, a);
        for v in [b, c] {
            let other = find(&mut parent, v);
            parent[other] = root;
        }
    }
    let mut is_root_reached = VertexData::new(n_vertices, false);
    for &v in from {
        is_root_reached[find(&mut parent, v)] = true;
    }
    (0..n_vertices)
        .map(|v| is_root_reached[find(&mut parent, VertexId::new(v))])
        .collect()
}

/// `held` and every vertex that no path of triangles joins to it: what a solve must keep in place.
pub(crate) fn held_and_unreached(
    triangulation: &Triangulation,
    n_vertices: usize,
    held: &[VertexId],
) -> Vec<VertexId> {
    let is_reached = is_reached(triangulation, n_vertices, held);
    let unreached = is_reached.ids().filter(|&v| !is_reached[v]);
    held.iter().copied().chain(unreached).collect()
}

fn find(parent: &mut VertexData<VertexId>, mut v: VertexId) -> VertexId {
    while parent[v] != v {
        let up = parent[parent[v]];
        parent[v] = up;
        v = up;
    }
    v
}
