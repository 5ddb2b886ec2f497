//! From landmarks to the shape that draping starts at.

use mesh_core::{
    HalfedgeMesh, Landmark, LandmarkKind, Point3, Positions, Triangulation, UnitFrame, Vector3,
    VertexData, VertexId,
};
use mesh_operators::{geodesic_distance_unfolded, SpaceExtension};
use nalgebra::Matrix3;

use crate::affine::{fit_affine, AffineFit, FramePair, PointPair, SimilarityPrior};
use crate::reach::is_reached;
use crate::{biharmonic_displacement, ArapSolver, InitError, SimilarConfig, SimilarSolver};

/// Rigid landmarks move what lies within this geodesic distance, in longest sides of the box (the authors' program).
const RIGID_REACH: f64 = 0.25;
/// A field that pieces without a landmark follow has at most this many centres.
const MAX_CENTRES: usize = 1000;

/// What an initial deformation is found from.
#[derive(Clone, Copy, Debug)]
pub struct InitInput<'a> {
    /// The source's connectivity.
    pub mesh: &'a HalfedgeMesh,
    /// The source's shape.
    pub rest: &'a Positions,
    /// Places on the source and where they belong.
    pub landmarks: &'a [Landmark],
    /// Box of the target.
    pub target_frame: UnitFrame,
}

/// What happens to vertices far from every landmark.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pinning {
    /// They follow.
    None,
    /// Those farther along the surface than this share of the longest side of the box stay where the affine map put
    /// them.
    Beyond(f64),
}

/// How the landmarks spread over the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spread {
    /// A biharmonic displacement field: translations spread.
    Biharmonic,
    /// Starting there, rotations and scales spread too.
    Similar(SimilarConfig),
}

/// How the initial deformation is found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InitConfig {
    /// How near the affine map stays to a similarity.
    pub prior: SimilarityPrior,
    /// What vertices far from every landmark do in the biharmonic field.
    pub pinning: Pinning,
    /// How the landmarks spread.
    pub spread: Spread,
}

impl InitConfig {
    /// The paper's: a free affine map and a biharmonic field, pinned beyond 0.4 of the longest side as the authors'
    /// program does.
    pub fn paper() -> Self {
        Self {
            prior: SimilarityPrior::None,
            pinning: Pinning::Beyond(0.4),
            spread: Spread::Biharmonic,
        }
    }

    /// Less distortion and fewer folds: limbs turn instead of shearing.
    pub fn standard() -> Self {
        Self {
            prior: SimilarityPrior::LeaveOneOut,
            pinning: Pinning::None,
            spread: Spread::Similar(SimilarConfig::standard()),
        }
    }
}

/// The shape that draping starts at.
#[derive(Clone, Debug, PartialEq)]
pub struct Initial {
    /// One position per vertex, in the target's coordinates.
    pub positions: Positions,
    /// The affine map under it, with the residual of each landmark before the surface deforms.
    pub affine: AffineFit,
    /// How many vertices followed the space around them, since no landmark is on their piece.
    pub n_carried: usize,
}

/// Deforms the source so that its landmarks come to their places.
///
/// Affine map, then a smooth deformation of every piece with a landmark, then as rigid as possible around rigid
/// landmarks; pieces without one, and vertices without a face, follow the deformation of the space around them.
/// Without a landmark, the boxes are laid over each other. A landmark inside a face holds the vertex that counts most
/// there. Two landmarks on one vertex pull it to the middle. Works in the frame of the box, so units do not
/// matter. Source: Mesh Draping, Correspondence Setup. Departures: fewer than four landmarks, pieces without one; for
/// [`InitConfig::standard`] see [`SimilarityPrior::LeaveOneOut`] and [`SimilarSolver`].
///
/// # Errors
/// Positions that do not belong to the mesh, a landmark that is out of range or not finite, or a deformation that
/// cannot be solved for.
pub fn initialize(input: InitInput<'_>, config: &InitConfig) -> Result<Initial, InitError> {
    check(&input)?;
    let affine = fit(&input, config.prior);
    let placed = input.rest.map(|p| affine.apply(p));
    let frame = UnitFrame::principal(placed.as_slice());
    let stage = Stage {
        triangulation: Triangulation::new(input.mesh, input.rest),
        start: placed.map(|p| frame.to_unit(p)),
        config,
    };
    let handles = handles(&input, &affine.matrix, &frame);
    let (deformed, n_carried) = stage.deform(&handles)?;
    Ok(Initial {
        positions: deformed.map(|p| frame.from_unit(p)),
        affine,
        n_carried,
    })
}

