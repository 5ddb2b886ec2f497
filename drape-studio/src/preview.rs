//! The thread that shows what the landmarks as they are would give.

use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

use mesh_core::{Landmark, Positions};
use mesh_draping::{adjusted, initial_deformation, Error, InitialMethod, Note, Source};
use mesh_init::{InitConfig, InteractiveInit};
use mesh_metrics::Counterparts;

use crate::broadcast::{Broadcast, ShownKind};
use crate::displayed::DisplayedPair;
use crate::figures::FiguresJob;
use crate::latest::Latest;

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
    pub(crate) displayed: DisplayedPair,
    pub(crate) method: InitialMethod,
    pub(crate) landmarks: Vec<Landmark>,
    pub(crate) shown: PreviewOf,
    /// The number of the newest job: an older one is not shown any more.
    pub(crate) newest: Arc<AtomicU32>,
    pub(crate) figures: Arc<Latest<FiguresJob>>,
}

/// Starts the thread; of each job, `tell` hears its number and what is suspicious about its landmarks, or why nothing
/// can be shown.
pub(crate) fn preview(
    broadcast: Arc<Broadcast>,
    tell: impl Fn(u32, Result<Vec<String>, String>) + Send + 'static,
) -> Latest<PreviewJob> {
    Latest::start(move |job: PreviewJob| {
        if !job.is_settled() {
            return;
        }
        let outcome = show(&job, &broadcast).map(|notes| {
            let notes = notes.iter().map(ToString::to_string);
            notes.chain(warnings(&job)).collect()
        });
        tell(job.number, outcome.map_err(|error| error.to_string()));
    })
}

/// Starts the thread that shows the shapes of large sources while landmarks are dragged, by a stand-in, before
/// [`preview`] has the exact ones.
pub(crate) fn live_preview(broadcast: Arc<Broadcast>) -> Latest<PreviewJob> {
    let mut live: Option<Live> = None;
    Latest::start(move |job: PreviewJob| {
        let Some(config) = job.method.config().filter(|_| job.is_large()) else {
            return;
        };
        if !live.as_ref().is_some_and(|l| l.is_for(&job, config)) {
            live = Live::of(&job, config);
        }
        // Whatever is wrong with the landmarks is told by the exact preview.
        let shown = live.as_mut().and_then(|l| l.show(&job));
        if let Some((kind, x)) = shown.filter(|_| job.is_newest()) {
            broadcast.show(&job.displayed, kind, Arc::new(x));
        }
    })
}

/// A source that is ready to be deformed at once.
struct Live {
    source: Source,
    config: InitConfig,
    init: InteractiveInit,
}

impl Live {
    fn of(job: &PreviewJob, config: InitConfig) -> Option<Self> {
        let source = job.displayed.shapes.source.clone();
        let init = InteractiveInit::new(source.triangulation(), source.rest(), STAND_IN, config);
        Some(Self {
            init: init.ok()?,
            source,
            config,
        })
    }

    fn is_for(&self, job: &PreviewJob, config: InitConfig) -> bool {
        self.source.is_same(&job.displayed.shapes.source) && self.config == config
    }

    fn show(&mut self, job: &PreviewJob) -> Option<(ShownKind, Positions)> {
        match &job.shown {
            PreviewOf::Nothing => None,
            PreviewOf::Initial => {
                let frame = job.displayed.target.judged().principal_frame();
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
        self.displayed.shapes.source.rest().len() > LARGE
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
fn show(job: &PreviewJob, broadcast: &Broadcast) -> Result<Vec<Note>, Error> {
    let pair = job.displayed.shapes.pair(job.landmarks.clone());
    let mut notes = Vec::new();
    let (kind, x) = match &job.shown {
        PreviewOf::Nothing => return Ok(notes),
        PreviewOf::Adjusted(present) => (ShownKind::Adjusted, adjusted(&pair, present)?),
        PreviewOf::Initial => {
            let initial = initial_deformation(&pair, job.method)?;
            notes = initial.notes;
            (ShownKind::Initial, initial.positions)
        }
    };
    if !job.is_newest() {
        return Ok(notes);
    }
    let x = Arc::new(x);
    broadcast.show(&job.displayed, kind, Arc::clone(&x));
    job.figures.ask(FiguresJob {
        displayed: job.displayed.clone(),
        counterparts: Arc::new(Counterparts::all(x.len())),
        positions: x,
        landmarks: job.landmarks.clone(),
        iteration: None,
        is_resting: true,
    });
    Ok(notes)
}

/// What is suspicious about the landmarks, what was found in the files, and what of the target was left out.
fn warnings(job: &PreviewJob) -> Vec<String> {
    let pair = job.displayed.shapes.pair(job.landmarks.clone());
    let findings = pair.findings().into_iter();
    let findings = findings.map(|finding| finding.to_string());
    let notes = pair.notes();
    let left_out = notes.iter().map(ToString::to_string);
    findings.chain(left_out).collect()
}
