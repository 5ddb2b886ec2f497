//! What a command reads: a source to deform, a target to drape onto, landmarks between them.

use std::path::Path;
use std::sync::Arc;

use anyhow::{ensure, Context as _};
use mesh_core::bvh::closest_point_on_triangle;
use mesh_core::io::{self, MeshFile};
use mesh_core::{
    Aabb, FaceId, HalfedgeMesh, Landmark, Location, MeshPoint, Point3, PointCloud, PolygonSoup,
    Positions, SurfelCloud, TargetSurface, TriangleBvh, TriangleSoup, Triangulation, VertexId,
    Weld,
};

use crate::landmarks;
use crate::output::warn;
use crate::render::Model;
use crate::seams::{widest_gap, Seams};

/// A mesh to deform: connectivity, rest positions, and its polygons as triangles. Vertices of the file that move as one
/// are one vertex here.
pub(crate) struct Source {
    pub(crate) mesh: HalfedgeMesh,
    pub(crate) rest: Arc<Positions>,
    pub(crate) triangulation: Arc<Triangulation>,
    /// The vertices of the file, and which of them are one.
    pub(crate) weld: Weld,
}

impl Source {
    pub(crate) fn new(soup: PolygonSoup, seams: Seams) -> anyhow::Result<Self> {
        soup.check()?;
        Self::of_weld(seams.weld(soup))
    }

    /// Of vertices whose seams are closed.
    pub(crate) fn of_weld(weld: Weld) -> anyhow::Result<Self> {
        let (mesh, rest) = weld.soup.clone().into_halfedge()?;
        let triangulation = Triangulation::new(&mesh, &rest);
        ensure!(
            !triangulation.is_empty(),
            "no face has three different corners"
        );
        Ok(Self {
            mesh,
            rest: Arc::new(rest),
            triangulation: Arc::new(triangulation),
            weld,
        })
    }

    /// How many vertices the file has.
    pub(crate) fn n_file_vertices(&self) -> usize {
        self.weld.row_of.len()
    }

    /// The vertex that row `row` of the file is part of; none where the file has no such row.
    pub(crate) fn vertex_at(&self, row: usize) -> Option<VertexId> {
        let vertex = self.weld.row_of.get(row)?;
        Some(VertexId::new(*vertex as usize))
    }

    /// The first row of the file that is part of a vertex.
    pub(crate) fn file_row(&self, v: VertexId) -> usize {
        let is_part = |&row: &u32| row as usize == v.index();
        let row = self.weld.row_of.iter().position(is_part);
        row.unwrap_or(v.index())
    }

    /// One position per vertex of the file.
    pub(crate) fn spread(&self, positions: &Positions) -> Positions {
        Positions::from(self.weld.spread(positions.as_slice()))
    }

    /// That vertices were welded, in words.
    pub(crate) fn seams_in_words(&self) -> Option<String> {
        let (n_file, n) = (self.n_file_vertices(), self.mesh.n_vertices());
        (n < n_file).then(|| {
            format!("{n_file} vertices at {n} places: those at one place move as one (--weld)")
        })
    }

    /// The place of the surface closest to `point`, on one face or anywhere.
    pub(crate) fn closest_place(
        &self,
        point: &Point3,
        face: Option<FaceId>,
    ) -> anyhow::Result<MeshPoint> {
        let nearest = match face {
            Some(face) => self.closest_on_face(point, face),
            None => self.closest_anywhere(point),
        };
        let (row, weights) = nearest.context("this face has no area")?;
        Ok(MeshPoint::barycentric(
            self.triangulation.triangles()[row],
            weights,
        ))
    }