/// Deforms the shape `present` of the source so that its landmarks come to their places, without an affine map.
///
/// A biharmonic field, pinned as in [`InitConfig::paper`], and as rigid as possible around rigid landmarks; without a
/// landmark nothing moves. In the coordinates of `present`, those of the target.
///
/// Source: Mesh Draping, Interactive Mode, where landmarks are added to a result. Departures: see [`initialize`].
///
/// # Errors
/// As [`initialize`].
pub fn adjust(input: InitInput<'_>, present: &Positions) -> Result<Positions, InitError> {
    check(&input)?;
    check_length(&input, present)?;
    let frame = UnitFrame::principal(present.as_slice());
    let stage = Stage {
        triangulation: Triangulation::new(input.mesh, input.rest),
        start: present.map(|p| frame.to_unit(p)),
        config: &InitConfig::paper(),
    };
    let placed = InitInput {
        rest: present,
        ..input
    };
    let (deformed, _) = stage.deform(&handles(&placed, &Matrix3::identity(), &frame))?;
    Ok(deformed.map(|p| frame.from_unit(p)))
}

fn check_length(input: &InitInput<'_>, x: &Positions) -> Result<(), InitError> {
    let n_vertices = input.mesh.n_vertices();
    if x.len() == n_vertices {
        return Ok(());
    }
    Err(InitError::PositionCount {
        n_vertices,
        n_positions: x.len(),
    })
}

fn check(input: &InitInput<'_>) -> Result<(), InitError> {
    check_length(input, input.rest)?;
    let n_vertices = input.mesh.n_vertices();
    for (landmark, l) in input.landmarks.iter().enumerate() {
        if let Some(vertex) = l.source.vertices.iter().find(|v| v.index() >= n_vertices) {
            return Err(InitError::LandmarkOutOfRange {
                landmark,
                vertex: vertex.index(),
                n_vertices,
            });
        }
        if !l
            .target
            .iter()
            .chain(&l.source.weights)
            .all(|c| c.is_finite())
        {
            return Err(InitError::NonFiniteLandmark { landmark });
        }
    }
    Ok(())
}

/// The affine map of the input's landmarks alone.
fn fit(input: &InitInput<'_>, prior: SimilarityPrior) -> AffineFit {
    let frames = FramePair {
        source: UnitFrame::principal(input.rest.as_slice()),
        target: input.target_frame,
    };
    fit_affine(&point_pairs(input.landmarks, input.rest), frames, prior)
}

/// Where each landmark is on the source and where it belongs: what the affine map is fitted to.
pub fn point_pairs(landmarks: &[Landmark], rest: &Positions) -> Vec<PointPair> {
    let pair = |l: &Landmark| PointPair {
        source: l.source.position(rest),
        target: l.target,
    };
    landmarks.iter().map(pair).collect()
}

/// A vertex that landmarks hold, and where.
#[derive(Clone, Copy, Debug)]
struct Handle {
    vertex: VertexId,
    target: Point3,
    kind: LandmarkKind,
}

/// One handle for each vertex that counts most in a landmark, in order of first appearance: the landmark's target,
/// moved by what the affine map makes of the way from landmark to vertex; the mean where there are several. Rigid
/// where any of them is.
fn handles(input: &InitInput<'_>, linear: &Matrix3<f64>, frame: &UnitFrame) -> Vec<Handle> {
    let mut handles: Vec<(Handle, f64)> = Vec::new();
    for landmark in input.landmarks {
        let vertex = landmark.source.main_vertex();
        let offset = linear * (input.rest[vertex] - landmark.source.position(input.rest));
        let target = frame.to_unit(&(landmark.target + offset));
        match handles.iter_mut().find(|(h, _)| h.vertex == vertex) {
            None => handles.push((
                Handle {
                    vertex,
                    target,
                    kind: landmark.kind,
                },
                1.0,
            )),
            Some((handle, n)) => {
                *n += 1.0;
                handle.target += (target - handle.target) / *n;
                if landmark.kind == LandmarkKind::Rigid {
                    handle.kind = LandmarkKind::Rigid;
                }
            }
        }
    }
    handles.into_iter().map(|(handle, _)| handle).collect()
}

