//! What the studio borrows from the program that starts it, so that both always do the same.

use std::path::Path;
use std::sync::Arc;

use mesh_core::{Landmark, Positions, TargetSurface, VertexId};
use mesh_init::InitConfig;
use neural_drape::{DrapeConfig, Regions};
use serde::{Deserialize, Serialize};

use crate::Scene;

/// Settings of a run.
#[derive(Clone, Debug)]
pub struct Settings {
    /// All of them as a TOML file, from which they can be read again.
    pub toml: String,
    /// The preset that they come from.
    pub preset: String,
    /// Those of the drape itself.
    pub config: DrapeConfig,
    /// How landmarks deform a large source while they are dragged; none where only the exact shape will do.
    pub live: Option<InitConfig>,
}

/// A target as the command line takes it.
pub struct TargetParts {
    /// What is draped over.
    pub over: Arc<dyn TargetSurface>,
    /// What results are judged by.
    pub judged: Arc<dyn TargetSurface>,
}

/// Parts of the source that are not draped like the rest, by name.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Parts {
    /// Those that attract nothing and are carried along.
    pub free: Vec<String>,
    /// Those whose pieces move as one body each.
    pub rigid: Vec<String>,
    /// Inner parts that are draped like the rest, although nobody sees them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub draped: Vec<String>,
}

/// How a part is draped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Treatment {
    /// Like the rest.
    Draped,
    /// It attracts nothing and is carried along.
    Free,
    /// Its pieces move as one body each.
    Rigid,
}

/// An inner part of a source: no ray from outside reaches it.
#[derive(Clone, Debug)]
pub struct InnerPart {
    /// Its name in [`Parts`].
    pub name: String,
    /// What it is, in few words.
    pub label: String,
    /// What it is, in more words.
    pub about: String,
    /// Its vertices.
    pub vertices: Vec<VertexId>,
    /// How it had best be treated.
    pub proposed: Treatment,
    /// How it is treated as long as nobody says otherwise.
    pub unasked: Treatment,
}

/// The source brought to its landmarks.
pub struct Deformed {
    /// In the target's coordinates.
    pub positions: Positions,
    /// What had to be assumed, in words.
    pub assumed: Vec<String>,
}

/// A result and what it came from, for a report.
#[derive(Clone, Copy)]
pub struct Finished<'a> {
    /// Source and target.
    pub scene: &'a Scene,
    /// The landmarks that led to it.
    pub landmarks: &'a [Landmark],
    /// The settings that led to it.
    pub settings: &'a Settings,
    /// Where the drape started.
    pub initial: &'a Positions,
    /// The result.
    pub draped: &'a Positions,
}

/// How the command line reads settings and landmark files, deforms, examines and reports.
pub trait Toolbox: Send + Sync {
    /// The names of all presets, the default first.
    fn presets(&self) -> Vec<String>;

    /// Reads settings; an empty text gives the default preset.
    ///
    /// # Errors
    /// What is wrong with the text, and where.
    fn settings(&self, toml: &str) -> anyhow::Result<Settings>;

    /// Reads a target.
    ///
    /// # Errors
    /// The file cannot be read, or holds no surface.
    fn read_target(&self, path: &Path) -> anyhow::Result<TargetParts>;

    /// Brings the source to its landmarks, in the way of `settings`.
    ///
    /// # Errors
    /// The landmarks do not fit the source, or no deformation can be found.
    fn deform(
        &self,
        scene: &Scene,
        landmarks: &[Landmark],
        settings: &Settings,
    ) -> anyhow::Result<Deformed>;

    /// Looks parts up; inner pieces that nobody named are found. What was decided without being asked, in words.
    ///
    /// # Errors
    /// The source has no such part, or nothing would be left to drape.
    fn regions(&self, scene: &Scene, parts: &Parts) -> anyhow::Result<(Regions, Vec<String>)>;

    /// The inner parts of the source, largest first.
    ///
    /// # Errors
    /// The scene cannot be worked on.
    fn inner_parts(&self, scene: &Scene) -> anyhow::Result<Vec<InnerPart>>;

    /// Everything suspicious about the inputs and landmarks, in words.
    fn examine(&self, scene: &Scene, landmarks: &[Landmark]) -> Vec<String>;

    /// Reads a landmark file.
    ///
    /// # Errors
    /// What is wrong with the file, and where.
    fn read_landmarks(&self, scene: &Scene, path: &Path) -> anyhow::Result<Vec<Landmark>>;

    /// The report page of a result.
    ///
    /// # Errors
    /// A picture cannot be drawn or a figure not be computed.
    fn report(&self, finished: Finished<'_>) -> anyhow::Result<String>;
}
