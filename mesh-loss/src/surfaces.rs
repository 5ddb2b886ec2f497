//! The closest points of one resampling, in both directions, and which of them count.

use mesh_core::measure::triangle_normal;
use mesh_core::sampling::TrianglePlace;
use mesh_core::{
    is_on_side, Location, NormalSign, Point3, Positions, SurfaceSample, TargetSurface, TriangleBvh,
    TriangleFans, Triangulation, UnitFrame, Vector3, VertexData, VertexId,
};
use rayon::prelude::*;

use crate::boundary::Boundary;
use crate::matches::{SamplingConfig, SurfaceMatch};

/// The way to the target and back may end a little farther from where it began than [`SamplingConfig::mutual`] says, in
/// longest sides: the sliding of a surface that fits.
const MUTUAL_NEAR: f64 = 0.003;
/// Pairs whose attraction is below this do not count.
const LEAST_ATTRACTION: f64 = 1e-6;

/// A row that no shape has.
pub(crate) const NO_HINT: u32 = u32::MAX;

/// Both surfaces as one resampling sees them, and which of their pairs count.
pub(crate) struct Surfaces<'a> {
    pub(crate) triangulation: &'a Triangulation,
    pub(crate) x: &'a Positions,
    pub(crate) target: &'a dyn TargetSurface,
    pub(crate) frame: UnitFrame,
    pub(crate) bvh: &'a TriangleBvh,
    pub(crate) fans: &'a TriangleFans,
    pub(crate) boundary: &'a Boundary,
    pub(crate) attraction: Option<&'a VertexData<f64>>,
    pub(crate) config: &'a SamplingConfig,
}

/// So many queries are one piece of parallel work.
const CHUNK: usize = 256;

impl Surfaces<'_> {
    /// The closest point of the target to each place of the mesh; none beyond the target.
    ///
    /// `hints` has a row of the target for each place, and holds afterwards the rows that were hit. What `pairs` held is
    /// lost, its room used again.
    pub(crate) fn match_places(
        &self,
        places: &[TrianglePlace],
        hints: &mut [u32],
        pairs: &mut Vec<Option<SurfaceMatch>>,
    ) {
        let queries = places.par_iter().zip(hints).with_min_len(CHUNK);
        let found = queries.map(|(&(t, w), hint)| {
            let [a, b, c] = self.triangulation.triangles()[t].map(|v| self.x[v].coords);
            let place = Point3::from(a * w[0] + b * w[1] + c * w[2]);
            let query = self.frame.from_unit(&place);
            let hit = self.target.closest_point_from(&query, *hint);
            *hint = hit.location.row();

            let is_on_boundary = self.target.is_on_boundary(&hit.location);
            if is_on_boundary && self.config.overlap.mesh_exceeds {
                return None;
            }
            let pair = self.pair(t, w, self.frame.to_unit(&hit.point), &hit.location)?;
            let is_lost = self.config.overlap.mesh_exceeds && !self.is_mutual(&place, &pair.point);
            (!is_lost).then_some(SurfaceMatch {
                is_on_boundary,
                ..pair
            })
        });
        found.collect_into_vec(pairs);
    }

    /// The closest place of the mesh to each sample of the target; none beyond the mesh.
    ///
    /// `hints` has a triangle of the mesh for each sample, and holds afterwards those that were hit. What `pairs` held is
    /// lost, its room used again.
    pub(crate) fn match_samples(
        &self,
        samples: &[SurfaceSample],
        hints: &mut [u32],
        pairs: &mut Vec<Option<SurfaceMatch>>,
    ) {
        let queries = samples.par_iter().zip(hints).with_min_len(CHUNK);
        let found = queries.map(|(sample, hint)| {
            let point = self.frame.to_unit(&sample.point);
            let Location::Triangle { index, barycentric } =
                self.bvh.closest_point_from(&point, *hint)?.location
            else {
                return None;
            };
            *hint = index;

            let t = index as usize;
            let is_on_boundary = self.boundary.holds(t, barycentric);
            if is_on_boundary && self.config.overlap.target_exceeds {
                return None;
            }
            let mut pair = self.pair(t, barycentric, point, &sample.location)?;
            if is_on_side(&barycentric) {
                pair.normal = None;
            }
            Some(SurfaceMatch {
                is_on_boundary,
                ..pair
            })
        });
        found.collect_into_vec(pairs);
    }

    /// Unit normal of the mesh at a place, a mean where triangles meet.
    fn own_normal(&self, t: usize, barycentric: &[f64; 3]) -> Option<Vector3> {
        let triangles = self.triangulation.triangles();
        let corners = |row: u32| triangles[row as usize].map(|v| self.x[v]);
        let normal = |row: u32| triangle_normal(corners(row));
        self.fans
            .normal(t as u32, barycentric, true, corners, normal)
    }

    /// Whether the closest place of the mesh to `point`, which is the closest of the target to `place`, is near `place`.
    ///
    /// The back of a leg that was scanned from the front is near the scan, too; what is closest to the scan is the front.
    fn is_mutual(&self, place: &Point3, point: &Point3) -> bool {
        let limit = self.config.mutual * (place - point).norm() + MUTUAL_NEAR;
        let back = self.bvh.closest_point(point);
        back.is_some_and(|back| (back.point - place).norm() <= limit)
    }

    /// How strongly the place of a triangle is attracted.
    fn attraction(&self, triangle: &[VertexId; 3], barycentric: &[f64; 3]) -> f64 {
        self.attraction.map_or(1.0, |attraction| {
            let corners = triangle.iter().zip(barycentric);
            corners.map(|(&v, w)| attraction[v] * w).sum()
        })
    }

    /// A pair as far as it counts: none where the mesh is not attracted, or turns its back on a target that is a part.
    fn pair(
        &self,
        t: usize,
        barycentric: [f64; 3],
        point: Point3,
        at: &Location,
    ) -> Option<SurfaceMatch> {
        let triangle = self.triangulation.triangles()[t];
        let attraction = self.attraction(&triangle, &barycentric);
        if attraction <= LEAST_ATTRACTION {
            return None;
        }
        let own = self.own_normal(t, &barycentric);
        let mut normal = self.target.normal(at);
        if let (NormalSign::Unoriented, Some(n), Some(m)) =
            (self.target.normal_sign(), normal.as_mut(), own)
        {
            if n.dot(&m) < 0.0 {
                *n = -*n;
            }
        }
        let agreement = own.zip(normal).map_or(0.0, |(n, m)| n.dot(&m));
        if agreement < 0.0 && self.config.overlap.mesh_exceeds {
            return None;
        }
        let weight = match self.config.normal_bias {
            Some(bias) => (agreement + bias).clamp(0.05, 1.0),
            None => 1.0,
        };
        Some(SurfaceMatch {
            triangle,
            barycentric,
            point,
            normal,
            weight: attraction * weight,
            is_on_boundary: false,
        })
    }
}
