//! The thread that drapes.

use std::path::PathBuf;
use std::sync::mpsc::{channel, Receiver, Sender, TryRecvError};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{ensure, Result};
use mesh_draping::{Draping, Parts, Stroke};
use neural_drape::StepReport;
use serde_json::json;

use crate::broadcast::{Broadcast, Provenance};
use crate::checkpoint::{self, Checkpoint, History};
use crate::displayed::DisplayedPair;
use crate::figures::FiguresJob;
use crate::latest::Latest;
use crate::logged_run::{LoggedRun, SavedRun};
use crate::session::{landmarks, Mark, RunLog};

/// Shapes are shown at most this often.
const FRAME_INTERVAL: Duration = Duration::from_millis(33);
/// A killed server loses this much, and the time that writing takes.
const SAVE_INTERVAL: Duration = Duration::from_secs(1);
/// Live figures are asked for at most this often.
const FIGURES_INTERVAL: Duration = Duration::from_millis(1000);

/// What the thread is told.
pub(crate) enum Order {
    Go,
    Pause,
    Step,
    Marks(Vec<Mark>),
    Parts(Parts),
    /// These strokes of brushes hold.
    Strokes(Vec<Stroke>),
    /// It gets more iterations.
    Extend,
    /// To stand still, shown and saved, and to say so here.
    Rest(Sender<()>),
}

/// What the thread tells.
pub(crate) enum Update {
    /// It stands still, ready to go on.
    Paused(RunLog),
    /// It goes.
    Running,
    /// Something was done to it.
    Changed(RunLog),
    /// The last iteration is done.
    Finished(RunLog),
    /// It cannot go on.
    Failed(String),
}

/// What a drape needs.
pub(crate) struct RunnerParts {
    pub(crate) displayed: DisplayedPair,
    pub(crate) broadcast: Arc<Broadcast>,
    pub(crate) figures: Arc<Latest<FiguresJob>>,
    /// Where it is kept.
    pub(crate) checkpoint: PathBuf,
    pub(crate) log: RunLog,
    /// Where to go on; from the start where there is none.
    pub(crate) saved: Option<SavedRun>,
}

/// A handle on the thread; when this is dropped, it shows and saves nothing any more, and ends.
pub(crate) struct Runner {
    orders: Sender<Order>,
    is_wanted: Arc<Mutex<bool>>,
}

impl Drop for Runner {
    fn drop(&mut self) {
        *lock(&self.is_wanted) = false;
    }
}

fn lock(is_wanted: &Mutex<bool>) -> MutexGuard<'_, bool> {
    is_wanted.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Runner {
    /// Starts the thread, which begins with a pause; `tell` is called from it.
    pub(crate) fn start(parts: RunnerParts, tell: impl Fn(Update) + Send + 'static) -> Self {
        let (sender, orders) = channel();
        let is_wanted = Arc::new(Mutex::new(true));
        let wanted = Arc::clone(&is_wanted);
        thread::spawn(move || {
            if let Err(error) = run(&parts, &wanted, &orders, &tell) {
                tell(Update::Failed(format!("{error:#}")));
            }
        });
        Self {
            orders: sender,
            is_wanted,
        }
    }

    pub(crate) fn order(&self, order: Order) {
        // A thread that failed has told so; it takes no more orders.
        drop(self.orders.send(order));
    }
}

fn run(
    parts: &RunnerParts,
    is_wanted: &Mutex<bool>,
    orders: &Receiver<Order>,
    tell: &dyn Fn(Update),
) -> Result<()> {
    let shapes = &parts.displayed.shapes;
    let drape = match &parts.saved {
        Some(saved) => LoggedRun::restored(shapes, parts.log.clone(), saved)?,
        None => LoggedRun::replayed(shapes, &parts.log, |step| {
            ensure!(*lock(is_wanted), "the drape was given up");
            parts.broadcast.record_step(step);
            Ok(())
        })?,
    };
    let mut run = Run {
        n_more: Draping::n_more(drape.preset()),
        parts,
        is_wanted,
        drape,
        tell,
        shown: Instant::now(),
        saved: Instant::now(),
        judged: Instant::now(),
        pace: Pace::default(),
    };
    run.tell_progress(None);
    run.show();
    run.save()?;
    let log = run.drape.log().clone();
    let is_over = run.drape.is_over();
    if is_over {
        run.judge(true);
    }
    tell(if is_over {
        Update::Finished(log)
    } else {
        Update::Paused(log)
    });
    run.obey(orders)
}

struct Run<'a> {
    parts: &'a RunnerParts,
    is_wanted: &'a Mutex<bool>,
    drape: LoggedRun,
    n_more: usize,
    tell: &'a dyn Fn(Update),
    shown: Instant,
    saved: Instant,
    judged: Instant,
    pace: Pace,
}

