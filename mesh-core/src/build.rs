//! Soup → halfedges: the one validation gate. Past it, code assumes every edge has at most two faces.

use crate::side::{edges, sides_by_edge, Side};
use crate::{FaceId, HalfedgeId, HalfedgeMesh, Rows, TopologyError, VertexId};

/// Builds the connectivity of `faces`; see [`HalfedgeMesh::from_faces`].
pub(crate) fn halfedge_mesh(
    n_vertices: usize,
    faces: &[Vec<u32>],
) -> Result<HalfedgeMesh, TopologyError> {
    let n_corners: usize = faces.iter().map(Vec::len).sum();
    check_size("vertices", n_vertices)?;
    check_size("faces", faces.len())?;
    check_size("halfedges", 2 * n_corners)?;

    let loops = loops(n_vertices, faces)?;
    let sides = sides_by_edge(loops.iter().enumerate());
    let mut mesh = HalfedgeMesh {
        tails: Vec::with_capacity(2 * n_corners),
        nexts: Vec::new(),
        faces: Vec::with_capacity(2 * n_corners),
        corner_halfedges: vec![HalfedgeId::new(0); loops.items().len()],
        loops,
        outgoing: Rows::from_lists::<[HalfedgeId; 0]>([]),
        n_cut_edges: 0,
    };
    for on_edge in edges(&sides) {
        add_edges(&mut mesh, on_edge);
    }
    mesh.nexts = vec![HalfedgeId::new(0); mesh.tails.len()];
    link_faces(&mut mesh);
    link_boundaries(&mut mesh);
    let leaving = mesh.tails.iter().enumerate();
    let leaving = leaving.map(|(h, tail)| (tail.index(), HalfedgeId::new(h)));
    mesh.outgoing = Rows::from_pairs(n_vertices, leaving);
    Ok(mesh)
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

/// The vertex loop of each face, repeated neighbours removed, degenerate faces emptied.
fn loops(n_vertices: usize, faces: &[Vec<u32>]) -> Result<Rows<VertexId>, TopologyError> {
    for (face, corners) in faces.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= n_vertices) {
            return Err(TopologyError::VertexOutOfRange {
                face,
                vertex,
                n_vertices,
            });
        }
    }
    Ok(Rows::from_lists(faces.iter().map(|corners| {
        let mut cycle: Vec<VertexId> = Vec::with_capacity(corners.len());
        for (k, &v) in corners.iter().enumerate() {
            if v != corners[(k + 1) % corners.len()] {
                cycle.push(VertexId::new(v as usize));
            }
        }
        let mut distinct = cycle.clone();
        distinct.sort_unstable();
        distinct.dedup();
        if distinct.len() < 3 {
            cycle.clear();
        }
        cycle
    })))
}

/// One edge for two sides that run against each other; otherwise one boundary edge for each side.
fn add_edges(mesh: &mut HalfedgeMesh, sides: &[Side]) {
    if let [a, b] = sides {
        if a.is_forward != b.is_forward {
            add_edge(mesh, a, Some(b));
            return;
        }
    }
    if sides.len() > 1 {
        mesh.n_cut_edges += 1;
    }
    for side in sides {
        add_edge(mesh, side, None);
    }
}

fn add_edge(mesh: &mut HalfedgeMesh, side: &Side, other: Option<&Side>) {
    let h = mesh.tails.len();
    let face = |side: &Side| FaceId::new(side.face as usize);
    let corner = |side: &Side| mesh.loops.range(side.face as usize).start + side.corner as usize;
    let corners = [Some(side), other].map(|side| side.map(corner));
    mesh.tails.extend(side.ends());
    mesh.faces.extend([Some(face(side)), other.map(face)]);
    for (k, corner) in corners.into_iter().enumerate() {
        if let Some(corner) = corner {
            mesh.corner_halfedges[corner] = HalfedgeId::new(h + k);
        }
    }
}

fn link_faces(mesh: &mut HalfedgeMesh) {
    for face in 0..mesh.loops.len() {
        let cycle = &mesh.corner_halfedges[mesh.loops.range(face)];
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
