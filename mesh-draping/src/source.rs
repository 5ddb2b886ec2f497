//! The mesh to deform.

use std::path::Path;
use std::sync::{Arc, OnceLock};

use mesh_core::bvh::closest_point_on_triangle;
use mesh_core::io::{self, MeshFile, Morphs, WriteError};
use mesh_core::{
    map_gradients, Aabb, FaceId, HalfedgeMesh, Location, MeshPoint, Point3, PolygonSoup, Positions,
    TriangleBvh, Triangulation, Vector3, VertexId, Weld,
};

use crate::error::{check_copies, check_extent, in_file, MeshProblem};
use crate::parts::PartProblem;
use crate::{Error, Note, Seams, Shape};

/// A mesh to deform: connectivity, rest positions, its polygons as triangles, and its file, to write it back.
///
/// Vertices of the file that move as one ([`Seams`]) are one vertex here. Cloning is cheap: clones share everything.
#[derive(Clone)]
pub struct Source {
    file: Option<Arc<MeshFile>>,
    mesh: Arc<HalfedgeMesh>,
    rest: Arc<Positions>,
    triangulation: Arc<Triangulation>,
    weld: Arc<Weld>,
    /// The first row of the file for each vertex.
    rows: Arc<Vec<u32>>,
    bvh: Arc<OnceLock<TriangleBvh>>,
    /// Parts that were named in memory.
    parts: Arc<Vec<(String, Vec<VertexId>)>>,
}

/// Positions read for a source, one per vertex.
#[derive(Clone, Debug, PartialEq)]
pub struct GatheredPositions {
    /// Where several vertices of the file are one, the first of them speaks.
    pub positions: Positions,
    /// The farthest that two vertices of the file which are one lie apart, in longest sides of the box of the positions.
    pub widest_gap: f64,
}

