//! A landmark while it is being made: either of its sides may still be missing.

use mesh_core::{Curve, Landmark, LandmarkKind, MeshPoint, Point3, VertexId};
use mesh_draping::landmarks::cut;
use mesh_draping::Source;
use serde::{Deserialize, Serialize};

use super::file::fnv1a;

/// A landmark as a session keeps it: every number exactly.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Mark {
    /// Its number as long as the session lives.
    pub(crate) id: u32,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub(crate) name: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) source: Option<SourcePlace>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) target: Option<[f64; 3]>,
    #[serde(default)]
    pub(crate) kind: MarkKind,
    /// What it counts beside the others, from 0.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub(crate) weight: f64,
    /// The two lines, where it is a curve: it has no other places then.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) curve: Option<Lines>,
}

/// The two lines of a curve.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Lines {
    pub(crate) source: Vec<SourcePlace>,
    pub(crate) target: Vec<[f64; 3]>,
}

impl Lines {
    /// Whether the line on the source ends where it began.
    pub(crate) fn is_closed(&self) -> bool {
        self.source.len() > 1 && self.source.first() == self.source.last()
    }
}

fn one() -> f64 {
    1.0
}

#[allow(
    clippy::trivially_copy_pass_by_ref,
    reason = "serde asks for a reference"
)]
fn is_one(weight: &f64) -> bool {
    *weight == 1.0
}

/// A place of the source: a weighted mean of three vertices.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SourcePlace {
    pub(crate) vertices: [u32; 3],
    pub(crate) weights: [f64; 3],
}

/// Soft or rigid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum MarkKind {
    #[default]
    Soft,
    Rigid,
}

impl Mark {
    /// A mark of a landmark.
    pub(crate) fn of(id: u32, landmark: &Landmark) -> Self {
        Self {
            id,
            name: landmark.name.clone().unwrap_or_default(),
            source: Some(SourcePlace::of(&landmark.source)),
            target: Some(landmark.target.into()),
            kind: match landmark.kind {
                LandmarkKind::Soft => MarkKind::Soft,
                LandmarkKind::Rigid => MarkKind::Rigid,
            },
            weight: landmark.weight,
            curve: None,
        }
    }

    /// A mark that is not placed yet.
    pub(crate) fn empty(id: u32) -> Self {
        Self {
            id,
            name: String::new(),
            source: None,
            target: None,
            kind: MarkKind::Soft,
            weight: 1.0,
            curve: None,
        }
    }

    /// A mark of a curve.
    pub(crate) fn of_curve(id: u32, curve: &Curve) -> Self {
        Self {
            name: curve.name.clone().unwrap_or_default(),
            weight: curve.weight,
            curve: Some(Lines {
                source: curve.source.iter().map(SourcePlace::of).collect(),
                target: curve.target.iter().map(|&p| p.into()).collect(),
            }),
            ..Self::empty(id)
        }
    }

    /// The curve, if it is one.
    pub(crate) fn curve(&self) -> Option<Curve> {
        let lines = self.curve.as_ref()?;
        Some(Curve {
            name: self.given_name(),
            source: lines.source.iter().map(SourcePlace::mesh_point).collect(),
            target: lines.target.iter().map(|&p| p.into()).collect(),
            weight: self.weight,
        })
    }

    /// Whether nothing is missing.
    pub(crate) fn is_complete(&self) -> bool {
        self.curve.is_some() || self.landmark().is_some()
    }

    /// Its places on the source.
    pub(crate) fn source_places(&self) -> impl Iterator<Item = &SourcePlace> {
        let line = self.curve.iter().flat_map(|lines| &lines.source);
        self.source.iter().chain(line)
    }

    /// All that decides a drape: with neither name nor number.
    pub(crate) fn unnamed(&self) -> Self {
        Self {
            id: 0,
            name: String::new(),
            ..self.clone()
        }
    }

    fn given_name(&self) -> Option<String> {
        Some(self.name.clone()).filter(|name| !name.is_empty())
    }

