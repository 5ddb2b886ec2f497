//! What a page may ask for: a query changes nothing, an edit changes the document and can be undone, a command drives
//! the drape.

use mesh_draping::{Brush, Treatment};
use serde::{Deserialize, Serialize};

use crate::pick::Ray;
use crate::session::MarkKind;

/// Which shape a ray is aimed at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Shape {
    Source,
    Target,
    /// The source where it is shown now: a place on it is a place of the source.
    Result,
}

/// What a place that is marked goes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Snap {
    /// The nearest vertex.
    Vertex,
    /// The most curved vertex of its surroundings.
    Curvature,
}

/// One request, by its kind: `{"edit": {"do": "delete", "landmark": 3}}`, `{"command": "pause"}`.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Request {
    Query(Query),
    Edit(Edit),
    Command(Command),
    Kept(KeptRequest),
}

/// What is done with results that are kept.
#[derive(Clone, Debug, Deserialize)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum KeptRequest {
    /// Keeps what the drape came to.
    Keep,
    /// Goes back to a kept result; the present one is kept.
    BringBack { result: u32 },
}

/// What is asked without changing anything.
#[derive(Clone, Debug, Deserialize)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum Query {
    /// What is under the pointer.
    Pick { shape: Shape, ray: Ray },
    /// The triangles of a part, as ranges of rows.
    PartTriangles { name: String },
    /// The curves of the drape so far.
    Curves,
    /// The weights of attraction, one per vertex.
    Weights,
    /// What is painted rigid, one number per vertex: 1 where it is.
    Rigid,
}

/// What is painted on the source.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Layer {
    /// How strongly it is attracted.
    #[default]
    Weights,
    /// What moves as one body: where the weight is 1.
    Rigid,
}

/// One touch of the brush.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Dab {
    /// Where it is painted: on the source, or on the source as it is shown now.
    pub(crate) shape: Shape,
    pub(crate) ray: Option<Ray>,
    /// In longest sides of the source's box.
    pub(crate) radius: f64,
    #[serde(default)]
    pub(crate) layer: Layer,
    /// What the weights go to, and how far with this dab; 0..=1.
    pub(crate) weight: f64,
    pub(crate) strength: f64,
    pub(crate) done: bool,
}

impl Dab {
    /// Whether its numbers are such as a brush has.
    pub(crate) fn is_sound(&self) -> bool {
        let is_share = |x: f64| (0.0..=1.0).contains(&x);
        self.radius > 0.0 && self.radius <= 1.0 && is_share(self.weight) && is_share(self.strength)
    }
}

/// One touch of a brush on the result.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct BrushDab {
    pub(crate) brush: Brush,
    pub(crate) ray: Option<Ray>,
    /// In longest sides of the target's box.
    pub(crate) radius: f64,
    pub(crate) strength: f64,
    pub(crate) done: bool,
}

/// A change of landmarks, parts or settings.
#[derive(Clone, Debug, Deserialize)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum Edit {
    /// Marks a place: completes the landmark that is half made, or begins one.
    Place {
        shape: Shape,
        ray: Ray,
        #[serde(default)]
        snap: Option<Snap>,
    },
    /// Moves a landmark on one shape; one edit from the first ray to the one that is `done`.
    Drag {
        landmark: u32,
        shape: Shape,
        ray: Option<Ray>,
        done: bool,
        #[serde(default)]
        snap: Option<Snap>,
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
    /// Adds a place to the curve that is drawn; begins one where none is.
    Draw {
        shape: Shape,
        ray: Ray,
    },
    /// Takes the curve as it is drawn: one edit.
    EndCurve,
    /// Gives it up.
    CancelCurve,
    /// What a landmark or a curve counts.
    Weight {
        landmark: u32,
        weight: f64,
    },
    /// Paints weights of attraction on the source, or what is rigid; one edit from the first dab to the one that is `done`.
    Paint(Dab),
    /// Brushes the result; one edit from the first dab to the one that is `done`.
    Brush(BrushDab),
    /// Forgets the weights.
    ClearWeights,
    /// Forgets what is painted rigid.
    ClearRigid,
    /// Deletes all landmarks.
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
    Preset {
        name: String,
    },
    Seed {
        seed: u32,
    },
    Settings {
        toml: String,
    },
    /// Keeps the settings under a name, in the place of those that had it.
    SaveSettings {
        name: String,
    },
    /// Forgets settings that were saved under a name.
    ForgetSettings {
        name: String,
    },
    /// Takes a kept result out of the list.
    Dismiss {
        result: u32,
    },
    Undo,
    Redo,
}

/// What drives the drape.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Command {
    /// Starts a drape from the landmarks as they are; one that is over is thrown away.
    Drape,
    Pause,
    /// Goes on, with the landmarks and parts as they are.
    Resume,
    /// One iteration; begins a drape where there is none.
    Step,
    /// Ends the drape where it is and keeps the result.
    Stop,
    /// Gives a drape that is over more iterations, and goes on.
    Extend,
    /// Throws the drape away.
    Reset,
}
