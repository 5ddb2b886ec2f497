//! A landmark while it is being made: either of its sides may still be missing.

use mesh_core::{Landmark, LandmarkKind, MeshPoint, Point3, VertexId};
use serde::{Deserialize, Serialize};

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
