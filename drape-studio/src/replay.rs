//! A recorded session, done again.

use std::path::Path;
use std::sync::Arc;

use anyhow::{Context as _, Result};
use mesh_core::{Landmark, Positions};
use neural_drape::StepReport;

use crate::course::{Course, Start};
use crate::session::{self, landmarks};
use crate::{Scene, Settings, Source, Target, Toolbox};

/// What a session came to.
pub struct Replayed {
    /// Source and target.
    pub scene: Scene,
    /// The landmarks that held at the end.
    pub landmarks: Vec<Landmark>,
    /// The settings of the drape.
    pub settings: Settings,
    /// Where it started.
    pub initial: Positions,
    /// The result.
    pub draped: Positions,
}

/// Does the drape of a session file again, to the bit; `show` sees every step.
///
/// # Errors
/// The session or one of its inputs cannot be read, an input changed since, there is no drape in the session, or the
/// drape cannot be done.
pub fn replay(
    path: &Path,
    toolbox: &dyn Toolbox,
    show: impl FnMut(&StepReport),
) -> Result<Replayed> {
    let session = session::read(path)?;
    let name = || path.display().to_string();
    let log = session
        .run
        .as_ref()
        .context("there is no drape in this session")
        .with_context(name)?;
    let input = |record: &Option<session::InputRecord>| {
        let record = record.clone().context("an input was never opened");
        record.with_context(name)
    };
    let (source, target) = (input(&session.source)?, input(&session.target)?);
    source.check()?;
    target.check()?;
    let scene = Scene {
        source: Arc::new(Source::read(&source.path)?),
        target: Arc::new(Target::read(&target.path, toolbox)?),
    };
    session
        .check_places(scene.source.rest.len())
        .with_context(name)?;

    let start = Start::new(&scene, toolbox, log)?;
    let draped = Course::replayed(&scene, &start, log, show)
        .with_context(name)?
        .positions();
    Ok(Replayed {
        landmarks: landmarks(log.last_landmarks()),
        settings: start.settings,
        initial: start.initial,
        draped,
        scene,
    })
}
