//! Everything about one result, measured at once.

use std::sync::Arc;

use mesh_core::{
    Curve, FaceId, Landmark, Point3, Positions, TargetSurface, Triangulation, UnitFrame,
};

use crate::chamfer::chamfer;
use crate::config::EvaluationConfig;
use crate::defects::{
    folded_edges, mean_angle_deviation, opposed_triangles, skinny_triangles, triangle_qualities,
    SKINNY_QUALITY,
};
use crate::dirichlet::{dirichlet_energy, dirichlet_unit_area, face_stretch};
use crate::distances::{vertex_distances, DirectedDistances, SurfaceDistances, TargetKind};
use crate::hausdorff::{directed_hausdorff_sampled, hausdorff_sampled};
use crate::normalize::{common_frame, own_frame};
use crate::percentile::percentiles;
use crate::q_transfer::{q_transfer, HAUSDORFF_WEIGHT, PAPER_TAU};
use crate::report::{
    CurveFit, Defects, DistanceSummary, LandmarkFit, LandmarkResidual, Places, Report, TruthError,
};
use crate::self_intersection::{new_intersections, self_intersections, without_neighbours};

/// A result to be judged.
#[derive(Clone, Copy)]
pub struct EvaluationInput<'a> {
    /// The source's polygons as triangles.
    pub triangulation: &'a Triangulation,
    /// The source as given.
    pub rest: &'a Positions,
    /// The result, in the target's coordinates.
    pub draped: &'a Positions,
    /// What it should lie on.
    pub target: &'a dyn TargetSurface,
    /// The pairs it should respect; may be empty.
    pub landmarks: &'a [Landmark],
    /// Where each vertex belongs, if known, in the target's coordinates.
    pub truth: Option<&'a Positions>,
}

/// A result that cannot be judged.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum EvaluateError {
    /// Nothing to measure.
    #[error("the source has no face with three different corners; there is no surface to judge")]
    NoTriangles,
    /// A set of positions that belongs to another mesh.
    #[error("{positions} have {found} vertices, the source has {expected}; give a result of this very source")]
    VertexCount {
        /// Which positions.
        positions: &'static str,
        /// How many there are.
        found: usize,
        /// How many the source has.
        expected: usize,
    },
    /// A coordinate of the result is NaN or infinite.
    #[error("vertex {vertex} (counted from 0) of the {positions} has a coordinate that is not a finite number")]
    NonFiniteCoordinate {
        /// Which positions.
        positions: &'static str,
        /// Row of the vertex.
        vertex: usize,
    },
}

/// Judges a draped mesh by every measure of this crate.
///
/// Lengths are in longest sides of the target's box ([`common_frame`]). Polygons are measured on one triangulation,
/// chosen at rest ([`Triangulation`]).
///
/// # Errors
/// Positions that do not fit the mesh, a coordinate that is not finite, or a source without a surface.
///
/// ```
/// use mesh_metrics::mesh_core::{shapes, TriangleSoup, Triangulation, Vector3};
/// use mesh_metrics::{evaluate, EvaluationConfig, EvaluationInput};
/// let (mesh, rest) = shapes::quad_sphere(4).into_halfedge()?;
/// let target = TriangleSoup::new(shapes::quad_sphere(4))?;
/// let draped = rest.map(|p| p + Vector3::new(0.02, 0.0, 0.0)); // a hundredth of the box off
/// let input = EvaluationInput {
///     triangulation: &Triangulation::new(&mesh, &rest), rest: &rest, draped: &draped, target: &target,
///     landmarks: &[], truth: Some(&rest),
/// };
/// let report = evaluate(input, &EvaluationConfig { n_samples: 1000, seed: 0 })?;
/// assert!((report.dirichlet - 1.0).abs() < 1e-9 && report.hausdorff < 0.0101);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn evaluate(
    input: EvaluationInput<'_>,
    config: &EvaluationConfig,
) -> Result<Report, EvaluateError> {
    check(&input)?;
    let EvaluationInput {
        triangulation,
        rest,
        draped,
        target,
        ..
    } = input;
    if triangulation.is_empty() {
        return Err(EvaluateError::NoTriangles);
    }
    let frame = common_frame(target);

    let distances = SurfaceDistances::measure(triangulation, draped, target, config);
    let [to_target, to_draped] = [&distances.to_target, &distances.to_draped].map(summary);
    let hausdorff = hausdorff_sampled(&distances);
    let dirichlet = dirichlet_unit_area(triangulation, rest, draped);
    let (defects, places) = defects(&input);

    Ok(Report {
        target_kind: TargetKind::of(target),
        n_vertices: triangulation.n_vertices(),
        n_faces: triangulation.n_faces(),
        q_transfer: q_transfer(dirichlet - 1.0, HAUSDORFF_WEIGHT * hausdorff, PAPER_TAU),
        dirichlet,
        dirichlet_raw: raw_dirichlet(&input, &frame),
        hausdorff,
        to_target,
        to_draped,
        defects,
        landmarks: landmark_fit(input.landmarks, draped, &frame),
        curves: curve_fits(input.landmarks, draped, &frame),
        truth: input
            .truth
            .map(|truth| truth_error(triangulation, draped, truth, &frame)),
        places,
        vertex_distances: vertex_distances(draped, target),
        face_stretch: face_stretch(triangulation, rest, draped),
    })
}

fn check(input: &EvaluationInput<'_>) -> Result<(), EvaluateError> {
    let expected = input.triangulation.n_vertices();
    let named = [
        ("rest positions", Some(input.rest)),
        ("draped positions", Some(input.draped)),
        ("true positions", input.truth),
    ];
    for (positions, x) in named.into_iter().filter_map(|(name, x)| Some((name, x?))) {
        let found = x.len();
        if found != expected {
            return Err(EvaluateError::VertexCount {
                positions,
                found,
                expected,
            });
        }
        if let Some(vertex) = x
            .iter()
            .position(|p| !p.coords.iter().all(|c| c.is_finite()))
        {
            return Err(EvaluateError::NonFiniteCoordinate { positions, vertex });
        }
    }
    Ok(())
}