    fn closest_on_face(&self, point: &Point3, face: FaceId) -> Option<(usize, [f64; 3])> {
        let rows =
            (0..self.triangulation.len()).filter(|&row| self.triangulation.parent(row) == face);
        let candidates = rows.map(|row| {
            let corners = self.triangulation.triangles()[row].map(|v| self.rest[v]);
            let at = closest_point_on_triangle(point, &corners);
            (at.distance_squared, row, at.barycentric)
        });
        candidates
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, row, weights)| (row, weights))
    }

    fn closest_anywhere(&self, point: &Point3) -> Option<(usize, [f64; 3])> {
        let bvh = TriangleBvh::new(self.triangulation.corners(&self.rest).collect());
        match bvh.closest_point(point)?.location {
            Location::Triangle { index, barycentric } => Some((index as usize, barycentric)),
            Location::Point { .. } => None,
        }
    }

    /// The mesh at `positions`, ready to be drawn.
    pub(crate) fn model(&self, positions: &Positions) -> Model {
        Model::mesh(&self.mesh, &self.triangulation, positions)
    }
}

/// A shape to drape onto. A file without faces is a cloud.
pub(crate) struct Target {
    /// What results are judged by: strays left out.
    pub(crate) surface: Arc<dyn TargetSurface>,
    /// What is draped over: the same, but for a cloud, which counts as discs.
    pub(crate) over: Arc<dyn TargetSurface>,
    /// The points of the file, in its order.
    pub(crate) vertices: Vec<Point3>,
    pub(crate) model: Model,
    /// What was left out as no part of the shape, in words.
    pub(crate) left_out: Vec<String>,
}

impl Target {
    fn of_file(file: MeshFile) -> anyhow::Result<Self> {
        if file.soup().faces.is_empty() {
            Self::of_cloud(file)
        } else {
            Self::of_surface(file)
        }
    }

    fn of_surface(file: MeshFile) -> anyhow::Result<Self> {
        let vertices = file.soup().positions.clone();
        let model = Model::of_soup(file.soup())?;
        let mut soup = TriangleSoup::new(file.into_soup())?;
        let strays = soup.strays();
        let mut left_out = Vec::new();
        let total = soup.area();
        if let Some(kept) = soup.without(&strays.rows().collect::<Vec<_>>()) {
            let what = [
                (strays.slivers.len(), "without area"),
                (strays.crumbs.len(), "in crumbs and fins"),
                (
                    strays.hidden.len(),
                    "of inner walls that no ray from outside reaches",
                ),
            ];
            let share = 100.0 * (1.0 - kept.area() / total);
            let counted = what.iter().filter(|(n, _)| *n > 0);
            let list: Vec<String> = counted.map(|(n, what)| format!("{n} {what}")).collect();
            if !list.is_empty() {
                left_out.push(format!(
                    "triangles of the target were left out as no part of its outer surface: {} ({share:.1} % of its area)",
                    list.join(", ")
                ));
                soup = kept;
            }
        }
        let surface: Arc<dyn TargetSurface> = Arc::new(soup);
        Ok(Self {
            over: Arc::clone(&surface),
            surface,
            vertices,
            model,
            left_out,
        })
    }

    fn of_cloud(file: MeshFile) -> anyhow::Result<Self> {
        let normals = file.vertex_normals();
        let vertices = file.into_soup().positions;
        let mut cloud = PointCloud::new(vertices.clone(), normals.clone())?;
        let mut left_out = Vec::new();
        let mut kept = vertices.clone();
        if !cloud.strays().is_empty() {
            let mut is_stray = vec![false; vertices.len()];
            cloud
                .strays()
                .iter()
                .for_each(|&row| is_stray[row as usize] = true);
            let mut row = is_stray.iter();
            kept.retain(|_| row.next() == Some(&false));
            let normals = normals.map(|mut normals| {
                let mut row = is_stray.iter();
                normals.retain(|_| row.next() == Some(&false));
                normals
            });
            left_out.push(format!(
                "{} of {} points of the target lie far from all others and were left out",
                vertices.len() - kept.len(),
                vertices.len()
            ));
            cloud = PointCloud::new(kept.clone(), normals)?;
        }
        let normals: Vec<_> = (0..kept.len() as u32)
            .map(|index| cloud.normal(&Location::Point { index }).unwrap_or_default())
            .collect();
        let cloud = Arc::new(cloud);
        let mut over = Arc::clone(&cloud);
        if let Some(denoised) = cloud.denoised() {
            let share = 100.0 * denoised.scatter / cloud.bounds().longest_side();
            left_out.push(format!(
                "the points of the target scatter by {share:.1} % of its longest side; {} of them were left out, and the others count where the planes of their neighbours run",
                denoised.n_left_out
            ));
            over = Arc::new(denoised.cloud);
        }
        Ok(Self {
            model: Model::cloud(&kept, Some(&normals)),
            over: Arc::new(SurfelCloud::new(over)),
            surface: cloud,
            vertices,
            left_out,
        })
    }
}