    /// The landmark, once both sides are there; a curve is none.
    pub(crate) fn landmark(&self) -> Option<Landmark> {
        Some(Landmark {
            name: self.given_name(),
            source: self.source?.mesh_point(),
            target: Point3::from(self.target?),
            kind: match self.kind {
                MarkKind::Soft => LandmarkKind::Soft,
                MarkKind::Rigid => LandmarkKind::Rigid,
            },
            weight: self.weight,
            curve: None,
        })
    }
}

impl SourcePlace {
    pub(crate) fn of(place: &MeshPoint) -> Self {
        Self {
            vertices: place.vertices.map(|v| v.index() as u32),
            weights: place.weights,
        }
    }

    pub(crate) fn mesh_point(&self) -> MeshPoint {
        MeshPoint::barycentric(
            self.vertices.map(|v| VertexId::new(v as usize)),
            self.weights,
        )
    }
}

/// The landmarks of all marks that have both sides, and after them those of the curves. A curve that cannot be cut, which no
/// page draws, has none.
pub(crate) fn landmarks(marks: &[Mark], source: &Source) -> Vec<Landmark> {
    let points = marks.iter().filter_map(Mark::landmark);
    let curves = marks.iter().filter_map(Mark::curve);
    let cut = curves.flat_map(|curve| cut(curve, source).unwrap_or_default());
    points.chain(cut).collect()
}

/// The number of each mark: the row that its landmark has in a file of landmarks, as the report and the command line
/// count, and that of a curve among the curves; none as long as a side is missing.
pub(crate) fn numbers(marks: &[Mark]) -> impl Iterator<Item = Option<usize>> + '_ {
    let (mut row, mut curve) = (0.., 0..);
    marks.iter().map(move |mark| match mark.curve {
        Some(_) => curve.next(),
        None => mark.landmark().and_then(|_| row.next()),
    })
}

/// What tells one list of landmarks from another: a hash of all that decides a drape.
pub(crate) fn fingerprint(landmarks: &[Landmark]) -> String {
    let numbers = landmarks.iter().flat_map(|l| {
        let (source, target) = (&l.source, l.target);
        let rows = source.vertices.map(|v| v.index() as u64);
        let places = source
            .weights
            .into_iter()
            .chain(target.coords.iter().copied());
        let places = places.chain([l.pull()]);
        let places = places.map(f64::to_bits).collect::<Vec<_>>();
        rows.into_iter()
            .chain(places)
            .chain([u64::from(l.kind == LandmarkKind::Rigid)])
    });
    let bytes: Vec<u8> = numbers.flat_map(u64::to_le_bytes).collect();
    format!("{:016x}", fnv1a(&bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mark(id: u32, target: Option<[f64; 3]>) -> Mark {
        Mark {
            source: Some(SourcePlace {
                vertices: [0, 1, 2],
                weights: [0.5, 0.25, 0.25],
            }),
            target,
            ..Mark::empty(id)
        }
    }

    #[test]
    fn marks_are_numbered_as_the_rows_of_a_file() {
        let there = Some([0.0; 3]);
        let marks = [mark(7, there), mark(8, None), mark(9, there)];
        let numbers: Vec<_> = numbers(&marks).collect();
        assert_eq!(numbers, [Some(0), None, Some(1)]);
    }

    #[test]
    fn a_fingerprint_tells_places_kinds_and_weights_but_no_names() {
        let landmarks = |target| vec![mark(1, Some(target)).landmark().unwrap()];
        let one = landmarks([1.0, 2.0, 3.0]);
        let mut named = one.clone();
        named[0].name = Some("nose".to_owned());
        assert_eq!(fingerprint(&one), fingerprint(&named));
        let mut rigid = one.clone();
        rigid[0].kind = LandmarkKind::Rigid;
        let moved = landmarks([1.0, 2.0, 3.5]);
        let mut light = one.clone();
        light[0].weight = 0.5;
        assert_ne!(fingerprint(&one), fingerprint(&light));
        assert_ne!(fingerprint(&one), fingerprint(&rigid));
        assert_ne!(fingerprint(&one), fingerprint(&moved));
    }
}
