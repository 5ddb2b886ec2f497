//! Source and target in memory: to drape, to pick on, to show.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{ensure, Context as _};
use mesh_core::io::{self, MeshFile, NamedFaces};
use mesh_core::{
    Aabb, HalfedgeMesh, Location, MeshPoint, Point3, PolygonSoup, Positions, TargetSurface,
    TriangleBvh, Triangulation, UnitFrame, Vector3, VertexData, VertexId, Weld,
};

use crate::display::Display;
use crate::pick::{self, Ray};
use crate::{TargetParts, Toolbox};

/// More parts than this are not listed.
const MAX_PARTS: usize = 200;

/// A source and a target.
#[derive(Clone)]
pub struct Scene {
    /// The mesh to deform.
    pub source: Arc<Source>,
    /// The shape to drape over.
    pub target: Arc<Target>,
}

/// A mesh to deform. Vertices of its file at one place are one vertex here.
pub struct Source {
    /// Its file, to write it back.
    pub file: MeshFile,
    /// Its connectivity.
    pub mesh: HalfedgeMesh,
    /// Its shape.
    pub rest: Positions,
    /// Its polygons as triangles.
    pub triangulation: Triangulation,
    pub(crate) frame: UnitFrame,
    pub(crate) display: Display,
    pub(crate) symmetry: usize,
    weld: Weld,
    bvh: TriangleBvh,
}

/// A shape to drape over.
pub struct Target {
    /// Where it was read from.
    pub path: PathBuf,
    /// What is draped over, and what results are judged by.
    pub parts: TargetParts,
    pub(crate) shown: PickSurface,
    pub(crate) frame: UnitFrame,
    pub(crate) display: Display,
    pub(crate) symmetry: usize,
}

/// What is seen and picked: all that is in the file.
pub(crate) enum PickSurface {
    Triangles(TriangleBvh),
    Points(Vec<Point3>),
}

impl Source {
    /// Reads a source.
    ///
    /// # Errors
    /// The file cannot be read, or holds no mesh with an area.
    pub fn read(path: &Path) -> anyhow::Result<Self> {
        let file = io::read_mesh(path)?;
        Self::of_file(file).with_context(|| path.display().to_string())
    }

    fn of_file(file: MeshFile) -> anyhow::Result<Self> {
        file.soup().check()?;
        let weld = file.soup().weld(0.0);
        let (mesh, rest) = weld.soup.clone().into_halfedge()?;
        let triangulation = Triangulation::new(&mesh, &rest);
        ensure!(
            !triangulation.is_empty(),
            "no face has three different corners"
        );
        let bvh = TriangleBvh::new(triangulation.corners(&rest).collect());
        let frame = UnitFrame::of(bvh.bounds());
        let triangles = triangulation
            .triangles()
            .iter()
            .map(|t| t.map(|v| v.index() as u32));
        let symmetry = symmetry_axis(rest.as_slice(), &bvh.bounds(), |p| {
            bvh.closest_point(p)
                .map_or(f64::INFINITY, |c| c.distance_squared)
        });
        Ok(Self {
            display: Display::mesh(&frame, &weld.soup, triangles.collect()),
            symmetry,
            weld,
            frame,
            bvh,
            mesh,
            rest,
            triangulation,
            file,
        })
    }

    /// One position per vertex of the file.
    pub fn spread(&self, positions: &Positions) -> Positions {
        Positions::from(self.weld.spread(positions.as_slice()))
    }

    /// The groups, objects and materials of the file, each name once.
    pub(crate) fn parts(&self) -> Vec<&NamedFaces> {
        let contents = self.file.contents();
        let lists = [&contents.groups, &contents.objects, &contents.materials];
        let mut parts: Vec<&NamedFaces> = Vec::new();
        for named in lists.into_iter().flatten() {
            let is_known = parts.iter().any(|p| p.name == named.name);
            if !is_known && parts.len() < MAX_PARTS {
                parts.push(named);
            }
        }
        parts
    }

    /// The triangles of the faces that have a name, as ranges of rows.
    pub(crate) fn part_triangles(&self, name: &str) -> Vec<[usize; 2]> {
        let t = &self.triangulation;
        // Triangles are in the order of their faces.
        let mut first = vec![0; self.mesh.n_faces() + 1];
        for row in 0..t.len() {
            first[t.parent(row).index() + 1] += 1;
        }
        for face in 1..first.len() {
            first[face] += first[face - 1];
        }
        let end = |face: usize| first[face.min(self.mesh.n_faces())];
        let contents = self.file.contents();
        let lists = [&contents.groups, &contents.objects, &contents.materials];
        let named = lists.into_iter().flatten().filter(|n| n.name == name);
        let ranges = named.flat_map(|n| &n.faces);
        ranges.map(|r| [end(r.start), end(r.end)]).collect()
    }

