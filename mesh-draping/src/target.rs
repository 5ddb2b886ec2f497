//! The shape to drape over.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use mesh_core::io::{self, MeshFile};
use mesh_core::{
    Location, Point3, PointCloud, PolygonSoup, SurfelCloud, TargetSurface, TriangleSoup,
    Triangulation, Vector3,
};

use crate::error::{check_extent, in_file, MeshProblem};
use crate::{Error, Note, Shape};

/// A shape to drape over: a mesh with any defect, or a cloud where there are no faces.
///
/// What is no part of the shape is left out, and [`Self::notes`] tells what. Cloning is cheap: clones share everything.
#[derive(Clone)]
pub struct Target {
    path: Option<PathBuf>,
    soup: Arc<PolygonSoup>,
    judged: Arc<dyn TargetSurface>,
    draped_over: Arc<dyn TargetSurface>,
    notes: Arc<[Note]>,
}

impl Target {
    /// Reads a target.
    ///
    /// # Errors
    /// The file cannot be read, or holds neither a triangle nor a point.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, Error> {
        Self::of_file(io::read_mesh(path)?)
    }

    /// The shape in a file that is in memory.
    ///
    /// # Errors
    /// It holds neither a triangle nor a point.
    pub fn of_file(file: MeshFile) -> Result<Self, Error> {
        let path = file.path().to_owned();
        let of_file = Note::of_file(&file, Shape::Target);
        let target = if file.soup().faces.is_empty() {
            let normals = file.vertex_normals();
            Self::of_points(file.into_soup().positions, normals)
        } else {
            Self::of_soup(file.into_soup())
        };
        let target = target.map_err(in_file(&path))?;
        let notes = of_file.into_iter().chain(target.notes.iter().cloned());
        Ok(Self {
            path: Some(path),
            notes: notes.collect(),
            ..target
        })
    }

    /// A surface of polygons: slivers, crumbs, fins and inner walls that no ray from outside reaches are left out.
    ///
    /// # Errors
    /// A face that names a vertex that is not there, a coordinate that is not finite, no triangle, or all corners at one
    /// place.
    pub fn of_soup(soup: PolygonSoup) -> Result<Self, Error> {
        soup.check().map_err(MeshProblem::from)?;
        check_extent(
            soup.faces
                .iter()
                .flatten()
                .map(|&v| &soup.positions[v as usize]),
        )?;
        let mut surface = TriangleSoup::new(soup.clone()).map_err(MeshProblem::from)?;
        let strays = surface.strays();
        let mut notes = Vec::new();
        if let Some(kept) = surface.without(&strays.rows().collect::<Vec<_>>()) {
            let counts = [&strays.slivers, &strays.crumbs, &strays.hidden].map(Vec::len);
            if counts.iter().any(|&n| n > 0) {
                let [n_slivers, n_crumbs, n_hidden] = counts;
                notes.push(Note::TrianglesLeftOut {
                    n_slivers,
                    n_crumbs,
                    n_hidden,
                    share: 1.0 - kept.area() / surface.area(),
                });
                surface = kept;
            }
        }
        let surface: Arc<dyn TargetSurface> = Arc::new(surface);
        Ok(Self {
            path: None,
            soup: Arc::new(soup),
            draped_over: Arc::clone(&surface),
            judged: surface,
            notes: notes.into(),
        })
    }

    /// A cloud, with a normal for each point or none at all: points far from all others are left out, and points that
    /// scatter about the surface count where the planes of their neighbours run.
    ///
    /// # Errors
    /// No point, another number of normals, a coordinate that is not finite, or all points at one place.
    pub fn of_points(points: Vec<Point3>, normals: Option<Vec<Vector3>>) -> Result<Self, Error> {
        let cloud = PointCloud::new(points.clone(), normals.clone()).map_err(MeshProblem::from)?;
        check_extent(&points)?;
        let mut notes = Vec::new();
        let cloud = match without_strays(&cloud, &points, normals.as_deref()) {
            Some((kept, kept_normals)) => {
                notes.push(Note::PointsLeftOut {
                    n: points.len() - kept.len(),
                    n_points: points.len(),
                });
                PointCloud::new(kept, kept_normals).map_err(MeshProblem::from)?
            }
            None => cloud,
        };
        let cloud = Arc::new(cloud);
        let mut over = Arc::clone(&cloud);
        if let Some(denoised) = cloud.denoised() {
            notes.push(Note::PointsScatter {
                scatter: denoised.scatter / cloud.bounds().longest_side(),
                n_left_out: denoised.n_left_out,
            });
            over = Arc::new(denoised.cloud);
        }
        Ok(Self {
            path: None,
            soup: Arc::new(PolygonSoup {
                positions: points,
                faces: Vec::new(),
            }),
            draped_over: Arc::new(SurfelCloud::new(over)),
            judged: cloud,
            notes: notes.into(),
        })
    }

    /// Where it was read from; none for a shape made in memory.
    pub fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }

    /// All that is in the file, what is left out included.
    pub fn soup(&self) -> &PolygonSoup {
        &self.soup
    }

    /// The points of the file, in its order.
    pub fn vertices(&self) -> &[Point3] {
        &self.soup.positions
    }

    /// What results are judged by.
    pub fn judged(&self) -> &Arc<dyn TargetSurface> {
        &self.judged
    }

    /// What is draped over: the same, but for a cloud, whose points count as small discs.
    pub fn draped_over(&self) -> &Arc<dyn TargetSurface> {
        &self.draped_over
    }

    /// Whether it is a cloud of points.
    pub fn is_cloud(&self) -> bool {
        self.soup.faces.is_empty()
    }

    /// Whether both are clones of one target.
    pub fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.soup, &other.soup)
    }

    /// What was left out as no part of the shape.
    pub fn notes(&self) -> &[Note] {
        &self.notes
    }

    /// The polygons of the file as triangles, what is left out included; none for a cloud.
    pub fn triangles(&self) -> Vec<[Point3; 3]> {
        if self.is_cloud() {
            return Vec::new();
        }
        // A target holds no face that names a vertex that is not there, so that this never fails.
        let Ok((mesh, positions)) = self.soup.as_ref().clone().into_halfedge() else {
            return Vec::new();
        };
        Triangulation::new(&mesh, &positions)
            .corners(&positions)
            .collect()
    }

    /// The points of a cloud that were kept, each with its unit normal, zero where it is unknown; none for a surface.
    pub fn kept_points(&self) -> Vec<(Point3, Vector3)> {
        if !self.is_cloud() {
            return Vec::new();
        }
        let normal = |index| self.judged.normal(&Location::Point { index });
        let points = self.judged.vertices().into_iter().zip(0u32..);
        points
            .map(|(p, index)| (p, normal(index).unwrap_or_default()))
            .collect()
    }
}

/// The points of a cloud that are not far from all others, and their normals; none where there are no such.
fn without_strays(
    cloud: &PointCloud,
    points: &[Point3],
    normals: Option<&[Vector3]>,
) -> Option<(Vec<Point3>, Option<Vec<Vector3>>)> {
    let strays = cloud.strays();
    if strays.is_empty() {
        return None;
    }
    let mut is_stray = vec![false; points.len()];
    strays.iter().for_each(|&row| is_stray[row as usize] = true);
    let normals = normals.map(|normals| kept(normals, &is_stray));
    Some((kept(points, &is_stray), normals))
}

fn kept<T: Copy>(values: &[T], is_left_out: &[bool]) -> Vec<T> {
    let rows = values.iter().zip(is_left_out);
    rows.filter(|(_, left_out)| !**left_out)
        .map(|(value, _)| *value)
        .collect()
}
