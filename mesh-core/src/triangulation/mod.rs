//! Polygons as triangles, chosen once on the rest shape, and what touches what among them.

mod connectivity;
mod cut;

use std::ops::Range;

pub use connectivity::Pieces;
pub(crate) use cut::{fan, Cut};

use connectivity::Connectivity;

use crate::{
    Boundary, FaceId, HalfedgeMesh, Point3, Positions, Rows, TriangleFans, UnionFind, VertexData,
    VertexId,
};

/// Triangles of a polygon mesh, each with its parent face, and what touches what among them.
///
/// Triangles stay triangles; a quad is split along the diagonal whose worst triangle has the better quality Q_f
/// (Eq. 4), a concave one along the diagonal inside it; a polygon with more sides is split by a constrained
/// Delaunay triangulation in its best plane. Degenerate faces give no triangle.
///
/// It is built once for a mesh, at rest, and is what everything else takes: edges, neighbours, the open boundary and the
/// connected pieces are listed then, and looked up from there on. Triangles and edges are named by their rows; side `k`
/// of a triangle is the one opposite to its corner `k`.
///
/// ```
/// use mesh_core::{shapes, Triangulation, VertexId};
/// let (mesh, rest) = shapes::open_grid(2, 1).into_halfedge()?;
/// let triangulation = Triangulation::new(&mesh, &rest);
/// assert_eq!((triangulation.n_vertices(), triangulation.n_faces(), triangulation.len()), (6, 2, 4));
/// assert_eq!(triangulation.edges().len(), 9);
/// assert!(triangulation.is_boundary_vertex(VertexId::new(0)));
/// assert_eq!(triangulation.pieces().n, 1);
/// # Ok::<(), mesh_core::TopologyError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Triangulation {
    faces: Rows<VertexId>,
    parents: Vec<FaceId>,
    /// The first triangle of each face, and how many there are in all.
    face_starts: Vec<u32>,
    connectivity: Connectivity,
    /// As simple programs cut, as many a face; none where that is the same.
    simple: Option<Vec<[VertexId; 3]>>,
}

/// An edge shared by exactly two triangles of a [`Triangulation`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TriangulationEdge {
    /// Its ends, the lower row first.
    pub vertices: [VertexId; 2],
    /// The two triangles, by row, the lower first.
    pub triangles: [usize; 2],
}

impl Triangulation {
    /// Triangulates every face of `mesh` on the shape `rest`.
    ///
    /// # Panics
    /// If there is not one position for each vertex.
    pub fn new(mesh: &HalfedgeMesh, rest: &Positions) -> Self {
        assert_eq!(rest.len(), mesh.n_vertices(), "one position per vertex");
        let Cut {
            triangles,
            simple,
            face_starts,
        } = Cut::new(mesh, rest);
        let spans = face_starts.windows(2).enumerate();
        let parents =
            spans.flat_map(|(face, ends)| (ends[0]..ends[1]).map(move |_| FaceId::new(face)));
        Self {
            parents: parents.collect(),
            simple: (simple != triangles).then_some(simple),
            connectivity: Connectivity::new(mesh.n_vertices(), triangles),
            faces: mesh.loops.clone(),
            face_starts,
        }
    }

    /// The same polygons as simple programs cut them, where that differs: quads along the diagonal whose worst triangle
    /// has the better quality, even where it lies outside, and larger polygons as fans.
    ///
    /// A mesh without folds should not seem folded there.
    pub fn simply_cut(&self) -> Option<Self> {
        self.simple.as_ref().map(|triangles| Self {
            connectivity: Connectivity::new(self.n_vertices(), triangles.clone()),
            faces: self.faces.clone(),
            parents: self.parents.clone(),
            face_starts: self.face_starts.clone(),
            simple: None,
        })
    }

    /// How many vertices the mesh has, those that no triangle uses included.
    pub fn n_vertices(&self) -> usize {
        self.connectivity.vertex_neighbours.len()
    }

    /// How many polygons the mesh has, degenerate ones included.
    pub fn n_faces(&self) -> usize {
        self.faces.len()
    }

    /// How many triangles there are.
    pub fn len(&self) -> usize {
        self.parents.len()
    }

    /// Whether there is no triangle.
    pub fn is_empty(&self) -> bool {
        self.parents.is_empty()
    }

    /// All vertices, in order.
    pub fn vertices(&self) -> impl ExactSizeIterator<Item = VertexId> + use<> {
        (0..self.n_vertices()).map(VertexId::new)
    }

    /// All triangles, those of one face together, in face order.
    pub fn triangles(&self) -> &[[VertexId; 3]] {
        self.connectivity.fans.triangles()
    }

    /// The rows of every triangle's vertices.
    pub fn rows(&self) -> Vec<[u32; 3]> {
        let of = |t: &[VertexId; 3]| t.map(|v| v.index() as u32);
        self.triangles().iter().map(of).collect()
    }