impl Source {
    /// Reads a mesh; vertices at one place move as one ([`Seams::EXACT`]).
    ///
    /// ```
    /// use mesh_draping::Source;
    /// # let folder = tempfile::tempdir()?;
    /// # let path = folder.path().join("ball.obj");
    /// # mesh_core::io::write_soup(&path, &mesh_core::shapes::quad_sphere(3))?;
    /// let source = Source::read(&path)?;
    /// assert_eq!(source.rest().len(), source.n_file_vertices());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// The file cannot be read, or holds no mesh with a triangle.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, Error> {
        Self::read_with(path, Seams::EXACT)
    }

    /// Reads a mesh whose seams are closed in the way of `seams`.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn read_with(path: impl AsRef<Path>, seams: Seams) -> Result<Self, Error> {
        Self::of_file(io::read_mesh(path)?, seams)
    }

    /// The mesh in a file that is in memory.
    ///
    /// # Errors
    /// It holds no mesh with a triangle.
    pub fn of_file(file: MeshFile, seams: Seams) -> Result<Self, Error> {
        let source = Self::of_soup(file.soup().clone(), seams).map_err(in_file(file.path()))?;
        Ok(Self {
            file: Some(Arc::new(file)),
            ..source
        })
    }

    /// A mesh that has no file.
    ///
    /// # Errors
    /// A face that names a vertex that is not there, a coordinate that is not finite, no triangle, all vertices at one
    /// place, or a face that is there very many times.
    pub fn of_soup(soup: PolygonSoup, seams: Seams) -> Result<Self, Error> {
        soup.check().map_err(MeshProblem::from)?;
        let weld = seams.weld(soup);
        check_extent(&weld.soup.positions)?;
        check_copies(&weld.soup)?;
        Self::of_weld(weld)
    }

    /// Of vertices whose seams are closed.
    pub(crate) fn of_weld(weld: Weld) -> Result<Self, Error> {
        let (mesh, rest) = (weld.soup.clone().into_halfedge()).map_err(MeshProblem::from)?;
        let triangulation = Triangulation::new(&mesh, &rest);
        if triangulation.is_empty() {
            return Err(MeshProblem::NoTriangle.into());
        }
        let mut rows = vec![u32::MAX; rest.len()];
        for (row, &v) in weld.row_of.iter().enumerate().rev() {
            rows[v as usize] = row as u32;
        }
        Ok(Self {
            file: None,
            mesh: Arc::new(mesh),
            rest: Arc::new(rest),
            triangulation: Arc::new(triangulation),
            weld: Arc::new(weld),
            rows: Arc::new(rows),
            bvh: Arc::default(),
            parts: Arc::default(),
        })
    }

    /// The same source with a part named `name`, that [`Parts`](crate::Parts) find as they find the groups of a file:
    /// the vertices of these rows.
    ///
    /// # Errors
    /// A row that the source does not have.
    pub fn with_part(mut self, name: &str, rows: &[usize]) -> Result<Self, PartProblem> {
        let n = self.n_file_vertices();
        let vertex = |&row: &usize| self.vertex_at(row).ok_or(PartProblem::NoVertex { row, n });
        let vertices = rows.iter().map(vertex).collect::<Result<_, _>>()?;
        Arc::make_mut(&mut self.parts).push((name.to_owned(), vertices));
        Ok(self)
    }

    /// The vertices of a part that was named in memory.
    pub(crate) fn part(&self, name: &str) -> Option<&[VertexId]> {
        let mut parts = self.parts.iter();
        let found = parts.find(|(known, _)| known == name);
        found.map(|(_, vertices)| vertices.as_slice())
    }

    /// The same source; its morph targets are treated as `morphs` says when it is written.
    #[must_use]
    pub fn with_morphs(mut self, morphs: Morphs) -> Self {
        if let Some(file) = &mut self.file {
            Arc::make_mut(file).set_morphs(morphs);
        }
        self
    }

    /// The file it was read from; none for a mesh made in memory.
    pub fn file(&self) -> Option<&MeshFile> {
        self.file.as_deref()
    }

    /// What was read of its file although that contradicts itself, or was not read.
    pub fn notes(&self) -> Vec<Note> {
        self.file()
            .map_or_else(Vec::new, |file| Note::of_file(file, Shape::Source))
    }

    /// Its connectivity, polygons kept.
    pub fn mesh(&self) -> &HalfedgeMesh {
        &self.mesh
    }

    /// Where its vertices are before it is deformed.
    pub fn rest(&self) -> &Arc<Positions> {
        &self.rest
    }

    /// Its polygons as triangles, chosen on the rest shape.
    pub fn triangulation(&self) -> &Arc<Triangulation> {
        &self.triangulation
    }

    /// The hierarchy of its triangles at rest.
    pub fn bvh(&self) -> &TriangleBvh {
        let build = || TriangleBvh::new(self.triangulation.corners(&self.rest).collect());
        self.bvh.get_or_init(build)
    }

    /// Whether both are clones of one source.
    pub fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.rest, &other.rest)
    }

    /// The smallest box around the rest shape.
    pub fn bounds(&self) -> Aabb {
        Aabb::of(self.rest.iter())
    }

    /// How many vertices the file has.
    pub fn n_file_vertices(&self) -> usize {
        self.weld.row_of.len()
    }

    /// The vertex that row `row` of the file is part of; none where the file has no such row.
    pub fn vertex_at(&self, row: usize) -> Option<VertexId> {
        let vertex = self.weld.row_of.get(row)?;
        Some(VertexId::new(*vertex as usize))
    }

    /// The first row of the file that is part of a vertex.
    pub fn file_row(&self, v: VertexId) -> usize {
        self.rows[v.index()] as usize
    }

    /// One position per vertex of the file, from one per vertex of this source.
    pub fn spread(&self, positions: &Positions) -> Positions {
        Positions::from(self.weld.spread(positions.as_slice()))
    }

    /// One value per vertex of this source, from one per vertex of the file: that of the first of those that are one.
    ///
    /// # Panics
    /// If there is not one value per vertex of the file.
    pub fn gather<T: Clone>(&self, values: &[T]) -> Vec<T> {
        self.weld.gather(values)
    }

    /// Reads positions for this source from a file that has its vertices: a result, or where each vertex belongs.
    ///
    /// # Errors
    /// The file cannot be read, or has another number of vertices.
    pub fn read_positions(&self, path: impl AsRef<Path>) -> Result<GatheredPositions, Error> {
        let path = path.as_ref();
        let positions = Positions::from(io::read_soup(path)?.positions);
        let (found, expected) = (positions.len(), self.n_file_vertices());
        if found != expected {
            return Err(Error::PositionCount {
                path: path.to_owned(),
                found,
                expected,
            });
        }
        let side = Aabb::of(positions.iter()).longest_side();
        Ok(GatheredPositions {
            widest_gap: self.widest_gap(&positions) / side,
            positions: Positions::from(self.gather(positions.as_slice())),
        })
    }

    /// The farthest that two vertices of the file which are one here lie apart at `positions`, in their units.
    fn widest_gap(&self, positions: &Positions) -> f64 {
        let mut first = vec![None; self.rest.len()];
        let gaps = positions.iter().zip(&self.weld.row_of).map(|(p, &row)| {
            let there: &mut Option<Point3> = &mut first[row as usize];
            (p - *there.get_or_insert(*p)).norm()
        });
        gaps.fold(0.0, f64::max)
    }

    /// The place of the rest shape closest to `point`.
    pub fn closest_place(&self, point: &Point3) -> Option<MeshPoint> {
        self.place(self.bvh().closest_point(point)?.location)
    }

    /// The place of one face closest to `point`; none where the face has no area.
    pub fn closest_place_on(&self, face: FaceId, point: &Point3) -> Option<MeshPoint> {
        let triangles = self.triangulation.triangles();
        let rows = (0..triangles.len()).filter(|&row| self.triangulation.parent(row) == face);
        let candidates = rows.map(|row| {
            let corners = triangles[row].map(|v| self.rest[v]);
            (closest_point_on_triangle(point, &corners), row)
        });
        let nearest =
            candidates.min_by(|a, b| a.0.distance_squared.total_cmp(&b.0.distance_squared))?;
        let (at, row) = nearest;
        Some(MeshPoint::barycentric(triangles[row], at.barycentric))
    }

    /// A place that a query of [`Self::bvh`] found.
    pub fn place(&self, location: Location) -> Option<MeshPoint> {
        match location {
            Location::Triangle { index, barycentric } => Some(MeshPoint::barycentric(
                self.triangulation.triangles()[index as usize],
                barycentric,
            )),
            Location::Point { .. } => None,
        }
    }

    /// Writes the source with its vertices at `positions`: in its own format nothing else changes.
    ///
    /// # Errors
    /// As [`MeshFile::write`]; a source without a file is written as points and faces.
    pub fn write(&self, path: impl AsRef<Path>, positions: &Positions) -> Result<(), WriteError> {
        let moved = self.spread(positions);
        match &self.file {
            Some(file) => file.write(path, &moved),
            None => io::write_soup(path, &self.moved_soup(moved)),
        }
    }

    /// Displacements from the rest shape, one per vertex of the file, taken to `draped`: `δ' = J δ` with the gradient J of
    /// the map from rest to `draped` around each vertex ([`map_gradients`]), as morph targets of a glTF file are carried.
    ///
    /// # Panics
    /// If there is not one displacement per vertex of the file.
    pub fn carry(&self, draped: &Positions, displacements: &[Vector3]) -> Vec<Vector3> {
        assert_eq!(displacements.len(), self.n_file_vertices());
        let maps = map_gradients(&self.soup(), self.spread(draped).as_slice());
        let carried = displacements.iter().zip(maps);
        carried
            .map(|(d, map)| map.map_or(*d, |map| map * d))
            .collect()
    }

    /// All polygons at rest, with the vertices of the file.
    pub fn soup(&self) -> PolygonSoup {
        match self.file() {
            Some(file) => file.soup().clone(),
            None => self.moved_soup(self.spread(&self.rest)),
        }
    }

    /// The faces of the file with its vertices at `positions`, one per vertex of the file.
    fn moved_soup(&self, positions: Positions) -> PolygonSoup {
        let file_vertex = |v: &VertexId| self.rows[v.index()];
        let face = |f| self.mesh.face_vertices(f).iter().map(file_vertex).collect();
        PolygonSoup {
            positions: positions.into_vec(),
            faces: self.mesh.faces().map(face).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh_core::shapes;

    #[test]
    fn a_point_finds_its_place_on_the_surface() {
        let source = Source::of_soup(shapes::quad_sphere(4), Seams::EXACT).unwrap();
        let point = Point3::new(0.3, 2.0, -0.4);
        let place = source.closest_place(&point).unwrap();
        let place = place.position(source.rest());
        let corners = source.triangulation.corners(&source.rest);
        let brute =
            corners.map(|t| (closest_point_on_triangle(&point, &t).point(&t) - point).norm());
        let nearest = brute.fold(f64::INFINITY, f64::min);
        assert!(((place - point).norm() - nearest).abs() < 1e-12);
    }

    #[test]
    fn a_mesh_without_a_triangle_is_refused() {
        let soup = PolygonSoup {
            positions: vec![Point3::origin(); 2],
            faces: vec![vec![0, 1]],
        };
        assert!(Source::of_soup(soup, Seams::EXACT).is_err());
    }

    #[test]
    fn displacements_turn_and_grow_with_the_surface_around_them() {
        let source = Source::of_soup(shapes::quad_sphere(4), Seams::EXACT).unwrap();
        let turned = |p: Vector3| Vector3::new(-2.0 * p.y, 2.0 * p.x, 2.0 * p.z);
        let draped = source.rest().map(|p| Point3::from(turned(p.coords)));
        let given: Vec<Vector3> = source.rest().iter().map(|p| p.coords * 0.1).collect();
        for (d, carried) in given.iter().zip(source.carry(&draped, &given)) {
            let off = (turned(*d) - carried).norm();
            assert!(off < 1e-9, "{off}: {d:?} {carried:?}");
        }
    }

    #[test]
    fn a_part_named_in_memory_is_found_like_a_group() {
        let soup = shapes::open_grid(2, 2);
        let source = Source::of_soup(soup.clone(), Seams::EXACT).unwrap();
        let named = source.clone().with_part("rim", &[0, 1, 2]).unwrap();
        assert!(source.with_part("rim", &[9]).is_err());
        let pair = crate::Pair {
            source: named,
            target: crate::Target::of_soup(soup).unwrap(),
            landmarks: Vec::new(),
        };
        let parts = crate::Parts {
            free: vec!["rim".to_owned()],
            ..crate::Parts::default()
        };
        let attraction = parts.resolve(&pair).unwrap().regions.attraction;
        let free = attraction.ids().filter(|&v| attraction[v] == 0.0);
        assert_eq!(free.map(|v| v.index()).collect::<Vec<_>>(), [0, 1, 2]);
    }

    #[test]
    fn a_source_without_a_file_is_written_as_points_and_faces() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.obj");
        let source = Source::of_soup(shapes::open_grid(2, 2), Seams::EXACT).unwrap();
        source
            .write(&path, &source.rest().map(|p| p * 2.0))
            .unwrap();
        let back = io::read_soup(&path).unwrap();
        assert_eq!(back.faces, shapes::open_grid(2, 2).faces);
        assert_eq!(
            back.positions[8],
            shapes::open_grid(2, 2).positions[8] * 2.0
        );
    }
}
