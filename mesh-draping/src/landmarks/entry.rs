//! A landmark as a file has it, and its places on the shapes.

use mesh_core::{Curve, FaceId, Landmark, LandmarkKind, MeshPoint, Point3, Vector3, VertexId};

use super::curve::cut;
use super::LandmarkProblem;
use crate::{Shape, Source};

/// How far the weights of a face may be from a sum of 1.
const WEIGHT_TOLERANCE: f64 = 1e-3;
/// Weights whose sum is this near to 1 are taken as they are.
const EXACT_SUM: f64 = 4.0 * f64::EPSILON;
/// Coordinates beyond this cannot be squared and summed.
const FARTHEST: f64 = 1e150;

/// A landmark whose places are not yet looked up.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Entry {
    pub(super) name: Option<String>,
    pub(super) source: SourcePlace,
    pub(super) target: TargetPlace,
    pub(super) kind: LandmarkKind,
    pub(super) weight: f64,
}

/// A curve whose places are not yet looked up.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct CurveEntry {
    pub(super) name: Option<String>,
    pub(super) source: Vec<SourcePlace>,
    pub(super) target: Vec<TargetPlace>,
    pub(super) weight: f64,
}

/// What a file holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Entries {
    pub(super) landmarks: Vec<Entry>,
    pub(super) curves: Vec<CurveEntry>,
}

impl Entries {
    /// Landmarks without a curve.
    pub(super) fn of(landmarks: Vec<Entry>) -> Self {
        Self {
            landmarks,
            ..Self::default()
        }
    }
}

/// Vertices and faces are rows of the file.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum SourcePlace {
    Vertex(usize),
    Face { face: usize, weights: Vec<f64> },
    Point(Point3),
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum TargetPlace {
    Vertex(usize),
    Point(Point3),
}

impl Entry {
    /// Looks the places up on a source and among the vertices of a target's file.
    pub(super) fn resolve(
        &self,
        source: &Source,
        target: &[Point3],
    ) -> Result<Landmark, LandmarkProblem> {
        Ok(Landmark {
            name: self.name.clone(),
            source: self.source.resolve(source)?,
            target: self.target.resolve(target)?,
            kind: self.kind,
            weight: self.weight,
            curve: None,
        })
    }
}

impl CurveEntry {
    /// Looks the places up, and cuts the curve into landmarks.
    pub(super) fn resolve(
        &self,
        source: &Source,
        target: &[Point3],
    ) -> Result<Vec<Landmark>, LandmarkProblem> {
        let on_source = self.source.iter().map(|place| place.resolve(source));
        let on_target = self.target.iter().map(|place| place.resolve(target));
        let curve = Curve {
            name: self.name.clone(),
            source: on_source.collect::<Result<_, _>>()?,
            target: on_target.collect::<Result<_, _>>()?,
            weight: self.weight,
        };
        cut(curve, source)
    }
}

impl SourcePlace {
    fn resolve(&self, source: &Source) -> Result<MeshPoint, LandmarkProblem> {
        match self {
            &Self::Vertex(row) => {
                let n = source.n_file_vertices();
                let shape = Shape::Source;
                let vertex = source.vertex_at(row);
                let vertex = vertex.ok_or(LandmarkProblem::NoVertex { shape, row, n })?;
                Ok(MeshPoint::vertex(vertex))
            }
            Self::Face { face, weights } => place_in_face(*face, weights, source),
            Self::Point(point) => {
                let shape = Shape::Source;
                check_finite(point, shape)?;
                let place = source.closest_place(point);
                // A source has a triangle, so that there always is one.
                place.ok_or(LandmarkProblem::NotFinite { shape })
            }
        }
    }
}

impl TargetPlace {
    fn resolve(&self, target: &[Point3]) -> Result<Point3, LandmarkProblem> {
        let shape = Shape::Target;
        let point = match *self {
            Self::Vertex(row) => *target.get(row).ok_or(LandmarkProblem::NoVertex {
                shape,
                row,
                n: target.len(),
            })?,
            Self::Point(point) => point,
        };
        check_finite(&point, shape)?;
        Ok(point)
    }
}

fn check_finite(point: &Point3, shape: Shape) -> Result<(), LandmarkProblem> {
    // NaN is not below anything.
    let is_fine = point.coords.iter().all(|c| c.abs() <= FARTHEST);
    is_fine
        .then_some(())
        .ok_or(LandmarkProblem::NotFinite { shape })
}

fn place_in_face(
    face: usize,
    weights: &[f64],
    source: &Source,
) -> Result<MeshPoint, LandmarkProblem> {
    let n = source.mesh().n_faces();
    if face >= n {
        return Err(LandmarkProblem::NoFace { face, n });
    }
    let corners = source.mesh().face_vertices(FaceId::new(face));
    if corners.len() != weights.len() {
        return Err(LandmarkProblem::WeightCount {
            face,
            n_corners: corners.len(),
            n_weights: weights.len(),
        });
    }
    let sum: f64 = weights.iter().sum();
    let is_inside =
        weights.iter().all(|&w| w >= -WEIGHT_TOLERANCE) && (sum - 1.0).abs() <= WEIGHT_TOLERANCE;
    if !is_inside {
        return Err(LandmarkProblem::Weights { face });
    }
    if let Some(place) = place_as_given(face, corners, weights, source) {
        return Ok(place);
    }
    let terms = corners.iter().zip(weights);
    let point = terms.map(|(&v, w)| source.rest()[v].coords * (w / sum));
    let point = Point3::from(point.sum::<Vector3>());
    source
        .closest_place_on(FaceId::new(face), &point)
        .ok_or(LandmarkProblem::NoArea { face })
}

/// The place with these very weights, if they are those of a place in one triangle of the face: as they are written.
fn place_as_given(
    face: usize,
    corners: &[VertexId],
    weights: &[f64],
    source: &Source,
) -> Option<MeshPoint> {
    let sum: f64 = weights.iter().sum();
    if (sum - 1.0).abs() > EXACT_SUM || weights.iter().any(|&w| w < 0.0) {
        return None;
    }
    let used = || corners.iter().zip(weights).filter(|(_, &w)| w != 0.0);
    let triangulation = source.triangulation();
    let mut rows = (0..triangulation.len())
        .filter(|&row| triangulation.parent(row) == FaceId::new(face))
        .map(|row| triangulation.triangles()[row]);
    let triangle = rows.find(|t| used().all(|(v, _)| t.contains(v)))?;
    let weight_of = |v: VertexId| used().filter(|(u, _)| **u == v).map(|(_, w)| w).sum();
    Some(MeshPoint::barycentric(triangle, triangle.map(weight_of)))
}