    /// The corner points of every triangle at `x`.
    pub fn corners<'a>(
        &'a self,
        x: &'a Positions,
    ) -> impl ExactSizeIterator<Item = [Point3; 3]> + 'a {
        self.triangles().iter().map(|t| t.map(|v| x[v]))
    }

    /// The face that triangle `t` is part of.
    pub fn parent(&self, t: usize) -> FaceId {
        self.parents[t]
    }

    /// The rows of the triangles of a face; none of a degenerate one.
    pub fn face_triangles(&self, f: FaceId) -> Range<usize> {
        self.face_starts[f.index()] as usize..self.face_starts[f.index() + 1] as usize
    }

    /// The vertices of a face in loop order, repeated neighbours removed; empty for a degenerate face.
    pub fn face_vertices(&self, f: FaceId) -> &[VertexId] {
        &self.faces[f.index()]
    }

    /// Every edge once, diagonals of polygons included, the lower vertex first, in order of their vertices.
    pub fn edges(&self) -> &[[VertexId; 2]] {
        &self.connectivity.edges
    }

    /// The rows of the triangles that share edge `e`, ascending: one on an open boundary, two within a surface, more
    /// where surfaces branch.
    pub fn edge_triangles(&self, e: usize) -> &[u32] {
        &self.connectivity.edge_triangles[e]
    }

    /// The edges that exactly two triangles share, diagonals of polygons included, in order of their vertices.
    pub fn interior_edges(&self) -> impl Iterator<Item = TriangulationEdge> + '_ {
        let edges = self.edges().iter().enumerate();
        edges.filter_map(|(e, &vertices)| match *self.edge_triangles(e) {
            [a, b] => Some(TriangulationEdge {
                vertices,
                triangles: [a, b].map(|t| t as usize),
            }),
            _ => None,
        })
    }

    /// The edges of triangle `t`: edge `k` is opposite to corner `k`.
    pub fn triangle_edges(&self, t: usize) -> [usize; 3] {
        self.connectivity.triangle_edges[t].map(|e| e as usize)
    }

    /// The triangle across each side of triangle `t`; none at an open boundary and where more than two share the edge.
    pub fn triangle_neighbours(&self, t: usize) -> [Option<usize>; 3] {
        self.triangle_edges(t)
            .map(|e| match *self.edge_triangles(e) {
                [a, b] => Some(if a as usize == t { b } else { a } as usize),
                _ => None,
            })
    }

    /// The vertices joined to `v` by an edge, ascending.
    pub fn vertex_neighbours(&self, v: VertexId) -> &[VertexId] {
        &self.connectivity.vertex_neighbours[v.index()]
    }

    /// The rows of the triangles at `v`, ascending.
    pub fn vertex_triangles(&self, v: VertexId) -> &[u32] {
        self.connectivity.fans.at_vertex(v)
    }

    /// The triangles around each vertex: for normals where triangles meet.
    pub fn fans(&self) -> &TriangleFans {
        &self.connectivity.fans
    }

    /// Whether some triangle uses the vertex.
    pub fn is_used(&self, v: VertexId) -> bool {
        !self.vertex_triangles(v).is_empty()
    }

    /// The vertices that some triangle uses, in order.
    pub fn used_vertices(&self) -> impl Iterator<Item = VertexId> + '_ {
        self.vertices().filter(|&v| self.is_used(v))
    }

    /// The open boundary: the sides that a single triangle has.
    pub fn boundary(&self) -> &Boundary {
        &self.connectivity.boundary
    }

    /// Whether the vertex is the end of an edge that a single triangle uses.
    pub fn is_boundary_vertex(&self, v: VertexId) -> bool {
        self.boundary().is_vertex(v)
    }

    /// Whether no other triangle has the side of triangle `t` opposite to its corner `k`.
    pub fn is_boundary_side(&self, t: usize, k: usize) -> bool {
        self.boundary().is_side(t as u32, k)
    }

    /// The connected piece of each vertex. Vertices that share an edge are in one piece; one that no triangle uses is its
    /// own.
    pub fn pieces(&self) -> &Pieces {
        &self.connectivity.pieces
    }

    /// The chosen vertices in groups that edges between chosen ones join, each ascending, in order of their first.
    pub fn connected_groups(&self, is_chosen: impl Fn(VertexId) -> bool) -> Vec<Vec<VertexId>> {
        let is_chosen: VertexData<bool> = self.vertices().map(is_chosen).collect();
        let mut sets = UnionFind::new(self.n_vertices());
        for &[a, b] in self.edges() {
            if is_chosen[a] && is_chosen[b] {
                sets.union(a.index(), b.index());
            }
        }
        let groups = sets.sets(|v| is_chosen[VertexId::new(v)]);
        let ids = |group: Vec<usize>| group.into_iter().map(VertexId::new).collect();
        groups.into_iter().map(ids).collect()
    }
}
