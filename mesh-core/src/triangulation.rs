//! Polygons as triangles, chosen once on the rest shape.

use std::ops::Range;

use spade::{ConstrainedDelaunayTriangulation, Triangulation as _};

use crate::connectivity::Connectivity;
use crate::measure::triangle_quality;
use crate::{
    Boundary, FaceId, HalfedgeMesh, Pieces, Point3, Positions, Rows, TriangleFans, UnionFind,
    Vector3, VertexData, VertexId,
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
            simple: None,
            ..self.clone()
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

/// The triangles of polygons, without what touches what.
pub(crate) struct Cut {
    /// Those of one face together, in face order.
    pub(crate) triangles: Vec<[VertexId; 3]>,
    /// As simple programs cut, as many a face.
    simple: Vec<[VertexId; 3]>,
    /// The first triangle of each face, and how many there are in all.
    face_starts: Vec<u32>,
}

impl Cut {
    /// Cuts every face of `mesh` on the shape `rest`.
    pub(crate) fn new(mesh: &HalfedgeMesh, rest: &Positions) -> Self {
        let mut triangles = Vec::with_capacity(mesh.n_faces() * 2);
        let mut simple = Vec::with_capacity(mesh.n_faces() * 2);
        let mut face_starts = vec![0];
        for f in mesh.faces() {
            match *mesh.face_vertices(f) {
                [] => {}
                [a, b, c] => {
                    triangles.push([a, b, c]);
                    simple.push([a, b, c]);
                }
                [a, b, c, d] => {
                    let quad = [a, b, c, d];
                    let normal = polygon_area_vector(&quad.map(|v| rest[v]));
                    triangles.extend(split_quad(quad, |t| signed_quality(t, rest, &normal)));
                    simple.extend(split_quad(quad, |t| triangle_quality(t.map(|v| rest[v]))));
                }
                ref polygon => {
                    triangles.extend(split_polygon(polygon, rest));
                    simple.extend(fan(polygon));
                }
            }
            face_starts.push(triangles.len() as u32);
        }
        Self {
            triangles,
            simple,
            face_starts,
        }
    }
}

/// Area vector of a polygon (Newell): twice the area of its projection times the normal.
fn polygon_area_vector(points: &[Point3]) -> Vector3 {
    let origin = points[0];
    points
        .windows(2)
        .map(|side| (side[0] - origin).cross(&(side[1] - origin)))
        .sum()
}

/// Quality of a triangle, negative when it turns against `normal`.
fn signed_quality(triangle: [VertexId; 3], rest: &Positions, normal: &Vector3) -> f64 {
    let corners = triangle.map(|v| rest[v]);
    triangle_quality(corners) * crate::measure::area_vector(corners).dot(normal).signum()
}

/// The quad along the diagonal whose worst triangle has the better quality.
fn split_quad(
    [a, b, c, d]: [VertexId; 4],
    quality: impl Fn([VertexId; 3]) -> f64,
) -> [[VertexId; 3]; 2] {
    let worst = |[one, two]: [[VertexId; 3]; 2]| quality(one).min(quality(two));
    let (first, second) = ([[a, b, c], [a, c, d]], [[a, b, d], [b, c, d]]);
    if worst(first) >= worst(second) {
        first
    } else {
        second
    }
}

fn fan(polygon: &[VertexId]) -> impl Iterator<Item = [VertexId; 3]> + '_ {
    polygon[1..]
        .windows(2)
        .map(|side| [polygon[0], side[0], side[1]])
}

/// Constrained Delaunay triangulation of the polygon, projected along its area vector; a fan where the projection
/// crosses itself.
fn split_polygon(polygon: &[VertexId], rest: &Positions) -> Vec<[VertexId; 3]> {
    planar_delaunay(polygon, rest)
        .filter(|triangles| triangles.len() == polygon.len() - 2)
        .unwrap_or_else(|| fan(polygon).collect())
}

fn planar_delaunay(polygon: &[VertexId], rest: &Positions) -> Option<Vec<[VertexId; 3]>> {
    let points: Vec<Point3> = polygon.iter().map(|&v| rest[v]).collect();
    let normal = polygon_area_vector(&points).try_normalize(f64::MIN_POSITIVE)?;
    let axis = if normal.x.abs() < 0.7 {
        Vector3::x()
    } else {
        Vector3::y()
    };
    let u = normal.cross(&axis).try_normalize(f64::MIN_POSITIVE)?;
    let v = normal.cross(&u);
    let size = crate::Aabb::of(&points).longest_side();
    let flat: Vec<[f64; 2]> = points
        .iter()
        .map(|p| {
            [
                (p - points[0]).dot(&u) / size,
                (p - points[0]).dot(&v) / size,
            ]
        })
        .collect();

    let mut delaunay = ConstrainedDelaunayTriangulation::<spade::Point2<f64>>::new();
    let mut row_of = Vec::new();
    for (row, &[s, t]) in flat.iter().enumerate() {
        let handle = delaunay.insert(spade::Point2::new(s, t)).ok()?;
        if handle.index() != row {
            return None;
        }
        row_of.push(handle);
    }
    for k in 0..row_of.len() {
        let (from, to) = (row_of[k], row_of[(k + 1) % row_of.len()]);
        if !delaunay.can_add_constraint(from, to) && !delaunay.exists_constraint(from, to) {
            return None;
        }
        delaunay.add_constraint(from, to);
    }
    let mut rows: Vec<[usize; 3]> = delaunay
        .inner_faces()
        .map(|face| face.vertices().map(|vertex| vertex.index()))
        .filter(|t| is_inside(centroid(t.map(|row| flat[row])), &flat))
        .map(lowest_first)
        .collect();
    rows.sort_unstable();
    Some(
        rows.into_iter()
            .map(|t| t.map(|row| polygon[row]))
            .collect(),
    )
}

