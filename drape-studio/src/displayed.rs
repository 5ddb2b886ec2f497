//! Source and target as the studio holds them: what is draped, with what the page shows and picks on.

use std::path::Path;
use std::sync::{Arc, OnceLock};

use anyhow::Result;
use mesh_core::io::{read_mesh, Looks, NamedFaces};
use mesh_core::{
    Location, MeshPoint, Point3, PolygonSoup, Positions, TargetSurface, TriangleBvh, Triangulation,
    UnitFrame, Vector3, VertexData, VertexId,
};
use mesh_draping::landmarks::{source_symmetry, target_symmetry};
use mesh_draping::{SnapPoints, Source, Target};
use mesh_metrics::new_crossings;

use crate::buffers::DisplayBuffers;
use crate::looks::{DisplayedLooks, ShownTriangle};
use crate::pick::{self, Ray};
use crate::shapes::Shapes;

/// More parts than this are not listed.
const MAX_PARTS: usize = 200;

/// A source and a target.
#[derive(Clone)]
pub(crate) struct DisplayedPair {
    pub(crate) source: Arc<DisplayedSource>,
    pub(crate) target: Arc<DisplayedTarget>,
    /// What is draped.
    pub(crate) shapes: Shapes,
}

/// A mesh to deform.
pub(crate) struct DisplayedSource {
    pub(crate) source: Source,
    /// The frame of its view.
    pub(crate) frame: UnitFrame,
    pub(crate) buffers: DisplayBuffers,
    pub(crate) looks: DisplayedLooks,
    /// The axis across which it is most nearly symmetric.
    pub(crate) symmetry: usize,
    snap_points: OnceLock<SnapPoints>,
}

/// A shape to drape over.
pub(crate) struct DisplayedTarget {
    pub(crate) target: Target,
    /// The frame of its view, and of the result's.
    pub(crate) frame: UnitFrame,
    pub(crate) buffers: DisplayBuffers,
    pub(crate) looks: DisplayedLooks,
    /// The axis across which it is most nearly symmetric.
    pub(crate) symmetry: usize,
    snap_points: OnceLock<SnapPoints>,
}

impl DisplayedPair {
    pub(crate) fn new(source: Arc<DisplayedSource>, target: Arc<DisplayedTarget>) -> Self {
        Self {
            shapes: Shapes::new(source.source.clone(), target.target.clone()),
            source,
            target,
        }
    }

    /// How many pairs of triangles pass through each other at `x` and do not at rest.
    pub(crate) fn new_crossings(&self, x: &Positions) -> usize {
        let source = &self.shapes.source;
        new_crossings(source.triangulation(), source.rest(), x).len()
    }
}

impl DisplayedSource {
    /// Reads a source.
    pub(crate) fn read(path: &Path) -> Result<Self> {
        Ok(Self::new(Source::read(path)?))
    }

    fn new(source: Source) -> Self {
        let frame = UnitFrame::of(source.bvh().bounds());
        let mesh = source.mesh();
        let row = |v: &VertexId| v.index() as u32;
        let faces = mesh
            .faces()
            .map(|f| mesh.face_vertices(f).iter().map(row).collect());
        let soup = PolygonSoup {
            positions: source.rest().as_slice().to_vec(),
            faces: faces.collect(),
        };
        let triangles = source.triangulation().triangles();
        let triangles = triangles.iter().map(|t| t.map(|v| row(&v)));
        Self {
            buffers: DisplayBuffers::of_mesh(&frame, &soup, triangles.collect()),
            looks: source_looks(&source),
            symmetry: source_symmetry(&source).axis,
            snap_points: OnceLock::new(),
            frame,
            source,
        }
    }

    /// The groups, objects and materials of the file, each name once.
    pub(crate) fn parts(&self) -> Vec<&NamedFaces> {
        let mut parts: Vec<&NamedFaces> = Vec::new();
        for named in self.named_faces() {
            let is_known = parts.iter().any(|p| p.name == named.name);
            if !is_known && parts.len() < MAX_PARTS {
                parts.push(named);
            }
        }
        parts
    }

