//! Random places on both surfaces and their closest points on the other: what the distance terms look at.

use mesh_core::measure::{triangle_area, triangle_normal};
use mesh_core::sampling::{TrianglePlace, TriangleSampler};
use mesh_core::{
    is_on_side, Location, NormalSign, Point3, Positions, Profile, SurfaceSample, TargetSurface,
    TriangleBvh, TriangleFans, Triangulation, UnitFrame, Vector3, VertexData, VertexId, ON_SIDE,
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
    /// Unit normal of the target there, turned to the mesh's side where its sign means nothing; none where the place is
    /// the one closest to a target point and on an edge of the mesh, where no triangle is to be turned more than others.
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
    fans: TriangleFans,
    boundary: Boundary,
    by_face: TriangleSampler,
    hints: Hints,
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
            fans: TriangleFans::new(triangulation.rows()),
            boundary: Boundary::new(triangulation, x.len()),
            by_face: TriangleSampler::new(std::iter::repeat_n(1.0, triangulation.len())),
            hints: Hints::default(),
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
        let places = profile.time("sampling", || self.sample_mesh(x, config, rng));
        let samples = profile.time("sampling", || self.target.sample(config.n_samples, rng));
        self.hints.of_places.resize(places.len(), NO_HINT);
        self.hints.of_samples.resize(samples.len(), NO_HINT);
        let side = Side {
            triangulation: self.triangulation,
            x,
            target: self.target,
            frame: self.frame,
            fans: &self.fans,
            boundary: &self.boundary,
            config,
        };
        let (hints, hard) = (&mut self.hints, &mut self.hard);
        let to_target = profile.time("closest on target", || {
            side.match_places(&places, &mut hints.of_places)
        });
        let to_mesh = profile.time("closest on mesh", || {
            side.match_samples(&samples, &self.bvh, &mut hints.of_samples)
        });
        Matches {
            to_target: to_target.into_iter().flatten().collect(),
            to_mesh: to_mesh.into_iter().flatten().collect(),
            hard_to_target: profile.time("worst places", || hard.match_mesh(&side, rng)),
            hard_to_mesh: profile.time("worst places", || hard.match_target(&self.bvh, &side, rng)),
        }
    }

    /// Random places on the mesh: some by area, some by face.
    fn sample_mesh(
        &self,
        x: &Positions,
        config: &SamplingConfig,
        rng: &mut dyn RngCore,
    ) -> Vec<TrianglePlace> {
        let n_by_face = (config.n_samples as f64 * config.face_uniform).round() as usize;
        let n_by_area = config.n_samples.saturating_sub(n_by_face);
        let areas = self.triangulation.corners(x).map(triangle_area);
        let mut places = self.by_face.sample(n_by_face, rng);
        places.extend(TriangleSampler::new(areas).sample(n_by_area, rng));
        places
    }
}

/// What was hit last time: the k-th sample is always drawn near the same place, so it is close to what comes next.
#[derive(Default)]
struct Hints {
    of_places: Vec<u32>,
    of_samples: Vec<u32>,
}

/// A row that no shape has.
pub(crate) const NO_HINT: u32 = u32::MAX;

/// What both directions of one resampling need.
pub(crate) struct Side<'a> {
    triangulation: &'a Triangulation,
    pub(crate) x: &'a Positions,
    pub(crate) target: &'a dyn TargetSurface,
    frame: UnitFrame,
    fans: &'a TriangleFans,
    boundary: &'a Boundary,
    pub(crate) config: &'a SamplingConfig,
}

/// So many queries are one piece of parallel work.
const CHUNK: usize = 256;

impl Side<'_> {
    /// The closest point of the target to each place of the mesh; none beyond the target.
    ///
    /// `hints` has a row of the target for each place, and holds afterwards the rows that were hit.
    pub(crate) fn match_places(
        &self,
        places: &[TrianglePlace],
        hints: &mut [u32],
    ) -> Vec<Option<SurfaceMatch>> {
        let queries = places.par_iter().zip(hints).with_min_len(CHUNK);
        let pairs = queries.map(|(&(t, w), hint)| {
            let [a, b, c] = self.triangulation.triangles()[t].map(|v| self.x[v].coords);
            let place = Point3::from(a * w[0] + b * w[1] + c * w[2]);
            let query = self.frame.from_unit(&place);
            let hit = self.target.closest_point_from(&query, *hint);
            *hint = hit.location.row();

            let is_on_rim = self.target.is_on_boundary(&hit.location);
            let pair = self.pair(t, w, self.frame.to_unit(&hit.point), &hit.location);
            (!(is_on_rim && self.config.overlap.mesh_exceeds))
                .then_some(SurfaceMatch { is_on_rim, ..pair })
        });
        pairs.collect()
    }

    /// The closest place of the mesh to each sample of the target; none beyond the mesh.
    ///
    /// `hints` has a triangle of the mesh for each sample, and holds afterwards those that were hit.
    pub(crate) fn match_samples(
        &self,
        samples: &[SurfaceSample],
        bvh: &TriangleBvh,
        hints: &mut [u32],
    ) -> Vec<Option<SurfaceMatch>> {
        let queries = samples.par_iter().zip(hints).with_min_len(CHUNK);
        let pairs = queries.map(|(sample, hint)| {
            let point = self.frame.to_unit(&sample.point);
            let Location::Triangle { index, barycentric } =
                bvh.closest_point_from(&point, *hint)?.location
            else {
                return None;
            };
            *hint = index;

            let t = index as usize;
            let is_on_rim = self.boundary.holds(t, barycentric);
            let mut pair = self.pair(t, barycentric, point, &sample.location);
            if is_on_side(&barycentric) {
                pair.normal = None;
            }
            (!(is_on_rim && self.config.overlap.target_exceeds))
                .then_some(SurfaceMatch { is_on_rim, ..pair })
        });
        pairs.collect()
    }

    /// Unit normal of the mesh at a place, a mean where triangles meet.
    fn own_normal(&self, t: usize, barycentric: &[f64; 3]) -> Option<Vector3> {
        let triangles = self.triangulation.triangles();
        let corners = |row: u32| triangles[row as usize].map(|v| self.x[v]);
        let normal = |row: u32| triangle_normal(corners(row));
        self.fans
            .normal(t as u32, barycentric, true, corners, normal)
    }

    fn pair(&self, t: usize, barycentric: [f64; 3], point: Point3, at: &Location) -> SurfaceMatch {
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