fn centroid(corners: [[f64; 2]; 3]) -> [f64; 2] {
    [0, 1].map(|axis| corners.iter().map(|c| c[axis]).sum::<f64>() / 3.0)
}

/// Even–odd rule.
fn is_inside([x, y]: [f64; 2], polygon: &[[f64; 2]]) -> bool {
    let n = polygon.len();
    let crossings = (0..n).filter(|&k| {
        let ([ax, ay], [bx, by]) = (polygon[k], polygon[(k + 1) % n]);
        (ay > y) != (by > y) && x < ax + (bx - ax) * (y - ay) / (by - ay)
    });
    crossings.count() % 2 == 1
}

/// The same loop, starting at its lowest row.
fn lowest_first(t: [usize; 3]) -> [usize; 3] {
    let [a, b, c] = t;
    if a <= b && a <= c {
        [a, b, c]
    } else if b <= c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PolygonSoup;

    fn triangulate(points: &[[f64; 3]]) -> Triangulation {
        let soup = PolygonSoup {
            positions: points.iter().map(|&p| Point3::from(p)).collect(),
            faces: vec![(0..points.len() as u32).collect()],
        };
        let (mesh, rest) = soup.into_halfedge().unwrap();
        Triangulation::new(&mesh, &rest)
    }

    fn area(points: &[[f64; 3]]) -> f64 {
        let x: Positions = points.iter().map(|&p| Point3::from(p)).collect();
        triangulate(points)
            .corners(&x)
            .map(crate::measure::triangle_area)
            .sum()
    }

    #[test]
    fn concave_quad_is_split_inside() {
        let arrow = [[0., 0., 0.], [2., 0., 0.], [0.5, 0.5, 0.], [0., 2., 0.]];
        assert!((area(&arrow) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn simple_programs_cut_concave_quads_outside_and_polygons_as_fans() {
        // The kite's inner diagonal cuts slivers, the outer one covers area twice.
        let kite = [[0., 0., 0.], [1., 5., 0.], [0., 0.5, 0.], [-1., 5., 0.]];
        let simple = triangulate(&kite).simply_cut().unwrap();
        let rows = |t: &[VertexId; 3]| t.map(VertexId::index);
        let cut: Vec<_> = simple.triangles().iter().map(rows).collect();
        assert_eq!(cut, [[0, 1, 3], [1, 2, 3]]);
        assert_eq!(simple.parent(1), triangulate(&kite).parent(1));

        let square = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]];
        assert_eq!(triangulate(&square).simply_cut(), None);
        let house = [
            [0., 0., 0.],
            [1., 0., 0.],
            [1., 1., 0.],
            [0.5, 1.5, 0.],
            [0., 1., 0.],
        ];
        let cut = triangulate(&house).simply_cut();
        let has_fan = cut.is_some_and(|t| t.triangles().iter().all(|t| t[0].index() == 0));
        assert!(has_fan);
    }

    #[test]
    fn concave_polygon_keeps_its_area() {
        let l_shape = [
            [0., 0., 0.],
            [2., 0., 0.01],
            [2., 1., 0.],
            [1., 1., 0.],
            [1., 2., -0.01],
            [0., 2., 0.],
        ];
        let triangles = triangulate(&l_shape);
        assert_eq!(triangles.len(), 4);
        assert!((area(&l_shape) - 3.0).abs() < 1e-3);
    }

    #[test]
    fn edges_are_listed_once() {
        let quad = triangulate(&[[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]]);
        assert_eq!(quad.edges().len(), 5);
        assert_eq!(quad.interior_edges().count(), 1);
    }

    #[test]
    fn self_crossing_polygon_falls_back_to_a_fan() {
        let star = [
            [0., 1., 0.],
            [0.6, -0.8, 0.],
            [-0.95, 0.3, 0.],
            [0.95, 0.3, 0.],
            [-0.6, -0.8, 0.],
        ];
        assert_eq!(triangulate(&star).len(), 3);
    }
}
