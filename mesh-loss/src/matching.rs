//! Random places on both surfaces and their closest points on the other: what the distance terms look at.

use mesh_core::sampling::{TrianglePlace, TriangleSampler};
use mesh_core::{
    Location, NormalSign, Point3, Positions, Profile, SurfaceSample, TargetSurface, TriangleBvh,
    Triangulation, UnitFrame, Vector3, VertexData, VertexId,
};
use rand::RngCore;
use rayon::prelude::*;

use crate::hard_places::{HardCorners, HardPlaces};

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
    /// Whether the sample's closest point lies on an open boundary of the other surface.
    pub is_on_rim: bool,
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
    /// Corners of the mesh that are far off, with their closest points; for [`crate::WorstDistance`] alone.
    pub hard_to_target: Vec<SurfaceMatch>,
    /// Corners of the target that are far off, with their closest places; for [`crate::WorstDistance`] alone.
    pub hard_to_mesh: Vec<SurfaceMatch>,
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
    /// How many corners of each shape are kept in mind as far off; as many others are looked at anew each time.
    pub n_hard: usize,
    /// Which pairs at open boundaries are left out.
    pub overlap: Overlap,
}

/// Which surface reaches beyond the other. A place beyond has its closest point on the other's open boundary, and
/// must not be pulled there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Overlap {
    /// The target reaches beyond the mesh: its samples whose closest place is on the mesh's boundary are left out.
    pub target_exceeds: bool,
    /// The mesh reaches beyond the target: its samples whose closest point is on the target's boundary are left out.
    pub mesh_exceeds: bool,
}

/// How much of each surface lies beyond the other, from [`SurfaceMatcher::beyond`]; shares in 0..=1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beyond {
    /// Share of the target's area beyond the mesh.
    pub of_target: f64,
    /// Share of the mesh's area beyond the target.
    pub of_mesh: f64,
}

/// Draws samples on a moving mesh and on its target and matches each with its closest point.
///
/// The mesh lives in `frame`, the target in its own coordinates; matches are in `frame`.
pub struct SurfaceMatcher<'a> {
    triangulation: &'a Triangulation,
    target: &'a dyn TargetSurface,
    frame: UnitFrame,
    bvh: TriangleBvh,
    boundary: Boundary,
    hard: HardPlaces,
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
            boundary: Boundary::new(triangulation, x.len()),
            hard: HardPlaces::new(triangulation, x.len(), target),
        }
    }

    /// How much of each surface lies beyond the other, as a share of `n_samples` random places on each: their closest
    /// point is on the other's open boundary, and farther than `distance`.
    pub fn beyond(
        &mut self,
        x: &Positions,
        n_samples: usize,
        distance: f64,
        rng: &mut dyn RngCore,
    ) -> Beyond {
        let config = SamplingConfig {
            n_samples,
            face_uniform: 0.0,
            normal_bias: None,
            n_hard: 0,
            overlap: Overlap::default(),
        };
        let all = self.resample(x, &config, rng, &mut Profile::off());
        let share = |matches: &[SurfaceMatch]| {
            let n_beyond = matches
                .iter()
                .filter(|m| m.is_on_rim && m.offset(x).norm() > distance)
                .count();
            n_beyond as f64 / matches.len().max(1) as f64
        };
        Beyond {
            of_target: share(&all.to_mesh),
            of_mesh: share(&all.to_target),
        }
    }

    /// The corners that are kept in mind.
    pub fn hard_corners(&self) -> &HardCorners {
        self.hard.kept()
    }

    /// Keeps these corners in mind instead, to go on as an earlier matcher of the same shapes would; whether they are
    /// corners of these shapes. If not, nothing changes.
    pub fn set_hard_corners(&mut self, corners: HardCorners) -> bool {
        self.hard.keep(corners)
    }

    /// Fresh samples of both surfaces, matched with the mesh at `x`; `profile` tells what it took.
    pub fn resample(
        &mut self,
        x: &Positions,
        config: &SamplingConfig,
        rng: &mut dyn RngCore,
        profile: &mut Profile,
    ) -> Matches {
        profile.time("refit", || self.bvh.refit(self.triangulation.corners(x)));
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
            boundary: &self.boundary,
            config,
        };
        Matches {
            to_target: side.to_target(x, rng, profile),
            to_mesh: side.to_mesh(&self.bvh, rng, profile),
            hard_to_target: profile.time("worst places", || self.hard.match_mesh(x, &side, rng)),
            hard_to_mesh: profile.time("worst places", || {
                self.hard.match_target(x, &self.bvh, &side, rng)
            }),
        }
    }
}

/// What both directions of one resampling need.
pub(crate) struct Side<'a> {
    triangulation: &'a Triangulation,
    pub(crate) target: &'a dyn TargetSurface,
    frame: UnitFrame,
    normals: &'a [Option<Vector3>],
    boundary: &'a Boundary,
    pub(crate) config: &'a SamplingConfig,
}

