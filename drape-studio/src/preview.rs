//! The thread that shows what the landmarks as they are would give.

use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

use mesh_core::{Landmark, Positions};
use mesh_init::{InitConfig, InteractiveInit};

use crate::broadcast::{Broadcast, ShownKind};
use crate::course::adjusted;
use crate::figures::FiguresJob;
use crate::latest::Latest;
use crate::scene::Source;
use crate::{Scene, Settings, Toolbox};

/// Sources with more vertices than this are shown by a stand-in at once, then exactly.
const LARGE: usize = 4000;
/// Vertices of the stand-in.
const STAND_IN: usize = 3000;
/// The exact shape of a large source is found once nothing was edited for this long.
const SETTLED: Duration = Duration::from_millis(500);

/// What is to be shown of the landmarks.
#[derive(Clone)]
pub(crate) enum PreviewOf {
    /// Nothing: they are examined only.
    Nothing,
    /// The source brought to them.
    Initial,
    /// This drape, deformed further.
    Adjusted(Arc<Positions>),
}

/// What to deform.
#[derive(Clone)]
pub(crate) struct PreviewJob {
    pub(crate) number: u32,
    pub(crate) scene: Scene,
    pub(crate) settings: Settings,
    pub(crate) landmarks: Vec<Landmark>,
    pub(crate) shown: PreviewOf,
    /// The number of the newest job: an older one is not shown any more.
    pub(crate) newest: Arc<AtomicU32>,
    pub(crate) figures: Arc<Latest<FiguresJob>>,
}

/// Starts the thread; of each job, `tell` hears its number and what is suspicious about its landmarks, or why nothing
/// can be shown.
pub(crate) fn preview(
    toolbox: Arc<dyn Toolbox>,
    broadcast: Arc<Broadcast>,
    tell: impl Fn(u32, Result<Vec<String>, String>) + Send + 'static,
) -> Latest<PreviewJob> {
    Latest::start(move |job: PreviewJob| {
        if !job.is_settled() {
            return;
        }
        let outcome = show(&job, toolbox.as_ref(), &broadcast)
            .map(|mut notes| {
                let warnings = toolbox.examine(&job.scene, &job.landmarks);
                notes.extend(warnings.iter().map(|text| count_from_one(text)));
                notes
            })
            .map_err(|error| format!("{error:#}"));
        tell(job.number, outcome);
    })
}

/// Starts the thread that shows the shapes of large sources while landmarks are dragged, by a stand-in, before
/// [`preview`] has the exact ones.
pub(crate) fn live_preview(broadcast: Arc<Broadcast>) -> Latest<PreviewJob> {
    let mut live: Option<Live> = None;
    Latest::start(move |job: PreviewJob| {
        let Some(config) = job.settings.live.filter(|_| job.is_large()) else {
            return;
        };
        if !live.as_ref().is_some_and(|l| l.is_for(&job, config)) {
            live = Live::of(&job, config);
        }
        // Whatever is wrong with the landmarks is told by the exact preview.
        let shown = live.as_mut().and_then(|l| l.show(&job));
        if let Some((kind, x)) = shown.filter(|_| job.is_newest()) {
            broadcast.show(&job.scene, kind, Arc::new(x));
        }
    })
}

/// A source that is ready to be deformed at once.
struct Live {
    source: Arc<Source>,
    config: InitConfig,
    init: InteractiveInit,
}

impl Live {
    fn of(job: &PreviewJob, config: InitConfig) -> Option<Self> {
        let source = Arc::clone(&job.scene.source);
        let init = InteractiveInit::new(&source.triangulation, &source.rest, STAND_IN, config);
        Some(Self {
            init: init.ok()?,
            source,
            config,
        })
    }

    fn is_for(&self, job: &PreviewJob, config: InitConfig) -> bool {
        Arc::ptr_eq(&self.source, &job.scene.source) && self.config == config
    }

    fn show(&mut self, job: &PreviewJob) -> Option<(ShownKind, Positions)> {
        match &job.shown {
            PreviewOf::Nothing => None,
            PreviewOf::Initial => {
                let frame = job.scene.target.judged().principal_frame();
                let initial = self.init.solve(&job.landmarks, frame).ok()?;
                Some((ShownKind::Initial, initial.positions))
            }
            PreviewOf::Adjusted(present) => {
                let x = self.init.adjust(&job.landmarks, present).ok()?;
                Some((ShownKind::Adjusted, x))
            }
        }
    }
}

impl PreviewJob {
    fn is_newest(&self) -> bool {
        self.newest.load(Ordering::SeqCst) == self.number
    }

    fn is_large(&self) -> bool {
        self.scene.source.rest.len() > LARGE
    }

    /// Whether no other edit follows soon: what takes long is then begun.
    fn is_settled(&self) -> bool {
        let began = Instant::now();
        while self.is_large() && self.is_newest() && began.elapsed() < SETTLED {
            thread::sleep(SETTLED / 20);
        }
        self.is_newest()
    }
}

/// Shows the shape; what had to be assumed for it.
fn show(
    job: &PreviewJob,
    toolbox: &dyn Toolbox,
    broadcast: &Broadcast,
) -> anyhow::Result<Vec<String>> {
    let mut assumed = Vec::new();
    let (kind, x) = match &job.shown {
        PreviewOf::Nothing => return Ok(assumed),
        PreviewOf::Adjusted(present) => (
            ShownKind::Adjusted,
            adjusted(&job.scene, &job.landmarks, present)?,
        ),
        PreviewOf::Initial => {
            let deformed = toolbox.deform(&job.scene, &job.landmarks, &job.settings)?;
            assumed = deformed.assumed;
            (ShownKind::Initial, deformed.positions)
        }
    };
    if !job.is_newest() {
        return Ok(assumed);
    }
    let x = Arc::new(x);
    broadcast.show(&job.scene, kind, Arc::clone(&x));
    job.figures.ask(FiguresJob {
        scene: job.scene.clone(),
        positions: x,
        landmarks: job.landmarks.clone(),
        iteration: None,
        is_resting: true,
    });
    Ok(assumed)
}

/// The command line counts landmarks from 0, as its files do; the page numbers its markers from 1.
fn count_from_one(text: &str) -> String {
    let mut parts = text.split("landmark ");
    let mut counted = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let n_digits = part.bytes().take_while(u8::is_ascii_digit).count();
        let (digits, rest) = part.split_at(n_digits);
        counted += "landmark ";
        match digits.parse::<usize>() {
            Ok(n) => counted += &(n + 1).to_string(),
            Err(_) => counted += digits,
        }
        counted += rest;
    }
    counted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_landmarks_are_those_of_the_markers() {
        for (from_zero, from_one) in [
            (
                "landmark 0 (nose) and landmark 9 are the same",
                "landmark 1 (nose) and landmark 10 are the same",
            ),
            (
                "1 landmark: few; 3 landmarks",
                "1 landmark: few; 3 landmarks",
            ),
            ("the landmarks fit", "the landmarks fit"),
        ] {
            assert_eq!(count_from_one(from_zero), from_one);
        }
    }
}
