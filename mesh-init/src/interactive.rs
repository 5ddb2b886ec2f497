//! The initial deformation again and again, while landmarks are dragged.

use mesh_core::{
    Aabb, Landmark, LandmarkKind, MeshPoint, Point3, Positions, Proxy, Triangulation, UnitFrame,
    Vector3,
};
use mesh_operators::SpaceExtension;
use rayon::prelude::*;

use crate::affine::{fit_affine, AffineFit, FramePair};
use crate::deformer::{Deformer, Pull, Strength};
use crate::initialize::{check_landmarks, check_length, point_pairs, targets};
use crate::{InitConfig, InitError, Initial};

/// The affine map under the deformation stays until that of the landmarks would move a corner of the source's box by
/// more than this share of its longest side.
const MAX_DRIFT: f64 = 0.05;
/// What a stand-in misses is not mended where it is less than this share of the longest side.
const MIN_MISS: f64 = 1e-9;
/// Landmarks that count at most where it is mended.
const MAX_CENTRES: usize = 200;

/// [`initialize`](crate::initialize) and [`adjust`](crate::adjust) for one source and landmarks that are dragged.
///
/// A source of many vertices is deformed as a stand-in of few ([`Proxy`]), which carries it; a landmark that lies between
/// the vertices of the stand-in is met through a small field over space. While landmarks stay where they are on the
/// source, only their targets differ: the factored systems are kept, and a solve is a few back-substitutions. Otherwise
/// the systems of the stand-in are factored anew; the stand-in itself is made once.
///
/// The affine map is kept along with the systems, up to a drift of 5 % of the longest side, so that the shape does not
/// swim under the landmark that is dragged. Where nothing is kept, a source that is its own stand-in gets what
/// `initialize` gives, to rounding. Source: Mesh Draping, Interactive Mode. Departures: the stand-in.
///
/// ```
/// use mesh_core::{shapes, Landmark, Point3, Triangulation, UnitFrame, VertexId};
/// use mesh_init::{InitConfig, InteractiveInit};
/// let (mesh, rest) = shapes::quad_sphere(24).into_halfedge()?;
/// let triangulation = Triangulation::new(&mesh, &rest);
/// let mut interactive = InteractiveInit::new(&triangulation, &rest, 500, InitConfig::standard())?;
/// let mut landmarks = [0, 80, 400, 1000, 2000].map(VertexId::new).map(|v| Landmark::new(v, rest[v]));
/// for step in 0..5 {
///     landmarks[0].target.z += 0.02 * f64::from(step);
///     let shape = interactive.solve(&landmarks, UnitFrame::principal(rest.as_slice()))?.positions;
///     assert!((shape[VertexId::new(0)] - landmarks[0].target).norm() < 0.02);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct InteractiveInit {
    /// What is deformed: the stand-in, or the source itself.
    triangulation: Triangulation,
    proxy: Option<Proxy>,
    rest: Positions,
    bounds: Aabb,
    frame: UnitFrame,
    config: InitConfig,
    kept: Option<Kept>,
}

/// Systems that are factored, and for what.
#[derive(Clone, Debug)]
struct Kept {
    places: Vec<(MeshPoint, LandmarkKind, Strength)>,
    /// The affine map that placed the source; none where a shape was given.
    affine: Option<AffineFit>,
    /// The source, placed.
    placed: Positions,
    deformer: Deformer,
}

impl InteractiveInit {
    /// Prepares a source; one of more than `max_vertices` gets a stand-in of about so many, which takes longest.
    ///
    /// # Errors
    /// A source that needs a stand-in has no face, or a coordinate that is not finite.
    ///
    /// # Panics
    /// If the triangulation names a vertex without a position.
    pub fn new(
        triangulation: &Triangulation,
        rest: &Positions,
        max_vertices: usize,
        config: InitConfig,
    ) -> Result<Self, InitError> {
        let is_dense = rest.len() > max_vertices;
        let proxy = is_dense.then(|| Proxy::new(triangulation, rest, max_vertices, &[]));
        let triangulation = match &proxy {
            None => triangulation.clone(),
            Some(proxy) => {
                let (mesh, rest) = proxy.soup().clone().into_halfedge()?;
                Triangulation::new(&mesh, &rest)
            }
        };
        Ok(Self {
            triangulation,
            proxy,
            bounds: Aabb::of(rest.iter()),
            frame: UnitFrame::principal(rest.as_slice()),
            rest: rest.clone(),
            config,
            kept: None,
        })
    }

    /// The source brought to its landmarks, as by [`initialize`](crate::initialize).
    ///
    /// # Errors
    /// A landmark that is out of range or not finite, or a deformation that cannot be solved for.
    pub fn solve(
        &mut self,
        landmarks: &[Landmark],
        target_frame: UnitFrame,
    ) -> Result<Initial, InitError> {
        check_landmarks(self.rest.len(), landmarks)?;
        let landmarks = &Landmark::followed(landmarks)[..];
        let frames = FramePair {
            source: self.frame,
            target: target_frame,
        };
        let pairs = point_pairs(landmarks, &self.rest);
        let fresh = fit_affine(&pairs, frames, self.config.prior);
        let is_near = |kept: &Kept| {
            let affine = kept.affine.as_ref();
            affine
                .is_some_and(|a| kept.has(landmarks) && drift(a, &fresh, &self.bounds) <= MAX_DRIFT)
        };
        let kept = match self.kept.take().filter(is_near) {
            Some(kept) => kept,
            None => {
                let placed = self.rest.map(|p| fresh.apply(p));
                self.prepared(landmarks, placed, Some(fresh), self.config)?
            }
        };
        let positions = self.deformed(&kept, landmarks)?;
        let n_extrapolated = kept.deformer.n_extrapolated();
        let affine = kept.affine.clone().map(|map| AffineFit {
            residuals: residuals(&map, landmarks, &self.rest),
            ..map
        });
        self.kept = Some(kept);
        Ok(Initial {
            positions,
            affine: affine.expect("what was placed by a map has one"),
            n_extrapolated,
        })
    }