fn summary(distances: &DirectedDistances) -> DistanceSummary {
    let mean = chamfer(distances);
    let [p50, p90, p99] = percentiles(distances.all(), [0.5, 0.9, 0.99]);
    DistanceSummary {
        mean_l2: mean.mean_l2,
        mean_squared: mean.mean_squared,
        p50,
        p90,
        p99,
        max: directed_hausdorff_sampled(distances),
    }
}

/// Dirichlet energy with rest in its own unit frame and draped in the common one: sizes are not made equal.
fn raw_dirichlet(input: &EvaluationInput<'_>, frame: &UnitFrame) -> f64 {
    let scale = own_frame(input.triangulation, input.rest).scale / frame.scale;
    dirichlet_energy(input.triangulation, input.rest, input.draped) * scale * scale
}

fn defects(input: &EvaluationInput<'_>) -> (Defects, Places) {
    let EvaluationInput {
        triangulation,
        rest,
        draped,
        target,
        ..
    } = *input;
    let quality = triangle_qualities(triangulation, draped);
    let rest_quality = triangle_qualities(triangulation, rest);
    let skinny = skinny_triangles(triangulation, draped);
    let skinny_new: Vec<usize> = skinny
        .iter()
        .copied()
        .filter(|&t| rest_quality[t] >= SKINNY_QUALITY)
        .collect();
    let folds = folded_edges(triangulation, rest, draped);
    let opposed = opposed_triangles(triangulation, draped, target);
    let crossings = self_intersections(triangulation, draped);
    let n_crossings = crossings.len();
    let crossings_new = new_intersections(triangulation, rest, crossings);

    let defects = Defects {
        angle_deviation_deg: mean_angle_deviation(triangulation, rest, draped),
        quality_min: quality.iter().copied().fold(f64::INFINITY, f64::min),
        quality_mean: quality.iter().sum::<f64>() / quality.len() as f64,
        skinny: skinny.len(),
        skinny_new: skinny_new.len(),
        folds: folds.len(),
        opposed_faces: opposed.as_ref().map(Vec::len),
        self_intersections: n_crossings,
        self_intersections_new: crossings_new.len(),
        crossings: without_neighbours(triangulation, &crossings_new).len(),
    };
    let faces = |triangles: Vec<usize>| faces_of(triangulation, triangles);
    let places = Places {
        skinny_new: faces(skinny_new),
        folded: faces(folds.iter().flat_map(|e| e.triangles).collect()),
        opposed: faces(opposed.unwrap_or_default()),
        self_intersecting_new: faces(crossings_new.concat()),
    };
    (defects, places)
}

/// The faces that the triangles are part of, each once, in order.
fn faces_of(triangulation: &Triangulation, triangles: Vec<usize>) -> Vec<FaceId> {
    let mut faces: Vec<FaceId> = triangles
        .into_iter()
        .map(|t| triangulation.parent(t))
        .collect();
    faces.sort_unstable();
    faces.dedup();
    faces
}

fn landmark_fit(
    landmarks: &[Landmark],
    draped: &Positions,
    frame: &UnitFrame,
) -> Option<LandmarkFit> {
    let marked = Landmark::marked(landmarks);
    let residual = |landmark: &Landmark| LandmarkResidual {
        name: landmark.name.clone(),
        distance: miss(landmark, draped, frame),
    };
    let followed = marked.clone().filter(|l| l.is_followed());
    let followed: Vec<f64> = followed.map(|l| miss(l, draped, frame)).collect();
    let residuals: Vec<LandmarkResidual> = marked.map(residual).collect();
    (!residuals.is_empty()).then(|| LandmarkFit {
        rms: rms(&followed),
        max: followed.iter().copied().fold(0.0, f64::max),
        residuals,
    })
}

fn curve_fits(landmarks: &[Landmark], draped: &Positions, frame: &UnitFrame) -> Vec<CurveFit> {
    let fit = |(curve, cut): (&Arc<Curve>, &[Landmark])| {
        let misses: Vec<f64> = cut.iter().map(|l| miss(l, draped, frame)).collect();
        CurveFit {
            name: curve.name.clone(),
            rms: rms(&misses),
            max: misses.iter().copied().fold(0.0, f64::max),
        }
    };
    Curve::runs(landmarks).map(fit).collect()
}

/// How far a landmark is from where it belongs.
fn miss(landmark: &Landmark, draped: &Positions, frame: &UnitFrame) -> f64 {
    distance(&landmark.source.position(draped), &landmark.target, frame)
}

/// Root of the mean square; 0 of nothing.
fn rms(distances: &[f64]) -> f64 {
    let squared = distances.iter().map(|d| d * d).sum::<f64>();
    (squared / distances.len().max(1) as f64).sqrt()
}

/// Distance of the vertices in use from where they belong.
fn truth_error(
    triangulation: &Triangulation,
    draped: &Positions,
    truth: &Positions,
    frame: &UnitFrame,
) -> TruthError {
    let used = triangulation.used_vertices();
    let errors: Vec<f64> = used
        .map(|v| distance(&draped[v], &truth[v], frame))
        .collect();
    let [p95, max] = percentiles(errors.iter().copied(), [0.95, 1.0]);
    TruthError {
        mean: errors.iter().sum::<f64>() / errors.len() as f64,
        p95,
        max,
    }
}

fn distance(a: &Point3, b: &Point3, frame: &UnitFrame) -> f64 {
    (a - b).norm() / frame.scale
}
