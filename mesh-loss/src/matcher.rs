//! Draws random places on both surfaces and finds their closest points on the other.

use std::sync::Arc;

use mesh_core::measure::triangle_area;
use mesh_core::sampling::{SeededRng, TrianglePlace, TriangleSampler};
use mesh_core::{
    Positions, Profile, TargetSurface, TriangleBvh, Triangulation, UnitFrame, VertexData,
};

use crate::hard_places::{HardCorners, HardPlaces};
use crate::matches::{Beyond, Matches, Overlap, SamplingConfig, SurfaceMatch};
use crate::surfaces::{Surfaces, NO_HINT};

/// Draws samples on a moving mesh and on its target and matches each with its closest point.
///
/// The mesh lives in `frame`, the target in its own coordinates; matches are in `frame`.
///
/// A plane a quarter above another is a quarter from it, both ways:
///
/// ```
/// use std::sync::Arc;
/// use mesh_core::sampling::SeededRng;
/// use mesh_core::{
///     shapes, Point3, Profile, TargetSurface, TriangleSoup, Triangulation, UnitFrame, Vector3, VertexData,
/// };
/// use mesh_loss::{Chamfer, Loss, Overlap, SamplingConfig, SurfaceMatcher};
///
/// let (mesh, rest) = shapes::open_grid(4, 4).into_halfedge()?;
/// let triangulation = Arc::new(Triangulation::new(&mesh, &rest));
/// let target: Arc<dyn TargetSurface> = Arc::new(TriangleSoup::new(shapes::open_grid(4, 4))?);
/// let x = rest.map(|p| p + Vector3::z() * 0.25);
/// let frame = UnitFrame { center: Point3::origin(), scale: 1.0 };
/// let sampling = SamplingConfig {
///     n_samples: 100,
///     face_uniform: 0.5,
///     normal_bias: None,
///     n_hard: 0,
///     overlap: Overlap::default(),
///     mutual: 1.0,
/// };
///
/// let mut matcher = SurfaceMatcher::new(&triangulation, &x, &target, frame);
/// let matches = matcher.resample(&x, &sampling, &mut SeededRng::new(7), &mut Profile::off());
/// let mut gradient = VertexData::new(x.len(), Vector3::zeros());
/// let value = Chamfer(&matches).accumulate(&x, 1.0, &mut gradient);
/// assert!((value - 0.5).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct SurfaceMatcher {
    triangulation: Arc<Triangulation>,
    target: Arc<dyn TargetSurface>,
    frame: UnitFrame,
    bvh: TriangleBvh,
    by_face: TriangleSampler,
    hints: Hints,
    hard: HardPlaces,
    attraction: Option<VertexData<f64>>,
    /// Room for pairs, some of which do not count, and for those that do: fresh pages cost a tenth of a resampling.
    pairs: Vec<Option<SurfaceMatch>>,
    used: Matches,
}

impl SurfaceMatcher {
    /// A matcher for the mesh at `x`, whose coordinates are those of `frame`.
    pub fn new(
        triangulation: &Arc<Triangulation>,
        x: &Positions,
        target: &Arc<dyn TargetSurface>,
        frame: UnitFrame,
    ) -> Self {
        Self {
            triangulation: Arc::clone(triangulation),
            target: Arc::clone(target),
            frame,
            bvh: TriangleBvh::new(triangulation.corners(x).collect()),
            by_face: TriangleSampler::new(std::iter::repeat_n(1.0, triangulation.len())),
            hints: Hints::default(),
            hard: HardPlaces::new(triangulation, x.len(), target.as_ref()),
            attraction: None,
            pairs: Vec::new(),
            used: Matches::default(),
        }
    }

    /// From now on pairs count by the attraction of their place on the mesh, 0..=1 for each vertex, and not at all where
    /// it is 0.
    pub fn set_attraction(&mut self, attraction: &VertexData<f64>) {
        let is_even = attraction.iter().all(|&a| a == 1.0);
        self.attraction = (!is_even).then(|| attraction.clone());
    }