impl Side<'_> {
    fn to_target(
        &self,
        x: &Positions,
        rng: &mut dyn RngCore,
        profile: &mut Profile,
    ) -> Vec<SurfaceMatch> {
        let places = profile.time("sampling", || {
            sample_mesh(self.triangulation, x, self.config, rng)
        });
        let pairs = profile.time("closest on target", || self.match_places(&places, x));
        pairs.into_iter().flatten().collect()
    }

    fn to_mesh(
        &self,
        bvh: &TriangleBvh,
        rng: &mut dyn RngCore,
        profile: &mut Profile,
    ) -> Vec<SurfaceMatch> {
        let n = self.config.n_samples;
        let samples = profile.time("sampling", || self.target.sample(n, rng));
        let pairs = profile.time("closest on mesh", || self.match_samples(&samples, bvh));
        pairs.into_iter().flatten().collect()
    }

    /// The closest point of the target to each place of the mesh at `x`; none beyond the target.
    pub(crate) fn match_places(
        &self,
        places: &[TrianglePlace],
        x: &Positions,
    ) -> Vec<Option<SurfaceMatch>> {
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
            .map(|(&(t, w), hit)| {
                let is_on_rim = self.target.is_on_boundary(&hit.location);
                let pair = self.pair(t, w, self.frame.to_unit(&hit.point), &hit.location);
                (!(is_on_rim && self.config.overlap.mesh_exceeds))
                    .then_some(SurfaceMatch { is_on_rim, ..pair })
            })
            .collect()
    }

    /// The closest place of the mesh to each sample of the target; none beyond the mesh.
    pub(crate) fn match_samples(
        &self,
        samples: &[SurfaceSample],
        bvh: &TriangleBvh,
    ) -> Vec<Option<SurfaceMatch>> {
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
            .map(|((sample, point), hit)| {
                let Location::Triangle { index, barycentric } = hit.location else {
                    return None;
                };
                let t = index as usize;
                let is_on_rim = self.boundary.holds(t, barycentric);
                let pair = self.pair(t, barycentric, *point, &sample.location);
                (!(is_on_rim && self.config.overlap.target_exceeds))
                    .then_some(SurfaceMatch { is_on_rim, ..pair })
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
            is_on_rim: false,
        }
    }
}

/// The open boundary of the mesh.
struct Boundary {
    triangles: Vec<[VertexId; 3]>,
    is_vertex: VertexData<bool>,
    /// Whether the side opposite to each corner belongs to no other triangle.
    is_side: Vec<[bool; 3]>,
}

/// A barycentric weight below this is on the side opposite to its corner.
const ON_SIDE: f64 = 1e-9;

impl Boundary {
    fn new(triangulation: &Triangulation, n_vertices: usize) -> Self {
        let triangles = triangulation.triangles().to_vec();
        let side = |t: &[VertexId; 3], k: usize| {
            let (a, b) = (t[(k + 1) % 3], t[(k + 2) % 3]);
            (a.min(b), a.max(b))
        };
        let mut sides: Vec<_> = triangles
            .iter()
            .flat_map(|t| [0, 1, 2].map(|k| side(t, k)))
            .collect();
        sides.sort_unstable();
        let is_single = |s: &(VertexId, VertexId)| {
            let first = sides.partition_point(|other| other < s);
            sides.get(first + 1) != Some(s)
        };
        let is_side: Vec<[bool; 3]> = triangles
            .iter()
            .map(|t| [0, 1, 2].map(|k| is_single(&side(t, k))))
            .collect();
        let mut is_vertex = VertexData::new(n_vertices, false);
        for (t, open) in triangles.iter().zip(&is_side) {
            for k in (0..3).filter(|&k| open[k]) {
                is_vertex[t[(k + 1) % 3]] = true;
                is_vertex[t[(k + 2) % 3]] = true;
            }
        }
        Self {
            triangles,
            is_vertex,
            is_side,
        }
    }

    /// Whether the place in triangle `t` lies on the boundary.
    fn holds(&self, t: usize, barycentric: [f64; 3]) -> bool {
        (0..3).any(|k| {
            let is_on_side = self.is_side[t][k] && barycentric[k] <= ON_SIDE;
            let is_on_corner =
                self.is_vertex[self.triangles[t][k]] && barycentric[k] >= 1.0 - ON_SIDE;
            is_on_side || is_on_corner
        })
    }
}

/// Random places on the mesh: some by area, some by face.
fn sample_mesh(
    triangulation: &Triangulation,
    x: &Positions,
    config: &SamplingConfig,
    rng: &mut dyn RngCore,
) -> Vec<TrianglePlace> {
    let n_by_face = (config.n_samples as f64 * config.face_uniform).round() as usize;
    let n_by_area = config.n_samples.saturating_sub(n_by_face);
    let areas = triangulation
        .corners(x)
        .map(mesh_core::measure::triangle_area);
    let alike = std::iter::repeat_n(1.0, triangulation.len());
    let mut places = TriangleSampler::new(alike).sample(n_by_face, rng);
    places.extend(TriangleSampler::new(areas).sample(n_by_area, rng));
    places
}
