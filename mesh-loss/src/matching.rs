//! Random places on both surfaces and their closest points on the other: what the distance terms look at.

use mesh_core::{
    Location, NormalSign, Point3, Positions, TargetSurface, TriangleBvh, Triangulation, UnitFrame,
    Vector3, VertexId,
};
use rand::{Rng, RngCore};
use rayon::prelude::*;

/// A place on the moving mesh and the fixed point it is matched with.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceMatch {
    /// Corners of the triangle that holds the place.
    pub triangle: [VertexId; 3],
    /// Weights of the corners, summing to 1.
    pub barycentric: [f64; 3],
    /// The matched point of the target.
    pub point: Point3,
    /// Unit normal of the target there, turned to the mesh's side where its sign means nothing.
    pub normal: Option<Vector3>,
    /// How much the pair counts, 0..=1.
    pub weight: f64,
}

impl SurfaceMatch {
    /// From the matched target point to the place on the mesh at `x`.
    pub fn offset(&self, x: &Positions) -> Vector3 {
        let [a, b, c] = self.triangle.map(|v| x[v].coords);
        let [wa, wb, wc] = self.barycentric;
        a * wa + b * wb + c * wc - self.point.coords
    }
}

/// Matches in both directions.
#[derive(Clone, Debug, Default)]
pub struct Matches {
    /// Samples of the mesh, each with its closest point on the target.
    pub to_target: Vec<SurfaceMatch>,
    /// Samples of the target, each with its closest place on the mesh.
    pub to_mesh: Vec<SurfaceMatch>,
}

/// How samples are drawn and pairs weighted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SamplingConfig {
    /// Samples on each side.
    pub n_samples: usize,
    /// Share of the mesh's samples drawn by face instead of by area, 0..=1.
    pub face_uniform: f64,
    /// Pairs count by clamp(n·n′ + `normal_bias`, 0.05, 1); none: all pairs count 1.
    pub normal_bias: Option<f64>,
}

/// Draws samples on a moving mesh and on its target and matches each with its closest point.
///
/// The mesh lives in `frame`, the target in its own coordinates; matches are in `frame`.
pub struct SurfaceMatcher<'a> {
    triangulation: &'a Triangulation,
    target: &'a dyn TargetSurface,
    frame: UnitFrame,
    bvh: TriangleBvh,
}

impl<'a> SurfaceMatcher<'a> {
    /// A matcher for the mesh at `x`, whose coordinates are those of `frame`.
    pub fn new(
        triangulation: &'a Triangulation,
        x: &Positions,
        target: &'a dyn TargetSurface,
        frame: UnitFrame,
    ) -> Self {
        Self {
            triangulation,
            target,
            frame,
            bvh: TriangleBvh::new(triangulation.corners(x).collect()),
        }
    }

    /// Fresh samples of both surfaces, matched with the mesh at `x`.
    pub fn resample(
        &mut self,
        x: &Positions,
        config: &SamplingConfig,
        rng: &mut dyn RngCore,
    ) -> Matches {
        self.bvh.refit(self.triangulation.corners(x));
        let normals: Vec<Option<Vector3>> = self
            .triangulation
            .corners(x)
            .map(mesh_core::measure::triangle_normal)
            .collect();
        let side = Side {
            triangulation: self.triangulation,
            target: self.target,
            frame: self.frame,
            normals: &normals,
            config,
        };
        Matches {
            to_target: side.to_target(x, rng),
            to_mesh: side.to_mesh(&self.bvh, rng),
        }
    }
}

/// What both directions of one resampling need.
struct Side<'a> {
    triangulation: &'a Triangulation,
    target: &'a dyn TargetSurface,
    frame: UnitFrame,
    normals: &'a [Option<Vector3>],
    config: &'a SamplingConfig,
}

impl Side<'_> {
    fn to_target(&self, x: &Positions, rng: &mut dyn RngCore) -> Vec<SurfaceMatch> {
        let places = sample_mesh(self.triangulation, x, self.config, rng);
        let points: Vec<Point3> = places
            .iter()
            .map(|&(t, w)| {
                let [a, b, c] = self.triangulation.triangles()[t].map(|v| x[v].coords);
                self.frame
                    .from_unit(&Point3::from(a * w[0] + b * w[1] + c * w[2]))
            })
            .collect();
        let hits = self.target.closest_points(&points);
        places
            .iter()
            .zip(&hits)
            .map(|(&(t, w), hit)| self.pair(t, w, self.frame.to_unit(&hit.point), &hit.location))
            .collect()
    }

    fn to_mesh(&self, bvh: &TriangleBvh, rng: &mut dyn RngCore) -> Vec<SurfaceMatch> {
        let samples = self.target.sample(self.config.n_samples, rng);
        let points: Vec<Point3> = samples
            .iter()
            .map(|s| self.frame.to_unit(&s.point))
            .collect();
        let hits = bvh.closest_points(&points);
        samples
            .par_iter()
            .with_min_len(256)
            .zip(&points)
            .zip(&hits)
            .filter_map(|((sample, point), hit)| match hit.location {
                Location::Triangle { index, barycentric } => {
                    Some(self.pair(index as usize, barycentric, *point, &sample.location))
                }
                Location::Point { .. } => None,
            })
            .collect()
    }

    fn pair(&self, t: usize, barycentric: [f64; 3], point: Point3, at: &Location) -> SurfaceMatch {
        let own = self.normals[t];
        let mut normal = self.target.normal(at);
        if let (NormalSign::Unoriented, Some(n), Some(m)) =
            (self.target.normal_sign(), normal.as_mut(), own)
        {
            if n.dot(&m) < 0.0 {
                *n = -*n;
            }
        }
        let agreement = own.zip(normal).map_or(0.0, |(n, m)| n.dot(&m));
        SurfaceMatch {
            triangle: self.triangulation.triangles()[t],
            barycentric,
            point,
            normal,
            weight: match self.config.normal_bias {
                Some(bias) => (agreement + bias).clamp(0.05, 1.0),
                None => 1.0,
            },
        }
    }
}

/// Random places on the mesh: some by area, some by face.
fn sample_mesh(
    triangulation: &Triangulation,
    x: &Positions,
    config: &SamplingConfig,
    rng: &mut dyn RngCore,
) -> Vec<(usize, [f64; 3])> {
    if triangulation.is_empty() {
        return Vec::new();
    }
    let mut total = 0.0;
    let cumulative: Vec<f64> = triangulation
        .corners(x)
        .map(|corners| {
            total += mesh_core::measure::triangle_area(corners);
            total
        })
        .collect();
    let n_by_face = (config.n_samples as f64 * config.face_uniform).round() as usize;
    (0..config.n_samples)
        .map(|k| {
            let t = if k < n_by_face {
                rng.random_range(0..triangulation.len())
            } else {
                let a = rng.random::<f64>() * total;
                cumulative
                    .partition_point(|&c| c <= a)
                    .min(triangulation.len() - 1)
            };
            (t, random_barycentric(rng))
        })
        .collect()
}

/// Uniform over a triangle.
fn random_barycentric(rng: &mut dyn RngCore) -> [f64; 3] {
    let (r, s) = (rng.random::<f64>().sqrt(), rng.random::<f64>());
    [1.0 - r, r * (1.0 - s), r * s]
}
