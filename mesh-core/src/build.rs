//! Soup → halfedges: the one validation gate. Past it, code assumes every edge has at most two faces.

use std::collections::HashMap;

use crate::{FaceId, HalfedgeId, HalfedgeMesh, TopologyError, VertexId};

/// Builds the connectivity of `faces`; see [`HalfedgeMesh::from_faces`].
pub(crate) fn halfedge_mesh(
    n_vertices: usize,
    faces: &[Vec<u32>],
) -> Result<HalfedgeMesh, TopologyError> {
    let n_corners: usize = faces.iter().map(Vec::len).sum();
    check_size("vertices", n_vertices)?;
    check_size("faces", faces.len())?;
    check_size("halfedges", 2 * n_corners)?;

    let (corner_starts, corner_vertices) = corners(n_vertices, faces)?;
    let sides = sides_by_edge(&corner_starts, &corner_vertices);
    let mut mesh = HalfedgeMesh {
        tails: Vec::with_capacity(2 * n_corners),
        nexts: Vec::new(),
        faces: Vec::with_capacity(2 * n_corners),
        corner_halfedges: vec![HalfedgeId::new(0); corner_vertices.len()],
        corner_starts,
        corner_vertices,
        outgoing_starts: Vec::new(),
        outgoing: Vec::new(),
        n_cut_edges: 0,
    };
    for group in &sides {
        add_edges(&mut mesh, group);
    }
    mesh.nexts = vec![HalfedgeId::new(0); mesh.tails.len()];
    link_faces(&mut mesh);
    link_boundaries(&mut mesh);
    list_outgoing(&mut mesh, n_vertices);
    Ok(mesh)
}

/// One side of an edge: a corner of a face and the two ends of the side that leaves it.
#[derive(Clone, Copy)]
struct Side {
    face: FaceId,
    corner: usize,
    tail: VertexId,
    head: VertexId,
}

fn check_size(element: &'static str, count: usize) -> Result<(), TopologyError> {
    let max = u32::MAX as usize;
    if count < max {
        Ok(())
    } else {
        Err(TopologyError::TooMany {
            element,
            count,
            max,
        })
    }
}

/// The vertex loops of all faces in one list, repeated neighbours removed, degenerate faces emptied.
fn corners(
    n_vertices: usize,
    faces: &[Vec<u32>],
) -> Result<(Vec<u32>, Vec<VertexId>), TopologyError> {
    let mut starts = vec![0];
    let mut vertices: Vec<VertexId> = Vec::new();
    for (face, corners) in faces.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= n_vertices) {
            return Err(TopologyError::VertexOutOfRange {
                face,
                vertex,
                n_vertices,
            });
        }
        let start = vertices.len();
        for (k, &v) in corners.iter().enumerate() {
            if v != corners[(k + 1) % corners.len()] {
                vertices.push(VertexId::new(v as usize));
            }
        }
        let mut distinct = vertices[start..].to_vec();
        distinct.sort_unstable();
        distinct.dedup();
        if distinct.len() < 3 {
            vertices.truncate(start);
        }
        starts.push(vertices.len() as u32);
    }
    Ok((starts, vertices))
}

/// The sides of all faces, grouped by the pair of vertices they join, groups in order of first appearance.
fn sides_by_edge(starts: &[u32], vertices: &[VertexId]) -> Vec<Vec<Side>> {
    let mut group_of: HashMap<(VertexId, VertexId), usize> = HashMap::with_capacity(vertices.len());
    let mut groups: Vec<Vec<Side>> = Vec::new();
    for (face, range) in starts.windows(2).enumerate() {
        let (from, to) = (range[0] as usize, range[1] as usize);
        for corner in from..to {
            let tail = vertices[corner];
            let head = vertices[if corner + 1 == to { from } else { corner + 1 }];
            let key = (tail.min(head), tail.max(head));
            let group = *group_of.entry(key).or_insert_with(|| {
                groups.push(Vec::with_capacity(2));
                groups.len() - 1
            });
            groups[group].push(Side {
                face: FaceId::new(face),
                corner,
                tail,
                head,
            });
        }
    }
    groups
}

/// One edge for two sides that run against each other; otherwise one boundary edge for each side.
fn add_edges(mesh: &mut HalfedgeMesh, sides: &[Side]) {
    if let [a, b] = sides {
        if a.tail == b.head {
            add_edge(mesh, *a, Some(*b));
            return;
        }
    }
    if sides.len() > 1 {
        mesh.n_cut_edges += 1;
    }
    for &side in sides {
        add_edge(mesh, side, None);
    }
}

fn add_edge(mesh: &mut HalfedgeMesh, side: Side, other: Option<Side>) {
    let h = mesh.tails.len();
    mesh.tails.extend([side.tail, side.head]);
    mesh.faces.extend([Some(side.face), other.map(|o| o.face)]);
    mesh.corner_halfedges[side.corner] = HalfedgeId::new(h);
    if let Some(other) = other {
        mesh.corner_halfedges[other.corner] = HalfedgeId::new(h + 1);
    }
}

fn link_faces(mesh: &mut HalfedgeMesh) {
    for range in mesh.corner_starts.windows(2) {
        let cycle = &mesh.corner_halfedges[range[0] as usize..range[1] as usize];
        for (k, h) in cycle.iter().enumerate() {
            mesh.nexts[h.index()] = cycle[(k + 1) % cycle.len()];
        }
    }
}

/// Links each boundary halfedge to the one that leaves its head in the same fan of faces.
fn link_boundaries(mesh: &mut HalfedgeMesh) {
    let mut previous = vec![HalfedgeId::new(0); mesh.tails.len()];
    for h in mesh.halfedges().filter(|&h| mesh.face(h).is_some()) {
        previous[mesh.next(h).index()] = h;
    }
    for h in mesh.halfedges() {
        if mesh.face(h).is_some() {
            continue;
        }
        let mut out = mesh.twin(h);
        while mesh.face(out).is_some() {
            out = mesh.twin(previous[out.index()]);
        }
        mesh.nexts[h.index()] = out;
    }
}

/// Lists the halfedges that leave each vertex, in halfedge order.
fn list_outgoing(mesh: &mut HalfedgeMesh, n_vertices: usize) {
    let mut starts = vec![0u32; n_vertices + 1];
    for tail in &mesh.tails {
        starts[tail.index() + 1] += 1;
    }
    for v in 0..n_vertices {
        starts[v + 1] += starts[v];
    }
    let mut cursor = starts.clone();
    let mut outgoing = vec![HalfedgeId::new(0); mesh.tails.len()];
    for (h, tail) in mesh.tails.iter().enumerate() {
        let slot = &mut cursor[tail.index()];
        outgoing[*slot as usize] = HalfedgeId::new(h);
        *slot += 1;
    }
    mesh.outgoing_starts = starts;
    mesh.outgoing = outgoing;
}