    /// The shape `present` of the source deformed further, as by [`adjust`](crate::adjust).
    ///
    /// # Errors
    /// As [`InteractiveInit::solve`]; or there is not one position for each vertex.
    pub fn adjust(
        &mut self,
        landmarks: &[Landmark],
        present: &Positions,
    ) -> Result<Positions, InitError> {
        check_length(self.rest.len(), present)?;
        check_landmarks(self.rest.len(), landmarks)?;
        let landmarks = &Landmark::followed(landmarks)[..];
        let is_same =
            |kept: &Kept| kept.affine.is_none() && kept.has(landmarks) && kept.placed == *present;
        let kept = match self.kept.take().filter(is_same) {
            Some(kept) => kept,
            None => self.prepared(landmarks, present.clone(), None, InitConfig::paper())?,
        };
        let positions = self.deformed(&kept, landmarks)?;
        self.kept = Some(kept);
        Ok(positions)
    }

    /// Factors the systems for the source at `placed`.
    fn prepared(
        &self,
        landmarks: &[Landmark],
        placed: Positions,
        affine: Option<AffineFit>,
        config: InitConfig,
    ) -> Result<Kept, InitError> {
        let pull = |l: &Landmark| {
            let mut vertex = l.source.main_vertex();
            let mut held = vertex;
            if let Some(proxy) = &self.proxy {
                vertex = proxy.place_of(vertex).main_vertex();
                held = proxy.vertices()[vertex.index()];
            }
            Pull {
                vertex,
                offset: placed[held] - l.source.position(&placed),
                kind: l.kind,
                strength: Strength::of(l),
            }
        };
        let pulls: Vec<Pull> = landmarks.iter().map(pull).collect();
        let triangulation = self.triangulation.clone();
        let deformer = match &self.proxy {
            None => Deformer::new(triangulation, &placed, pulls, &config)?,
            Some(proxy) => {
                let coarse = proxy.vertices().iter().map(|&v| placed[v]).collect();
                Deformer::new(triangulation, &coarse, pulls, &config)?
            }
        };
        Ok(Kept {
            places: places(landmarks).collect(),
            affine,
            placed,
            deformer,
        })
    }

    fn deformed(&self, kept: &Kept, landmarks: &[Landmark]) -> Result<Positions, InitError> {
        let targets = targets(landmarks);
        let x = kept.deformer.solve(&targets)?;
        let Some(proxy) = &self.proxy else {
            return Ok(x);
        };
        // Soft landmarks may be missed, but not by more than the stand-in misses them.
        let allowed = kept.deformer.misses(&targets, &x);
        let mut carried = proxy.carry(&kept.placed, &x);
        let from: Vec<Point3> = landmarks
            .iter()
            .map(|l| l.source.position(&carried))
            .collect();
        let missed = targets.iter().zip(&from).zip(&allowed);
        let missed: Vec<Vector3> = missed.map(|((t, p), allowed)| t - p - allowed).collect();
        let least = MIN_MISS * kept.deformer.size();
        if missed.iter().any(|m| m.norm() > least) {
            let field = SpaceExtension::new(&from, &missed, MAX_CENTRES)?;
            carried
                .as_mut_slice()
                .par_iter_mut()
                .for_each(|p| *p += field.displacement_at(p));
        }
        Ok(carried)
    }
}

impl Kept {
    /// Whether the landmarks are at the places that the systems were factored for.
    fn has(&self, landmarks: &[Landmark]) -> bool {
        self.places.iter().copied().eq(places(landmarks))
    }
}

fn places(
    landmarks: &[Landmark],
) -> impl Iterator<Item = (MeshPoint, LandmarkKind, Strength)> + '_ {
    landmarks
        .iter()
        .map(|l| (l.source, l.kind, Strength::of(l)))
}

/// Distance of each landmark to its place after the map.
fn residuals(map: &AffineFit, landmarks: &[Landmark], rest: &Positions) -> Vec<f64> {
    let miss = |l: &Landmark| (map.apply(&l.source.position(rest)) - l.target).norm();
    landmarks.iter().map(miss).collect()
}

/// How far apart two maps take a corner of the box at most, in longest sides of the box where the first takes it.
fn drift(one: &AffineFit, other: &AffineFit, bounds: &Aabb) -> f64 {
    let corners: Vec<Point3> = (0..8)
        .map(|k| {
            let end = |axis: usize| [bounds.min, bounds.max][k >> axis & 1][axis];
            Point3::new(end(0), end(1), end(2))
        })
        .collect();
    let placed: Vec<Point3> = corners.iter().map(|p| one.apply(p)).collect();
    let apart = corners.iter().zip(&placed);
    let apart = apart.map(|(p, q)| (other.apply(p) - q).norm());
    apart.fold(0.0, f64::max) / Aabb::of(placed.iter()).longest_side()
}
