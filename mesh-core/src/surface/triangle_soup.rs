//! Triangle soup as a target: duplicates, degenerate triangles, holes, random orientation are all welcome.

use rayon::prelude::*;

use super::open_boundary::open_boundary;
use super::orientation::Orientation;
use super::patches::Patches;
use super::stray::Strays;
use super::welded::WeldedTriangles;
use super::{Location, NormalSign, SurfacePoint, SurfaceSample, TargetSurface};
use crate::measure::{triangle_area, triangle_normal};
use crate::sampling::{SeededRng, TriangleSampler};
use crate::triangulation::Cut;
use crate::{
    Aabb, Boundary, Point3, PolygonSoup, TopologyError, TriangleBvh, TriangleFans, Vector3,
    VertexId,
};

/// A target made of triangles, of which nothing is expected but finite corners.
///
/// Polygons are split as by [`crate::Triangulation`]; a [`Location`] names rows of these triangles. Of triangles over the
/// same three places two count, one for each side of a sheet: more of them say nothing new. Normals are those of the
/// triangles, means on edges and corners, turned outwards as far as the shape tells (see
/// [`TargetSurface::normal_sign`]).
///
/// ```
/// use mesh_core::{shapes, Point3, TargetSurface, TriangleSoup};
/// let target = TriangleSoup::new(shapes::icosphere(3))?;
/// let closest = target.closest_point(&Point3::new(0.0, 0.0, 2.0));
/// assert!((closest.distance_squared - 1.0).abs() < 0.01);
/// assert!(target.normal(&closest.location).is_some_and(|n| n.z > 0.99));
/// # Ok::<(), mesh_core::TopologyError>(())
/// ```
pub struct TriangleSoup {
    bvh: TriangleBvh,
    boundary: Boundary,
    fans: TriangleFans,
    orientation: Orientation,
    vertices: Vec<Point3>,
    area: f64,
    sampler: TriangleSampler,
}

impl TriangleSoup {
    /// The target with the faces of `soup`; vertices no face uses are ignored.
    ///
    /// # Errors
    /// A face that names a vertex that is not there, a coordinate that is not finite, or no face with three corners.
    pub fn new(soup: PolygonSoup) -> Result<Self, TopologyError> {
        let (positions, mut triangles) = triangles(soup)?;
        if triangles.is_empty() {
            return Err(TopologyError::NoFaces);
        }
        let mut welded = WeldedTriangles::new(&positions, &triangles);
        if let Some(fewer) = welded.at_most_two_of_each(&triangles) {
            triangles = fewer;
            welded = WeldedTriangles::new(&positions, &triangles);
        }
        let corners = |t: &[u32; 3]| t.map(|v| positions[v as usize]);
        let bvh = TriangleBvh::new(triangles.iter().map(corners).collect());
        let areas = || triangles.iter().map(|t| triangle_area(corners(t)));
        let (area, sampler) = (areas().sum(), TriangleSampler::new(areas()));
        Ok(Self {
            boundary: open_boundary(&welded, &bvh),
            orientation: Orientation::new(&welded, &bvh),
            vertices: welded.used_points(),
            fans: TriangleFans::new(welded.points.len(), welded.triangles),
            area,
            sampler,
            bvh,
        })
    }

    /// Normal of a triangle, turned outwards as far as the shape tells.
    fn triangle_normal(&self, row: u32) -> Option<Vector3> {
        let normal = triangle_normal(self.bvh.triangle(row))?;
        Some(if self.orientation.is_flipped[row as usize] {
            -normal
        } else {
            normal
        })
    }

    /// The hierarchy of the triangles, for queries beyond those of [`TargetSurface`].
    pub fn bvh(&self) -> &TriangleBvh {
        &self.bvh
    }

    /// Area of the surface, in squared units of the coordinates.
    pub fn area(&self) -> f64 {
        self.area
    }

    /// Whether the surface has an open boundary: an edge of a single triangle behind which it does not go on. Cracks and
    /// gaps of a triangle or two are none.
    pub fn has_boundary(&self) -> bool {
        !self.boundary.is_empty()
    }