    fn named_faces(&self) -> impl Iterator<Item = &NamedFaces> {
        let contents = self.source.file().map(|file| file.contents());
        let lists = contents.map(|c| [&c.groups, &c.objects, &c.materials]);
        lists.into_iter().flatten().flatten()
    }

    /// The triangles of the faces that have a name, as ranges of rows.
    pub(crate) fn part_triangles(&self, name: &str) -> Vec<[usize; 2]> {
        let (t, n_faces) = (self.source.triangulation(), self.source.mesh().n_faces());
        // Triangles are in the order of their faces.
        let mut first = vec![0; n_faces + 1];
        for row in 0..t.len() {
            first[t.parent(row).index() + 1] += 1;
        }
        for face in 1..first.len() {
            first[face] += first[face - 1];
        }
        let end = |face: usize| first[face.min(n_faces)];
        let named = self.named_faces().filter(|n| n.name == name);
        let ranges = named.flat_map(|n| &n.faces);
        ranges.map(|r| [end(r.start), end(r.end)]).collect()
    }

    /// The triangles all of whose corners are among some vertices, as ranges of rows.
    pub(crate) fn triangles_within(&self, vertices: &[VertexId]) -> Vec<[usize; 2]> {
        let mut is_in = VertexData::new(self.source.rest().len(), false);
        vertices.iter().for_each(|&v| is_in[v] = true);
        let triangles = self.source.triangulation().triangles().iter().enumerate();
        let within = triangles.filter(|(_, t)| t.iter().all(|&v| is_in[v]));
        let mut ranges: Vec<[usize; 2]> = Vec::new();
        for (row, _) in within {
            match ranges.last_mut() {
                Some([_, end]) if *end == row => *end += 1,
                _ => ranges.push([row, row + 1]),
            }
        }
        ranges
    }

    /// The first place that a ray in the frame of the view meets, at rest.
    pub(crate) fn pick(&self, ray: &Ray) -> Option<MeshPoint> {
        let location = pick::first_hit(self.source.bvh(), &self.frame, ray)?;
        self.source.place(location)
    }

    /// What marks snap to, in the rows of the vertices.
    pub(crate) fn snap_points(&self) -> &SnapPoints {
        self.snap_points.get_or_init(|| {
            let triangles = self.source.triangulation().triangles().iter();
            let rows = triangles.map(|t| t.map(|v| v.index() as u32));
            SnapPoints::of_faces(self.source.rest().as_slice().to_vec(), rows)
        })
    }

    /// The hierarchy of the triangles with the vertices at `x`.
    pub(crate) fn moved_bvh(&self, x: &Positions) -> TriangleBvh {
        let mut bvh = self.source.bvh().clone();
        bvh.refit(self.source.triangulation().corners(x));
        bvh
    }
}

impl DisplayedTarget {
    /// Reads a target; a file without faces is a cloud.
    pub(crate) fn read(path: &Path) -> Result<Self> {
        let file = read_mesh(path)?;
        let looks = file.looks();
        Self::new(Target::of_file(file)?, looks)
    }

    fn new(target: Target, looks: Looks) -> Result<Self> {
        let frame = UnitFrame::of(target.judged().bounds());
        let (buffers, shown) = if target.is_cloud() {
            let normals = normals(target.vertices(), target.judged().as_ref());
            let buffers = DisplayBuffers::of_cloud(&frame, target.vertices(), &normals);
            (buffers, Vec::new())
        } else {
            triangles(target.soup(), &frame)?
        };
        let rows = 0..buffers.n_vertices;
        Ok(Self {
            looks: DisplayedLooks::new(looks, &target.soup().faces, rows, &shown),
            symmetry: target_symmetry(&target).axis,
            snap_points: OnceLock::new(),
            frame,
            buffers,
            target,
        })
    }