    /// The target, in its own coordinates.
    pub fn target(&self) -> &Arc<dyn TargetSurface> {
        &self.target
    }

    /// Whether the mesh ends openly anywhere.
    pub fn has_boundary(&self) -> bool {
        !self.triangulation.boundary().is_empty()
    }

    /// How much of each surface lies beyond the other, as a share of `n_samples` random places on each: their closest
    /// point is on the other's open boundary, and farther than `distance`.
    pub fn beyond(
        &mut self,
        x: &Positions,
        n_samples: usize,
        distance: f64,
        rng: &mut SeededRng,
    ) -> Beyond {
        let config = SamplingConfig {
            n_samples,
            face_uniform: 0.0,
            normal_bias: None,
            n_hard: 0,
            overlap: Overlap::default(),
            mutual: 1.0,
        };
        let all = self.resample(x, &config, rng, &mut Profile::off());
        let share = |matches: &[SurfaceMatch]| {
            let n_beyond = matches
                .iter()
                .filter(|m| m.is_on_boundary && m.offset(x).norm() > distance)
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
        rng: &mut SeededRng,
        profile: &mut Profile,
    ) -> Matches {
        profile.time("refit", || self.bvh.refit(self.triangulation.corners(x)));
        let places = profile.time("sampling", || self.sample_mesh(x, config, rng));
        let samples = profile.time("sampling", || self.target.sample(config.n_samples, rng));
        self.hints.of_places.resize(places.len(), NO_HINT);
        self.hints.of_samples.resize(samples.len(), NO_HINT);
        let surfaces = Surfaces {
            triangulation: &self.triangulation,
            x,
            target: self.target.as_ref(),
            frame: self.frame,
            bvh: &self.bvh,
            attraction: self.attraction.as_ref(),
            config,
        };
        let (hints, hard, pairs) = (&mut self.hints, &mut self.hard, &mut self.pairs);
        let Matches {
            mut to_target,
            mut to_mesh,
            ..
        } = std::mem::take(&mut self.used);
        profile.time("closest on target", || {
            surfaces.match_places(&places, &mut hints.of_places, pairs);
            refill(&mut to_target, pairs);
        });
        profile.time("closest on mesh", || {
            surfaces.match_samples(&samples, &mut hints.of_samples, pairs);
            refill(&mut to_mesh, pairs);
        });
        Matches {
            to_target,
            to_mesh,
            hard_to_target: profile.time("worst places", || hard.match_mesh(&surfaces, rng)),
            hard_to_mesh: profile.time("worst places", || hard.match_target(&surfaces, rng)),
        }
    }

    /// Takes matches that nobody needs any more: the next [`SurfaceMatcher::resample`] uses their room.
    pub fn recycle(&mut self, used: Matches) {
        self.used = used;
    }

    /// Random places on the mesh: some by area, some by face.
    fn sample_mesh(
        &self,
        x: &Positions,
        config: &SamplingConfig,
        rng: &mut SeededRng,
    ) -> Vec<TrianglePlace> {
        let n_by_face = (config.n_samples as f64 * config.face_uniform).round() as usize;
        let n_by_area = config.n_samples.saturating_sub(n_by_face);
        let areas = self.triangulation.corners(x).map(triangle_area);
        let mut places = self.by_face.sample(n_by_face, rng);
        places.extend(TriangleSampler::new(areas).sample(n_by_area, rng));
        places
    }
}

/// Those of `pairs` that count, in order.
fn refill(matches: &mut Vec<SurfaceMatch>, pairs: &[Option<SurfaceMatch>]) {
    matches.clear();
    matches.extend(pairs.iter().flatten());
}

/// What was hit last time: the k-th sample is always drawn near the same place, so it is close to what comes next.
#[derive(Default)]
struct Hints {
    of_places: Vec<u32>,
    of_samples: Vec<u32>,
}