/// The surface where the affine map put it, in the frame of its box.
struct Stage<'a> {
    triangulation: Triangulation,
    start: Positions,
    config: &'a InitConfig,
}

impl Stage<'_> {
    fn deform(&self, handles: &[Handle]) -> Result<(Positions, usize), InitError> {
        if handles.is_empty() {
            return Ok((self.start.clone(), 0));
        }
        let mut x = self.spread(handles)?;
        let (rigid, soft): (Vec<Handle>, Vec<Handle>) =
            handles.iter().partition(|h| h.kind == LandmarkKind::Rigid);
        if !rigid.is_empty() {
            let base = if soft.is_empty() {
                self.start.clone()
            } else {
                self.spread(&soft)?
            };
            x = self.turn(&rigid, &soft, &base, &x)?;
        }
        self.carry(handles, x)
    }

    /// The smooth deformation of the pieces with a handle; the others stay.
    fn spread(&self, handles: &[Handle]) -> Result<Positions, InitError> {
        let mut held: Vec<(VertexId, Vector3)> = handles
            .iter()
            .map(|h| (h.vertex, h.target - self.start[h.vertex]))
            .collect();
        if let Pinning::Beyond(reach) = self.config.pinning {
            let far = self.farther_than(reach, handles);
            held.extend(far.into_iter().map(|v| (v, Vector3::zeros())));
        }
        let d = biharmonic_displacement(&self.triangulation, &self.start, &held)?;
        let biharmonic: Positions = self.start.iter().zip(&d).map(|(p, d)| p + d).collect();
        match self.config.spread {
            Spread::Biharmonic => Ok(biharmonic),
            Spread::Similar(config) => {
                let rows: Vec<VertexId> = handles.iter().map(|h| h.vertex).collect();
                let targets: Vec<Point3> = handles.iter().map(|h| h.target).collect();
                let solver = SimilarSolver::new(&self.triangulation, &self.start, &rows, config)?;
                Ok(solver.solve(&targets, &biharmonic))
            }
        }
    }

    /// As rigid as possible around the rigid handles, in the shape that the soft ones gave.
    fn turn(
        &self,
        rigid: &[Handle],
        soft: &[Handle],
        base: &Positions,
        guess: &Positions,
    ) -> Result<Positions, InitError> {
        let far = self.farther_than(RIGID_REACH, rigid);
        let mut is_held = VertexData::new(base.len(), false);
        let mut held: Vec<(VertexId, Point3)> = Vec::new();
        let places = rigid.iter().chain(soft).map(|h| (h.vertex, h.target));
        for (v, place) in places.chain(far.into_iter().map(|v| (v, base[v]))) {
            if !is_held[v] {
                is_held[v] = true;
                held.push((v, place));
            }
        }
        let (rows, targets): (Vec<VertexId>, Vec<Point3>) = held.into_iter().unzip();
        Ok(ArapSolver::new(&self.triangulation, base, &rows)?.solve(&targets, guess))
    }

    /// Vertices without a handle on their piece follow the field of those with one.
    fn carry(&self, handles: &[Handle], mut x: Positions) -> Result<(Positions, usize), InitError> {
        let rows: Vec<VertexId> = handles.iter().map(|h| h.vertex).collect();
        let is_led = is_reached(&self.triangulation, x.len(), &rows);
        let (led, carried): (Vec<VertexId>, Vec<VertexId>) = x.ids().partition(|&v| is_led[v]);
        if !carried.is_empty() {
            let points: Vec<Point3> = led.iter().map(|&v| self.start[v]).collect();
            let moves: Vec<Vector3> = led.iter().map(|&v| x[v] - self.start[v]).collect();
            let field = SpaceExtension::new(&points, &moves, MAX_CENTRES)?;
            for &v in &carried {
                x[v] = self.start[v] + field.displacement_at(&self.start[v]);
            }
        }
        Ok((x, carried.len()))
    }

    /// Vertices that a path along the surface joins to a handle, but farther than `reach`.
    fn farther_than(&self, reach: f64, handles: &[Handle]) -> Vec<VertexId> {
        let rows: Vec<VertexId> = handles.iter().map(|h| h.vertex).collect();
        let distance = geodesic_distance_unfolded(&self.triangulation, &self.start, &rows);
        let is_far = |v: &VertexId| distance[*v].is_finite() && distance[*v] > reach;
        distance.ids().filter(is_far).collect()
    }
}