    /// Triangles that do not belong to the outer surface: fins, crumbs, and patches that no ray from outside reaches.
    ///
    /// Only where one patch makes up most of the soup. Surfaces that hang together are never taken apart: the inside of
    /// a mouth is part of its face.
    pub fn strays(&self) -> Strays {
        Strays::of(&self.bvh)
    }

    /// The same target without the triangles in these rows; the others are numbered anew. None if none is left.
    pub fn without(&self, rows: &[u32]) -> Option<Self> {
        let mut is_out = vec![false; self.bvh.len()];
        for &row in rows {
            if let Some(out) = is_out.get_mut(row as usize) {
                *out = true;
            }
        }
        let kept = (0..self.bvh.len() as u32).filter(|&t| !is_out[t as usize]);
        let positions: Vec<Point3> = kept.flat_map(|t| self.bvh.triangle(t)).collect();
        let n = positions.len() as u32 / 3;
        let faces = (0..n).map(|t| vec![3 * t, 3 * t + 1, 3 * t + 2]).collect();
        Self::new(PolygonSoup { positions, faces }).ok()
    }
}

impl TargetSurface for TriangleSoup {
    fn closest_point(&self, query: &Point3) -> SurfacePoint {
        self.bvh
            .closest_point(query)
            .expect("a triangle soup has a triangle")
    }

    fn closest_point_from(&self, query: &Point3, hint: u32) -> SurfacePoint {
        self.bvh
            .closest_point_from(query, hint)
            .expect("a triangle soup has a triangle")
    }

    fn closest_points(&self, queries: &[Point3]) -> Vec<SurfacePoint> {
        self.bvh.closest_points(queries)
    }

    fn sample(&self, n: usize, rng: &mut SeededRng) -> Vec<SurfaceSample> {
        let places = self.sampler.sample(n, rng).into_iter();
        places
            .map(|(row, barycentric)| {
                let index = row as u32;
                let corners = self.bvh.triangle(index);
                let weighted = (0..3).map(|k| corners[k].coords * barycentric[k]);
                SurfaceSample {
                    point: Point3::from(weighted.sum::<Vector3>()),
                    location: Location::Triangle { index, barycentric },
                }
            })
            .collect()
    }

    fn vertices(&self) -> Vec<Point3> {
        self.vertices.clone()
    }

    fn normal(&self, location: &Location) -> Option<Vector3> {
        let Location::Triangle { index, barycentric } = location else {
            return None;
        };
        self.fans.normal(
            *index,
            barycentric,
            self.orientation.sign == NormalSign::Oriented,
            |row| self.bvh.triangle(row),
            |row| self.triangle_normal(row),
        )
    }

    fn normal_sign(&self) -> NormalSign {
        self.orientation.sign
    }

    fn is_on_boundary(&self, location: &Location) -> bool {
        match location {
            Location::Triangle { index, barycentric } => {
                self.boundary.contains(*index, barycentric)
            }
            Location::Point { .. } => false,
        }
    }

    fn patches(&self, places: &[SurfaceSample]) -> Option<Patches> {
        let corners = |row| self.bvh.triangle(row);
        Some(Patches::new(&self.fans, corners, places))
    }

    fn bounds(&self) -> Aabb {
        self.bvh.bounds()
    }
}

/// The points of `soup` and its faces as triangles with three different vertices.
fn triangles(soup: PolygonSoup) -> Result<(Vec<Point3>, Vec<[u32; 3]>), TopologyError> {
    soup.check()?;
    if soup.faces.par_iter().all(|f| f.len() == 3) {
        // Large scans are triangles: no need of a halfedge mesh.
        let distinct = soup.faces.iter().map(|f| [f[0], f[1], f[2]]);
        let triangles = distinct
            .filter(|[a, b, c]| a != b && b != c && c != a)
            .collect();
        return Ok((soup.positions, triangles));
    }
    let (mesh, positions) = soup.into_halfedge()?;
    let rows = |t: &[VertexId; 3]| t.map(|v| v.index() as u32);
    let triangles = Cut::new(&mesh, &positions)
        .triangles
        .iter()
        .map(rows)
        .collect();
    Ok((positions.into_vec(), triangles))
}