/// Everything that a drape starts from.
pub(crate) struct Pair {
    pub(crate) file: Arc<MeshFile>,
    pub(crate) source: Arc<Source>,
    pub(crate) target: Arc<Target>,
    pub(crate) landmarks: Vec<Landmark>,
}

impl Pair {
    pub(crate) fn read(
        source: &Path,
        target: &Path,
        landmarks: Option<&Path>,
        seams: Seams,
    ) -> anyhow::Result<Self> {
        let (file, source) = read_source(source, seams)?;
        let target = read_target(target)?;
        let landmarks = match landmarks {
            Some(path) => landmarks::read(path)?.resolve(&source, &target.vertices)?,
            None => Vec::new(),
        };
        Ok(Self {
            file: Arc::new(file),
            source: Arc::new(source),
            target: Arc::new(target),
            landmarks,
        })
    }

    /// Everything about the inputs that deserves attention, in words.
    pub(crate) fn warnings(&self) -> Vec<String> {
        let mut warnings = landmarks::doctor::examine(self);
        warnings.extend(self.target.left_out.iter().cloned());
        warnings
    }
}

/// A mesh to deform and its file, to write it back.
pub(crate) fn read_source(path: &Path, seams: Seams) -> anyhow::Result<(MeshFile, Source)> {
    let file = io::read_mesh(path)?;
    let source =
        Source::new(file.soup().clone(), seams).with_context(|| path.display().to_string())?;
    Ok((file, source))
}

pub(crate) fn read_target(path: &Path) -> anyhow::Result<Target> {
    Target::of_file(io::read_mesh(path)?).with_context(|| path.display().to_string())
}

/// The positions of a file that must have the vertices of another: where these are one, the first of them speaks.
pub(crate) fn read_positions(path: &Path, source: &Source) -> anyhow::Result<Positions> {
    let positions = Positions::from(io::read_soup(path)?.positions);
    let (found, expected) = (positions.len(), source.n_file_vertices());
    ensure!(
        found == expected,
        "{}: has {found} vertices, but the source has {expected}",
        path.display()
    );
    let gap = widest_gap(&source.weld, &positions) / Aabb::of(positions.iter()).longest_side();
    if gap > TORN {
        warn(&[format!(
            "{}: vertices that are one in the source lie up to {:.2} % of its longest side apart; the first of them counts",
            path.display(),
            100.0 * gap
        )]);
    }
    Ok(Positions::from(source.weld.gather(positions.as_slice())))
}

/// Share of the longest side from which vertices that should be one are apart: text may be rounded.
const TORN: f64 = 1e-5;

#[cfg(test)]
mod tests {
    use super::*;
    use mesh_core::shapes;

    #[test]
    fn a_point_finds_its_place_on_the_surface() {
        let source = Source::new(shapes::quad_sphere(4), Seams::EXACT).unwrap();
        let point = Point3::new(0.3, 2.0, -0.4);
        let place = source
            .closest_place(&point, None)
            .unwrap()
            .position(&source.rest);
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
        assert!(Source::new(soup, Seams::EXACT).is_err());
    }
}