    /// What marks snap to.
    pub(crate) fn snap_points(&self) -> &SnapPoints {
        self.snap_points.get_or_init(|| {
            let soup = self.target.soup();
            let points = soup.positions.clone();
            if self.target.is_cloud() {
                let normals = normals(&points, self.judged());
                return SnapPoints::of_cloud(points, normals);
            }
            SnapPoints::of_faces(points, &soup.faces)
        })
    }

    /// The surface that results are judged by.
    pub(crate) fn judged(&self) -> &dyn TargetSurface {
        self.target.judged().as_ref()
    }

    /// The first place that a ray in the frame of the view meets, of all that is in the file.
    pub(crate) fn pick(&self, ray: &Ray) -> Option<Point3> {
        let Some(bvh) = self.target.whole() else {
            return pick::front_point(self.target.vertices(), &self.frame, ray);
        };
        let location = pick::first_hit(bvh, &self.frame, ray)?;
        let Location::Triangle { index, barycentric } = location else {
            return None;
        };
        let corners = bvh.triangle(index);
        let sum: Vector3 = (0..3).map(|k| corners[k].coords * barycentric[k]).sum();
        Some(Point3::from(sum))
    }
}

/// The normals of a cloud at its points.
fn normals(points: &[Point3], judged: &dyn TargetSurface) -> Vec<Vector3> {
    let closest = judged.closest_points(points);
    let normals = closest.iter().map(|c| judged.normal(&c.location));
    normals.map(Option::unwrap_or_default).collect()
}

/// What is shown of the source as its file has it.
fn source_looks(source: &Source) -> DisplayedLooks {
    let Some(file) = source.file() else {
        return DisplayedLooks::default();
    };
    let t = source.triangulation();
    // Of vertices that the file has several times, the corner of the face tells which one is meant.
    let faces = &file.soup().faces;
    let row_in = |face: usize, v: VertexId| {
        let corners = faces.get(face).into_iter().flatten();
        let mut corners = corners.map(|&row| row as usize);
        corners
            .find(|&row| source.vertex_at(row) == Some(v))
            .unwrap_or_else(|| source.file_row(v))
    };
    let shown = t.triangles().iter().enumerate().map(|(k, corners)| {
        let face = t.parent(k).index();
        ShownTriangle {
            face,
            rows: corners.map(|v| row_in(face, v)),
            vertices: corners.map(|v| v.index() as u32),
        }
    });
    let shown: Vec<ShownTriangle> = shown.collect();
    let rows = source.rest().ids().map(|v| source.file_row(v));
    DisplayedLooks::new(file.looks(), faces, rows, &shown)
}

fn triangles(
    soup: &PolygonSoup,
    frame: &UnitFrame,
) -> Result<(DisplayBuffers, Vec<ShownTriangle>)> {
    let (triangles, parents): (Vec<[u32; 3]>, Vec<usize>) =
        if soup.faces.iter().all(|f| f.len() == 3) {
            let corners = soup.faces.iter().map(|f| [f[0], f[1], f[2]]);
            (corners.collect(), (0..soup.faces.len()).collect())
        } else {
            let (mesh, rest) = soup.clone().into_halfedge()?;
            let t = Triangulation::new(&mesh, &rest);
            let corners = t.triangles().iter();
            let corners = corners.map(|c| c.map(|v| v.index() as u32)).collect();
            (corners, (0..t.len()).map(|k| t.parent(k).index()).collect())
        };
    let shown = triangles
        .iter()
        .zip(parents)
        .map(|(&vertices, face)| ShownTriangle {
            face,
            rows: vertices.map(|v| v as usize),
            vertices,
        });
    let shown = shown.collect();
    Ok((DisplayBuffers::of_mesh(frame, soup, triangles), shown))
}
