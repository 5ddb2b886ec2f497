//! From landmarks to the shape that draping starts at.

use mesh_core::{Landmark, Point3, Positions, Triangulation, UnitFrame};

use crate::affine::{fit_affine, AffineFit, FramePair, PointPair};
use crate::deformer::{Deformer, Pull, Strength};
use crate::{InitConfig, InitError};

/// What an initial deformation is found from.
#[derive(Clone, Copy, Debug)]
pub struct InitInput<'a> {
    /// The source's polygons as triangles.
    pub triangulation: &'a Triangulation,
    /// The source's shape.
    pub rest: &'a Positions,
    /// Places on the source and where they belong.
    pub landmarks: &'a [Landmark],
    /// Box of the target.
    pub target_frame: UnitFrame,
}

/// The shape that draping starts at.
#[derive(Clone, Debug, PartialEq)]
pub struct Initial {
    /// One position per vertex, in the target's coordinates.
    pub positions: Positions,
    /// The affine map under it, with the residual of each landmark before the surface deforms.
    pub affine: AffineFit,
    /// How many vertices have no landmark on their piece: the displacement of the others, extended over space, moved them.
    pub n_extrapolated: usize,
}

/// Deforms the source so that its landmarks come to their places.
///
/// Affine map, then a smooth deformation of every piece with a landmark, then as rigid as possible around rigid
/// landmarks; pieces without one, and vertices without a face, follow the deformation of the space around them.
/// Without a landmark, the boxes are laid over each other. A landmark inside a face holds the vertex that counts most
/// there. Two landmarks on one vertex pull it to the middle. Weights count in the affine map and in the pull of a landmark;
/// where one is held rather than pulled, in the biharmonic field, a weight below 1 holds it at that share of the way from
/// where the others bring it to its place. What is rigid is held whatever its weight. Weight 0 is as if it were not there. Works in the frame of the box, so units do not
/// matter. Where targets change again and again, [`InteractiveInit`](crate::InteractiveInit) is quicker. Source: Mesh
/// Draping, Correspondence Setup. Departures: fewer than four landmarks, pieces without one; for
/// [`InitConfig::standard`] see [`LeaveOneOut`](crate::SimilarityPrior::LeaveOneOut) and
/// [`SimilarSolver`](crate::SimilarSolver).
///
/// # Errors
/// Positions that do not belong to the mesh, a landmark that is out of range or not finite, or a deformation that
/// cannot be solved for.
pub fn initialize(input: InitInput<'_>, config: &InitConfig) -> Result<Initial, InitError> {
    check(&input)?;
    let followed = Landmark::followed(input.landmarks);
    let input = InitInput {
        landmarks: &followed,
        ..input
    };
    let frames = FramePair {
        source: UnitFrame::principal(input.rest.as_slice()),
        target: input.target_frame,
    };
    let pairs = point_pairs(input.landmarks, input.rest);
    let affine = fit_affine(&pairs, frames, config.prior);
    let placed = input.rest.map(|p| affine.apply(p));
    let deformer = deformer(&input, &placed, config)?;
    Ok(Initial {
        positions: deformer.solve(&targets(input.landmarks))?,
        n_extrapolated: deformer.n_extrapolated(),
        affine,
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
    check_length(input.triangulation.n_vertices(), present)?;
    let followed = Landmark::followed(input.landmarks);
    let input = InitInput {
        landmarks: &followed,
        ..input
    };
    deformer(&input, present, &InitConfig::paper())?.solve(&targets(input.landmarks))
}

/// The source at `placed`, ready to be deformed.
fn deformer(
    input: &InitInput<'_>,
    placed: &Positions,
    config: &InitConfig,
) -> Result<Deformer, InitError> {
    let pulls = input.landmarks.iter().map(|l| pull(l, placed));
    Deformer::new(input.triangulation.clone(), placed, pulls.collect(), config)
}

/// What a landmark pulls at: the vertex that counts most.
fn pull(landmark: &Landmark, placed: &Positions) -> Pull {
    let vertex = landmark.source.main_vertex();
    Pull {
        vertex,
        offset: placed[vertex] - landmark.source.position(placed),
        kind: landmark.kind,
        strength: Strength::of(landmark),
    }
}

pub(crate) fn targets(landmarks: &[Landmark]) -> Vec<Point3> {
    landmarks.iter().map(|l| l.target).collect()
}

pub(crate) fn check_length(n_vertices: usize, x: &Positions) -> Result<(), InitError> {
    if x.len() == n_vertices {
        return Ok(());
    }
    Err(InitError::PositionCount {
        n_vertices,
        n_positions: x.len(),
    })
}

fn check(input: &InitInput<'_>) -> Result<(), InitError> {
    check_length(input.triangulation.n_vertices(), input.rest)?;
    check_landmarks(input.triangulation.n_vertices(), input.landmarks)
}

pub(crate) fn check_landmarks(n_vertices: usize, landmarks: &[Landmark]) -> Result<(), InitError> {
    for (landmark, l) in landmarks.iter().enumerate() {
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
            .chain([&l.weight])
            .all(|c| c.is_finite())
        {
            return Err(InitError::NonFiniteLandmark { landmark });
        }
    }
    Ok(())
}

/// Where each landmark that counts is on the source and where it belongs: what the affine map is fitted to.
pub fn point_pairs(landmarks: &[Landmark], rest: &Positions) -> Vec<PointPair> {
    let pair = |l: &Landmark| PointPair {
        source: l.source.position(rest),
        target: l.target,
        weight: l.pull(),
    };
    let followed = landmarks.iter().filter(|l| l.is_followed());
    followed.map(pair).collect()
}
