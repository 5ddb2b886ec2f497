//! The thread that shows what the landmarks as they are would give.

use std::sync::mpsc::Sender;
use std::sync::Arc;

use mesh_core::{Landmark, Positions};

use crate::course::adjusted;
use crate::desk::Inbox;
use crate::figures::FiguresJob;
use crate::hub::{FrameKind, Hub};
use crate::latest::Latest;
use crate::{Scene, Settings, Toolbox};

/// What is to be shown of the landmarks.
pub(crate) enum Shown {
    /// Nothing: they are examined only.
    Nothing,
    /// The source brought to them.
    Initial,
    /// This drape, deformed further.
    Adjusted(Arc<Positions>),
}

/// What to deform.
pub(crate) struct PreviewJob {
    pub(crate) number: u32,
    pub(crate) scene: Scene,
    pub(crate) settings: Settings,
    pub(crate) landmarks: Vec<Landmark>,
    pub(crate) shown: Shown,
    pub(crate) figures: Arc<Latest<FiguresJob>>,
}

/// Starts the thread; it tells the desk what is suspicious about the landmarks.
pub(crate) fn preview(
    toolbox: Arc<dyn Toolbox>,
    hub: Arc<Hub>,
    desk: Sender<Inbox>,
) -> Latest<PreviewJob> {
    Latest::start(move |job: PreviewJob| {
        let outcome = show(&job, toolbox.as_ref(), &hub)
            .map(|()| toolbox.examine(&job.scene, &job.landmarks))
            .map_err(|error| format!("{error:#}"));
        // The desk is gone only when the server ends.
        drop(desk.send(Inbox::Previewed(job.number, outcome)));
    })
}

fn show(job: &PreviewJob, toolbox: &dyn Toolbox, hub: &Hub) -> anyhow::Result<()> {
    let (kind, x) = match &job.shown {
        Shown::Nothing => return Ok(()),
        Shown::Adjusted(present) => (
            FrameKind::Adjusted,
            adjusted(&job.scene, &job.landmarks, present)?,
        ),
        Shown::Initial => (
            FrameKind::Initial,
            toolbox.deform(&job.scene, &job.landmarks, &job.settings)?,
        ),
    };
    let x = Arc::new(x);
    hub.show(&job.scene, kind, 0, Arc::clone(&x));
    job.figures.ask(FiguresJob {
        scene: job.scene.clone(),
        positions: x,
        landmarks: job.landmarks.clone(),
        iteration: None,
        is_resting: true,
    });
    Ok(())
}