    /// The triangles all of whose corners are among some vertices, as ranges of rows.
    pub(crate) fn triangles_within(&self, vertices: &[VertexId]) -> Vec<[usize; 2]> {
        let mut is_in = VertexData::new(self.rest.len(), false);
        vertices.iter().for_each(|&v| is_in[v] = true);
        let triangles = self.triangulation.triangles().iter().enumerate();
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

    /// The first row of the file that is vertex `v`.
    pub(crate) fn file_row(&self, v: u32) -> Option<usize> {
        self.weld.row_of.iter().position(|&row| row == v)
    }

    /// The first place that a ray in the frame of the display meets, at rest.
    pub(crate) fn pick(&self, ray: &Ray) -> Option<MeshPoint> {
        self.place(pick::first_hit(&self.bvh, &self.frame, ray)?)
    }

    /// The hierarchy of the triangles with the vertices at `x`.
    pub(crate) fn moved_bvh(&self, x: &Positions) -> TriangleBvh {
        let mut bvh = self.bvh.clone();
        bvh.refit(self.triangulation.corners(x));
        bvh
    }

    /// The place of the surface at rest closest to `point`.
    pub(crate) fn closest_place(&self, point: &Point3) -> Option<MeshPoint> {
        self.place(self.bvh.closest_point(point)?.location)
    }

    pub(crate) fn place(&self, location: Location) -> Option<MeshPoint> {
        match location {
            Location::Triangle { index, barycentric } => Some(MeshPoint::barycentric(
                self.triangulation.triangles()[index as usize],
                barycentric,
            )),
            Location::Point { .. } => None,
        }
    }

    pub(crate) fn bounds(&self) -> Aabb {
        self.bvh.bounds()
    }
}

impl Target {
    /// Reads a target; a file without faces is a cloud.
    ///
    /// # Errors
    /// The file cannot be read, or holds no surface.
    pub fn read(path: &Path, toolbox: &dyn Toolbox) -> anyhow::Result<Self> {
        let file = io::read_mesh(path)?;
        let parts = toolbox.read_target(path)?;
        Self::of_file(file, parts, path).with_context(|| path.display().to_string())
    }

    fn of_file(file: MeshFile, parts: TargetParts, path: &Path) -> anyhow::Result<Self> {
        let judged = parts.judged.as_ref();
        let frame = UnitFrame::of(judged.bounds());
        let soup = file.into_soup();
        let (shown, display) = if soup.faces.is_empty() {
            cloud(soup.positions, judged, &frame)
        } else {
            triangles(soup, &frame)?
        };
        let symmetry = symmetry_axis(&judged.vertices(), &judged.bounds(), |p| {
            judged.closest_point(p).distance_squared
        });
        Ok(Self {
            path: path.to_owned(),
            parts,
            shown,
            frame,
            display,
            symmetry,
        })
    }

    /// The surface that results are judged by.
    pub fn judged(&self) -> &dyn TargetSurface {
        self.parts.judged.as_ref()
    }

    /// Whether it is a cloud of points.
    pub fn is_cloud(&self) -> bool {
        matches!(self.shown, PickSurface::Points(_))
    }

    /// The first place that a ray in the frame of the display meets.
    pub(crate) fn pick(&self, ray: &Ray) -> Option<Point3> {
        match &self.shown {
            PickSurface::Triangles(bvh) => {
                let location = pick::first_hit(bvh, &self.frame, ray)?;
                let Location::Triangle { index, barycentric } = location else {
                    return None;
                };
                let corners = bvh.triangle(index);
                let sum: Vector3 = (0..3).map(|k| corners[k].coords * barycentric[k]).sum();
                Some(Point3::from(sum))
            }
            PickSurface::Points(points) => pick::front_point(points, &self.frame, ray),
        }
    }
}

fn cloud(
    points: Vec<Point3>,
    judged: &dyn TargetSurface,
    frame: &UnitFrame,
) -> (PickSurface, Display) {
    let closest = judged.closest_points(&points);
    let normals: Vec<Vector3> = closest
        .iter()
        .map(|c| judged.normal(&c.location).unwrap_or_default())
        .collect();
    let display = Display::cloud(frame, &points, &normals);
    (PickSurface::Points(points), display)
}

fn triangles(soup: PolygonSoup, frame: &UnitFrame) -> anyhow::Result<(PickSurface, Display)> {
    let triangles: Vec<[u32; 3]> = if soup.faces.iter().all(|f| f.len() == 3) {
        soup.faces.iter().map(|f| [f[0], f[1], f[2]]).collect()
    } else {
        let (mesh, rest) = soup.clone().into_halfedge()?;
        Triangulation::new(&mesh, &rest)
            .triangles()
            .iter()
            .map(|t| t.map(|v| v.index() as u32))
            .collect()
    };
    let corners = triangles
        .iter()
        .map(|t| t.map(|v| soup.positions[v as usize]));
    let bvh = TriangleBvh::new(corners.collect());
    Ok((
        PickSurface::Triangles(bvh),
        Display::mesh(frame, &soup, triangles),
    ))
}

/// Places looked at to find out how symmetric a shape is.
const N_SYMMETRY_PROBES: usize = 400;

/// The axis across which the middle plane of the box comes nearest to a plane of symmetry.
fn symmetry_axis(points: &[Point3], bounds: &Aabb, squared: impl Fn(&Point3) -> f64) -> usize {
    let stride = (points.len() / N_SYMMETRY_PROBES).max(1);
    let miss = |axis: usize| -> f64 {
        let probes = points.iter().step_by(stride);
        probes.map(|p| squared(&mirrored(p, axis, bounds))).sum()
    };
    let by_miss = |a: &(usize, f64), b: &(usize, f64)| a.1.total_cmp(&b.1);
    let best = [0, 1, 2].map(|axis| (axis, miss(axis))).into_iter();
    best.min_by(by_miss).map_or(0, |(axis, _)| axis)
}

/// The image of `p` across the middle plane of a box.
pub(crate) fn mirrored(p: &Point3, axis: usize, bounds: &Aabb) -> Point3 {
    let mut image = *p;
    image[axis] = 2.0 * bounds.center()[axis] - p[axis];
    image
}
