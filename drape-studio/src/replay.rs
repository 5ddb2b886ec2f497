//! A recorded session, done again.

use std::path::Path;

use anyhow::{Context as _, Result};
use mesh_core::Positions;
use mesh_draping::{Pair, Preset, Source, Target};
use neural_drape::network::NetworkMap;
use neural_drape::{StepReport, Warp};

use crate::logged_run::LoggedRun;
use crate::session::{self, landmarks, InputRecord};
use crate::shapes::Shapes;

/// What a session came to.
pub struct Replayed {
    /// Source and target, with the landmarks that held at the end.
    pub pair: Pair,
    /// The settings of the drape.
    pub preset: Preset,
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
        let network = self.network.clone();
        Ok(self.pair.warp(&self.initial, &self.draped, network)?)
    }
}

/// Does the drape of a session file again, to the bit; `show` sees every step.
///
/// # Errors
/// The session or one of its inputs cannot be read, an input changed since, there is no drape in the session, or the
/// drape cannot be done.
pub fn replay(path: &Path, mut show: impl FnMut(&StepReport)) -> Result<Replayed> {
    let session = session::read(path)?;
    let name = || path.display().to_string();
    let log = session
        .run
        .as_ref()
        .context("there is no drape in this session")
        .with_context(name)?;
    let input = |record: &Option<InputRecord>| {
        let record = record.clone().context("an input was never opened");
        record.with_context(name)
    };
    let (source, target) = (input(&session.source)?, input(&session.target)?);
    source.check()?;
    target.check()?;
    let shapes = Shapes::new(Source::read(&source.path)?, Target::read(&target.path)?);
    session
        .check_places(shapes.source.rest().len())
        .with_context(name)?;

    let run = LoggedRun::replayed(&shapes, log, |step| {
        show(step);
        Ok(())
    })
    .with_context(name)?;
    Ok(Replayed {
        pair: shapes.pair(landmarks(log.last_landmarks(), &shapes.source)),
        preset: run.preset().clone(),
        initial: run.initial().clone(),
        draped: run.positions(),
        network: run.network(),
    })
}
