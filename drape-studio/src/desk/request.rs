//! What a page may ask for.

use serde::Deserialize;

use crate::pick::Ray;
use crate::session::MarkKind;
use crate::Treatment;

/// Which shape a ray is aimed at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Side {
    Source,
    Target,
    /// The source where it is shown now: a place on it is a place of the source.
    Result,
}

/// One request.
#[derive(Clone, Debug, Deserialize)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum Request {
    /// What is under the pointer, changing nothing.
    Pick {
        side: Side,
        ray: Ray,
    },
    /// Marks a place: completes the landmark that is half made, or begins one.
    Place {
        side: Side,
        ray: Ray,
    },
    /// Moves one side of a landmark; one edit from the first ray to the one that is `done`.
    Drag {
        landmark: u32,
        side: Side,
        ray: Option<Ray>,
        done: bool,
    },
    Delete {
        landmark: u32,
    },
    Rename {
        landmark: u32,
        name: String,
    },
    Kind {
        landmark: u32,
        kind: MarkKind,
    },
    Clear,
    /// Axes of source and target across which landmarks are placed twice.
    Mirror {
        axes: Option<[usize; 2]>,
    },
    /// How a part of the source is treated.
    Part {
        name: String,
        treatment: Treatment,
    },
    /// The triangles of a part, as ranges of rows.
    PartFaces {
        name: String,
    },
    Undo,
    Redo,
    Preset {
        name: String,
    },
    Seed {
        seed: u32,
    },
    Settings {
        toml: String,
    },
    /// Starts a drape from the landmarks as they are.
    Drape,
    Pause,
    Resume,
    Step,
    /// Ends the drape where it is and keeps the result.
    Stop,
    /// Gives the drape more iterations, and goes on where it was over.
    Extend,
    /// Throws the drape away.
    Reset,
    /// The curves of the run so far.
    Curves,
}
