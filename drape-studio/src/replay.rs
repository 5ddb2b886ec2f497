//! A recorded session, done again.

use std::path::Path;
use std::sync::Arc;

use anyhow::{Context as _, Result};
use mesh_core::{Landmark, Positions};
use neural_drape::network::NetworkMap;
use neural_drape::{StepReport, Warp, WarpInput};

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
    /// The network behind it; none where there is none, or where it alone did not come to the result.
    pub network: Option<NetworkMap>,
}

impl Replayed {
    /// What the drape did to space.
    ///
    /// # Errors
    /// The map cannot be made of these shapes.
    pub fn warp(&self) -> Result<Warp> {
        let source = &self.scene.source;
        Ok(Warp::new(WarpInput {
            triangulation: &source.triangulation,
            rest: &source.rest,
            initial: &self.initial,
            draped: &self.draped,
            network: self.network.clone(),
        })?)
    }
}

/// Does the drape of a session file again, to the bit; `show` sees every step.
///
/// # Errors
/// The session or one of its inputs cannot be read, an input changed since, there is no drape in the session, or the
/// drape cannot be done.
pub fn replay(
    path: &Path,
    toolbox: &dyn Toolbox,
    mut show: impl FnMut(&StepReport),
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
    let course = Course::replayed(&start, log, |step| {
        show(step);
        Ok(())
    })
    .with_context(name)?;
    let (draped, network) = (course.positions(), course.network());
    drop(course);
    Ok(Replayed {
        landmarks: landmarks(log.last_landmarks()),
        settings: start.settings.clone(),
        initial: start.initial.clone(),
        draped,
        network,
        scene,
    })
}