impl Run<'_> {
    /// Follows orders until nobody gives any.
    fn obey(&mut self, orders: &Receiver<Order>) -> Result<()> {
        let mut is_running = false;
        loop {
            let order = match (is_running, orders.try_recv()) {
                (_, Ok(order)) => Some(order),
                (true, Err(TryRecvError::Empty)) => None,
                (false, Err(TryRecvError::Empty)) => match orders.recv() {
                    Ok(order) => Some(order),
                    Err(_) => return Ok(()),
                },
                (_, Err(TryRecvError::Disconnected)) => return Ok(()),
            };
            match order {
                None => is_running = self.advance()?,
                Some(Order::Go) => {
                    is_running = true;
                    self.pace = Pace::default();
                    (self.tell)(Update::Running);
                }
                Some(Order::Pause) if is_running => {
                    is_running = false;
                    self.rest(Update::Paused(self.drape.log().clone()))?;
                }
                Some(Order::Pause) => {}
                Some(Order::Rest(rested)) => {
                    if std::mem::take(&mut is_running) {
                        self.rest(Update::Paused(self.drape.log().clone()))?;
                    }
                    // Whoever asked may have lost patience.
                    rested.send(()).ok();
                }
                Some(Order::Step) => {
                    is_running = false;
                    if self.advance()? {
                        self.rest(Update::Paused(self.drape.log().clone()))?;
                    }
                }
                Some(order) => self.change(order)?,
            }
        }
    }

    /// One iteration; false when it was the last.
    fn advance(&mut self) -> Result<bool> {
        let began = Instant::now();
        let step = self.drape.step()?;
        if let Some(step) = &step {
            self.pace.add(began.elapsed());
            self.parts.broadcast.record_step(step);
        }
        let is_over = self.drape.is_over();
        if self.shown.elapsed() >= FRAME_INTERVAL || is_over {
            self.show();
            self.tell_progress(step.as_ref());
        }
        if self.judged.elapsed() >= FIGURES_INTERVAL {
            self.judge(false);
        }
        if self.saved.elapsed() >= SAVE_INTERVAL {
            self.save()?;
        }
        if is_over {
            self.rest(Update::Finished(self.drape.log().clone()))?;
        }
        Ok(!is_over)
    }

    /// Does something to the drape; what holds already is not done again.
    fn change(&mut self, order: Order) -> Result<()> {
        match order {
            Order::Marks(marks) if marks != self.drape.log().last_landmarks() => {
                self.drape.set_marks(marks)?;
            }
            Order::Parts(parts) if parts != *self.drape.log().last_parts() => {
                self.drape.set_parts(parts)?;
            }
            Order::Strokes(strokes) if !self.drape.log().strokes().into_iter().eq(&strokes) => {
                self.drape.set_strokes(&strokes)?;
                self.judge(true);
            }
            Order::Extend => self.drape.extend(self.n_more),
            _ => return Ok(()),
        }
        self.save()?;
        self.show();
        self.tell_progress(None);
        (self.tell)(Update::Changed(self.drape.log().clone()));
        Ok(())
    }

    /// Stands still: everything is shown, judged and saved.
    fn rest(&mut self, news: Update) -> Result<()> {
        self.show();
        self.judge(true);
        self.save()?;
        (self.tell)(news);
        Ok(())
    }

    fn show(&mut self) {
        let Self { parts, drape, .. } = self;
        let x = Arc::new(drape.positions());
        let provenance = Provenance {
            log: drape.log().clone(),
            network: drape.network(),
            counterparts: Arc::new(drape.counterparts()),
        };
        let is_wanted = lock(self.is_wanted);
        if *is_wanted {
            parts.broadcast.show_drape(&parts.displayed, x, provenance);
        }
        self.shown = Instant::now();
    }

    fn judge(&mut self, is_resting: bool) {
        let log = self.drape.log();
        self.parts.figures.ask(FiguresJob {
            displayed: self.parts.displayed.clone(),
            positions: Arc::new(self.drape.positions()),
            counterparts: Arc::new(self.drape.counterparts()),
            landmarks: landmarks(log.last_landmarks(), &self.parts.displayed.shapes.source),
            iteration: Some(log.iteration),
            is_resting,
        });
        self.judged = Instant::now();
    }

    fn save(&mut self) -> Result<()> {
        let checkpoint = Checkpoint {
            saved: self.drape.saved(),
            history: History {
                log: self.drape.log().clone(),
                curves: self.parts.broadcast.curves(),
            },
        };
        let is_wanted = lock(self.is_wanted);
        if *is_wanted {
            checkpoint::write(&self.parts.checkpoint, &checkpoint)?;
        }
        self.saved = Instant::now();
        Ok(())
    }

    fn tell_progress(&self, step: Option<&StepReport>) {
        let done = self.drape.log().iteration;
        let n = self.drape.n_iterations();
        let terms = step.iter().flat_map(|step| &step.terms);
        let terms: Vec<_> = terms.map(|t| json!([t.name, t.value * t.weight])).collect();
        let message = json!({
            "type": "progress",
            "iteration": done,
            "n_iterations": n,
            "seconds_left": self.pace.seconds_per_step() * n.saturating_sub(done) as f64,
            "loss": step.map(|step| step.total),
            "terms": terms,
        });
        let text = Arc::from(message.to_string());
        let is_wanted = lock(self.is_wanted);
        if *is_wanted {
            self.parts.broadcast.progress.send_replace(text);
        }
    }
}

/// How long a step takes: a running mean.
#[derive(Default)]
struct Pace {
    mean: Option<f64>,
}

impl Pace {
    fn add(&mut self, step: Duration) {
        let seconds = step.as_secs_f64();
        self.mean = Some(
            self.mean
                .map_or(seconds, |mean| 0.95 * mean + 0.05 * seconds),
        );
    }

    fn seconds_per_step(&self) -> f64 {
        self.mean.unwrap_or(0.0)
    }
}
