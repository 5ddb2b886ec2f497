//! The target as baking sees it: the place that belongs to a point of the draped source.

use mesh_core::measure::area_vector;
use mesh_core::{
    Location, NormalSign, Point3, PointCloud, Positions, TargetSurface, TopologyError, TriangleBvh,
    Triangulation, Vector3,
};
use mesh_draping::Target;
use rayon::prelude::*;

use super::corners::corners_in_face;

/// Share of the longest side of the target's box within which a place along the normal is taken.
const REACH: f64 = 0.02;
/// Share of that side by which a triangle that was left out lies off what was kept, at least.
const ON_SURFACE: f64 = 1e-7;
/// A ray goes through this many sides that face away.
const MOST_CROSSINGS: usize = 8;

/// A place on the surface of a target's file.
pub(super) enum Place {
    /// On a face.
    Face(FacePlace),
    /// A point of a cloud.
    Point { row: usize },
}

/// A place on a face.
pub(super) struct FacePlace {
    /// Row of the face.
    pub(super) face: usize,
    /// Three of its corners, by their places in the face.
    pub(super) corners: [u32; 3],
    /// The same by their vertices.
    pub(super) vertices: [u32; 3],
    /// Their weights.
    pub(super) weights: [f64; 3],
}

/// What belongs to a point of the draped source.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hit {
    /// Row of the triangle, or of the point of a cloud.
    row: u32,
    weights: [f64; 3],
    /// Where it is.
    pub(super) point: Point3,
    /// Whether it lies within reach.
    pub(super) is_near: bool,
}

/// The surface of a target, without what was left out as no part of the shape.
pub(super) struct Sheet {
    kind: Kind,
    reach: f64,
    /// −1 where the source's faces turn inwards and the target's outwards, else 1.
    side: f64,
}

enum Kind {
    Faces(Faces),
    Cloud(Cloud),
}

struct Faces {
    bvh: TriangleBvh,
    /// For each triangle its face, the corners by their places in the face, and the vertices.
    triangles: Vec<(usize, [u32; 3], [u32; 3])>,
    /// Where triangles look to; zero where that is not known.
    facing: Vec<Vector3>,
    /// Unit normals of the vertices.
    normals: Vec<Vector3>,
    is_oriented: bool,
}

struct Cloud {
    points: PointCloud,
    normals: Vec<Vector3>,
}

impl Sheet {
    /// The sheet of a target, for a source that lies at `draped` with `normals` at its vertices.
    pub(super) fn new(
        target: &Target,
        draped: &Positions,
        normals: &[Vector3],
    ) -> Result<Self, TopologyError> {
        let kind = match target.is_cloud() {
            true => Kind::Cloud(Cloud::new(target)?),
            false => Kind::Faces(Faces::new(target)?),
        };
        let side = match &kind {
            Kind::Faces(faces) if faces.is_oriented => faces.side(draped, normals),
            _ => 1.0,
        };
        Ok(Self {
            kind,
            reach: REACH * target.judged().bounds().longest_side(),
            side,
        })
    }

    /// What belongs to a point with this unit normal: of what is met along the normal within reach, both ways, the nearer;
    /// else the closest point that looks the same way, within reach; else the closest point.
    pub(super) fn hit(&self, point: &Point3, normal: &Vector3) -> Hit {
        match &self.kind {
            Kind::Faces(faces) => faces.hit(point, &(self.side * normal), self.reach),
            Kind::Cloud(cloud) => cloud.hit(point, self.reach),
        }
    }

    /// Where on the target's file a hit is.
    pub(super) fn place(&self, hit: &Hit) -> Place {
        match &self.kind {
            Kind::Cloud(_) => Place::Point {
                row: hit.row as usize,
            },
            Kind::Faces(faces) => {
                let (face, corners, vertices) = faces.triangles[hit.row as usize];
                Place::Face(FacePlace {
                    face,
                    corners,
                    vertices,
                    weights: hit.weights,
                })
            }
        }
    }

    /// The unit normal of the target at a hit, on the side that the source's faces turn to; none where it is not known.
    pub(super) fn normal(&self, hit: &Hit) -> Option<Vector3> {
        let normal = match &self.kind {
            Kind::Cloud(cloud) => cloud.normals[hit.row as usize],
            Kind::Faces(faces) => {
                let (_, _, vertices) = faces.triangles[hit.row as usize];
                let weighted = vertices.iter().zip(hit.weights);
                weighted
                    .map(|(&v, weight)| faces.normals[v as usize] * weight)
                    .sum()
            }
        };
        (self.side * normal).try_normalize(f64::MIN_POSITIVE)
    }
}

