//! A landmark while it is being made: either of its sides may still be missing.

use mesh_core::{Landmark, LandmarkKind, MeshPoint, Point3, VertexId};
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
        }
    }

    /// The landmark, once both sides are there.
    pub(crate) fn landmark(&self) -> Option<Landmark> {
        Some(Landmark {
            name: Some(self.name.clone()).filter(|name| !name.is_empty()),
            source: self.source?.mesh_point(),
            target: Point3::from(self.target?),
            kind: match self.kind {
                MarkKind::Soft => LandmarkKind::Soft,
                MarkKind::Rigid => LandmarkKind::Rigid,
            },
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

/// The landmarks of all marks that have both sides.
pub(crate) fn landmarks(marks: &[Mark]) -> Vec<Landmark> {
    marks.iter().filter_map(Mark::landmark).collect()
}

/// The number of each mark: the row that its landmark has in a file of landmarks, as the report and the command line
/// count; none as long as a side is missing.
pub(crate) fn numbers(marks: &[Mark]) -> impl Iterator<Item = Option<usize>> + '_ {
    let mut row = 0..;
    marks
        .iter()
        .map(move |mark| mark.landmark().and_then(|_| row.next()))
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
            id,
            name: String::new(),
            source: Some(SourcePlace {
                vertices: [0, 1, 2],
                weights: [0.5, 0.25, 0.25],
            }),
            target,
            kind: MarkKind::Soft,
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
    fn a_fingerprint_tells_places_and_kinds_but_no_names() {
        let one = landmarks(&[mark(1, Some([1.0, 2.0, 3.0]))]);
        let mut named = one.clone();
        named[0].name = Some("nose".to_owned());
        assert_eq!(fingerprint(&one), fingerprint(&named));
        let mut rigid = one.clone();
        rigid[0].kind = LandmarkKind::Rigid;
        let moved = landmarks(&[mark(1, Some([1.0, 2.0, 3.5]))]);
        assert_ne!(fingerprint(&one), fingerprint(&rigid));
        assert_ne!(fingerprint(&one), fingerprint(&moved));
    }
}
