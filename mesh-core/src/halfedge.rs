//! Who touches whom: a halfedge mesh with n-gons kept and no coordinate inside.
//!
//! Vertices and faces keep the rows they have in the file. Only edges are cut: an edge shared by more than two
//! faces, or by two faces that run the same way, becomes one boundary edge per face. Vertices stay whole, so a
//! vertex may have several fans of faces around it, and positions stay shared.

use crate::{EdgeId, FaceId, HalfedgeId, Rows, TopologyError, VertexId};

/// Connectivity of an oriented polygon mesh.
///
/// Invariants: `twin(h) = h ^ 1`; every `next` cycle closes; `head(h) = tail(next(h))`; a halfedge without a face
/// runs along a boundary. A face that names fewer than three different vertices has no halfedge.
#[derive(Clone, Debug, PartialEq)]
pub struct HalfedgeMesh {
    pub(crate) tails: Vec<VertexId>,
    pub(crate) nexts: Vec<HalfedgeId>,
    pub(crate) faces: Vec<Option<FaceId>>,
    /// The vertices of each face in loop order.
    pub(crate) loops: Rows<VertexId>,
    /// The halfedge that leaves each corner, beside the items of `loops`.
    pub(crate) corner_halfedges: Vec<HalfedgeId>,
    pub(crate) outgoing: Rows<HalfedgeId>,
    pub(crate) n_cut_edges: usize,
}

impl HalfedgeMesh {
    /// Connectivity of `faces` over `n_vertices` vertices; cuts edges that no halfedge pair can hold.
    ///
    /// # Errors
    /// A face that names a vertex that is not there, or more elements than 32 bits can count.
    pub fn from_faces(n_vertices: usize, faces: &[Vec<u32>]) -> Result<Self, TopologyError> {
        crate::build::halfedge_mesh(n_vertices, faces)
    }

    /// How many vertices there are, unreferenced ones included.
    pub fn n_vertices(&self) -> usize {
        self.outgoing.len()
    }

    /// How many faces there are, degenerate ones included.
    pub fn n_faces(&self) -> usize {
        self.loops.len()
    }

    /// How many undirected edges there are, counting each part of a cut edge.
    pub fn n_edges(&self) -> usize {
        self.tails.len() / 2
    }

    /// How many halfedges there are: two for each edge.
    pub fn n_halfedges(&self) -> usize {
        self.tails.len()
    }

    /// How many places, counted as pairs of vertices, were cut because no halfedge pair can hold them.
    pub fn n_cut_edges(&self) -> usize {
        self.n_cut_edges
    }

    /// All vertices, in file order.
    pub fn vertices(&self) -> impl ExactSizeIterator<Item = VertexId> + use<> {
        (0..self.n_vertices()).map(VertexId::new)
    }

    /// All faces, in file order.
    pub fn faces(&self) -> impl ExactSizeIterator<Item = FaceId> + use<> {
        (0..self.n_faces()).map(FaceId::new)
    }

    /// All edges.
    pub fn edges(&self) -> impl ExactSizeIterator<Item = EdgeId> + use<> {
        (0..self.n_edges()).map(EdgeId::new)
    }

    /// All halfedges.
    pub fn halfedges(&self) -> impl ExactSizeIterator<Item = HalfedgeId> + use<> {
        (0..self.n_halfedges()).map(HalfedgeId::new)
    }

    /// The other halfedge of the same edge.
    pub fn twin(&self, h: HalfedgeId) -> HalfedgeId {
        HalfedgeId::new(h.index() ^ 1)
    }

    /// The halfedge that follows around the face or boundary loop.
    pub fn next(&self, h: HalfedgeId) -> HalfedgeId {
        self.nexts[h.index()]
    }

    /// The vertex that `h` leaves.
    pub fn tail(&self, h: HalfedgeId) -> VertexId {
        self.tails[h.index()]
    }

    /// The vertex that `h` arrives at.
    pub fn head(&self, h: HalfedgeId) -> VertexId {
        self.tails[h.index() ^ 1]
    }

    /// The face on the left of `h`; none along a boundary.
    pub fn face(&self, h: HalfedgeId) -> Option<FaceId> {
        self.faces[h.index()]
    }

    /// The undirected edge of `h`.
    pub fn edge(&self, h: HalfedgeId) -> EdgeId {
        EdgeId::new(h.index() / 2)
    }

    /// The halfedge `2e` of edge `e`; its twin is the other one.
    pub fn halfedge(&self, e: EdgeId) -> HalfedgeId {
        HalfedgeId::new(2 * e.index())
    }

    /// The two ends of an edge.
    pub fn edge_vertices(&self, e: EdgeId) -> [VertexId; 2] {
        let h = self.halfedge(e);
        [self.tail(h), self.head(h)]
    }

    /// Whether only one face touches the edge.
    pub fn is_boundary_edge(&self, e: EdgeId) -> bool {
        let h = self.halfedge(e);
        self.face(h).is_none() || self.face(self.twin(h)).is_none()
    }

    /// Whether a boundary passes through the vertex.
    pub fn is_boundary_vertex(&self, v: VertexId) -> bool {
        self.outgoing(v).iter().any(|&h| self.face(h).is_none())
    }

    /// The vertices of a face in loop order, repeated neighbours removed; empty for a degenerate face.
    pub fn face_vertices(&self, f: FaceId) -> &[VertexId] {
        &self.loops[f.index()]
    }

    /// The halfedges of a face in loop order: the first leaves `face_vertices(f)[0]`.
    pub fn face_halfedges(&self, f: FaceId) -> &[HalfedgeId] {
        &self.corner_halfedges[self.loops.range(f.index())]
    }

    /// The halfedges that leave a vertex, over all its fans, boundary ones included.
    pub fn outgoing(&self, v: VertexId) -> &[HalfedgeId] {
        &self.outgoing[v.index()]
    }

    /// The vertices joined to `v` by an edge; one that is joined by a cut edge appears once for each part.
    pub fn one_ring(&self, v: VertexId) -> impl Iterator<Item = VertexId> + '_ {
        self.outgoing(v).iter().map(|&h| self.head(h))
    }

    /// The loops of boundary halfedges, each in order.
    pub fn boundary_loops(&self) -> Vec<Vec<HalfedgeId>> {
        let mut is_seen = vec![false; self.n_halfedges()];
        let mut loops = Vec::new();
        for start in self.halfedges().filter(|&h| self.face(h).is_none()) {
            let mut cycle = Vec::new();
            let mut h = start;
            while !is_seen[h.index()] {
                is_seen[h.index()] = true;
                cycle.push(h);
                h = self.next(h);
            }
            if !cycle.is_empty() {
                loops.push(cycle);
            }
        }
        loops
    }
}