impl Faces {
    fn new(target: &Target) -> Result<Self, TopologyError> {
        let soup = target.soup();
        let (mesh, positions) = soup.clone().into_halfedge()?;
        let triangulation = Triangulation::new(&mesh, &positions);
        let judged = target.judged();
        let corners: Vec<[Point3; 3]> = triangulation.corners(&positions).collect();
        let centres: Vec<Point3> = corners
            .iter()
            .map(|t| Point3::from(t.iter().map(|p| p.coords / 3.0).sum::<Vector3>()))
            .collect();
        let nearest = judged.closest_points(&centres);
        let near = (ON_SURFACE * judged.bounds().longest_side()).powi(2);
        let kept = (0..corners.len()).filter(|&t| nearest[t].distance_squared <= near);

        let (mut triangles, mut kept_corners, mut facing) = (Vec::new(), Vec::new(), Vec::new());
        for t in kept {
            let face = triangulation.parent(t).index();
            let vertices = triangulation.triangles()[t].map(|v| v.index() as u32);
            let Some(in_face) = corners_in_face(&soup.faces[face], vertices) else {
                continue;
            };
            triangles.push((face, in_face, vertices));
            kept_corners.push(corners[t]);
            facing.push(judged.normal(&nearest[t].location).unwrap_or_default());
        }
        let weld = soup.weld(0.0);
        let mut sums = vec![Vector3::zeros(); weld.soup.positions.len()];
        for ((_, _, vertices), (corners, facing)) in
            triangles.iter().zip(kept_corners.iter().zip(&facing))
        {
            let area = area_vector(*corners);
            let area = if area.dot(facing) < 0.0 { -area } else { area };
            for &v in vertices {
                sums[weld.row_of[v as usize] as usize] += area;
            }
        }
        let unit = |n: Vector3| n.try_normalize(f64::MIN_POSITIVE).unwrap_or_default();
        let units: Vec<Vector3> = sums.into_iter().map(unit).collect();
        Ok(Self {
            bvh: TriangleBvh::new(kept_corners),
            triangles,
            facing,
            normals: weld.spread(&units),
            is_oriented: judged.normal_sign() == NormalSign::Oriented,
        })
    }

    /// Whether source and target turn their faces to the same side, by the most of the source's vertices.
    fn side(&self, draped: &Positions, normals: &[Vector3]) -> f64 {
        let hits = self.bvh.closest_points(draped.as_slice());
        let agreement: f64 = hits
            .iter()
            .zip(normals)
            .map(|(hit, normal)| self.facing[hit.location.row() as usize].dot(normal))
            .sum();
        if agreement < 0.0 {
            -1.0
        } else {
            1.0
        }
    }

    /// Whether a triangle looks the way of a normal, as far as that is known.
    fn is_facing(&self, row: u32, normal: &Vector3) -> bool {
        !self.is_oriented || self.facing[row as usize].dot(normal) >= 0.0
    }

    fn hit(&self, point: &Point3, normal: &Vector3, reach: f64) -> Hit {
        let ways = [*normal, -normal].map(|way| self.along(point, &way, normal, reach));
        let nearer = ways
            .into_iter()
            .flatten()
            .min_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((_, hit)) = nearer {
            return hit;
        }
        let within = |hit: &mesh_core::SurfacePoint| hit.distance_squared <= reach * reach;
        let facing = self
            .bvh
            .closest_point_where(point, |row| self.is_facing(row, normal))
            .filter(within);
        let any = || self.bvh.closest_point(point);
        facing.or_else(any).map_or(
            Hit {
                row: 0,
                weights: [1.0, 0.0, 0.0],
                point: *point,
                is_near: false,
            },
            |found| Hit {
                is_near: within(&found),
                row: found.location.row(),
                weights: weights(&found.location),
                point: found.point,
            },
        )
    }

    /// The first side that looks the way of `normal` along a ray, with its distance; none within reach.
    fn along(
        &self,
        from: &Point3,
        way: &Vector3,
        normal: &Vector3,
        reach: f64,
    ) -> Option<(f64, Hit)> {
        let mut gone = 0.0;
        for _ in 0..MOST_CROSSINGS {
            let hit = self.bvh.first_hit(&(from + way * gone), way)?;
            gone += hit.distance;
            if gone > reach {
                return None;
            }
            if self.is_facing(hit.location.row(), normal) {
                let found = Hit {
                    row: hit.location.row(),
                    weights: weights(&hit.location),
                    point: hit.point,
                    is_near: true,
                };
                return Some((gone, found));
            }
            gone += reach * ON_SURFACE.sqrt();
        }
        None
    }
}

impl Cloud {
    fn new(target: &Target) -> Result<Self, TopologyError> {
        let points = PointCloud::new(target.vertices().to_vec(), None)?;
        let judged = target.judged();
        let normals = judged
            .closest_points(target.vertices())
            .par_iter()
            .map(|hit| judged.normal(&hit.location).unwrap_or_default())
            .collect();
        Ok(Self { points, normals })
    }

    fn hit(&self, point: &Point3, reach: f64) -> Hit {
        let found = self.points.closest_point(point);
        Hit {
            row: found.location.row(),
            weights: [1.0, 0.0, 0.0],
            point: found.point,
            is_near: found.distance_squared <= reach * reach,
        }
    }
}

fn weights(location: &Location) -> [f64; 3] {
    match location {
        Location::Triangle { barycentric, .. } => *barycentric,
        Location::Point { .. } => [1.0, 0.0, 0.0],
    }
}
