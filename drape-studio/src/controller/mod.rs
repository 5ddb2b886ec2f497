//! The one place that changes the session: requests and news come in, the newest state goes out.

mod brush;
mod can;
mod commands;
mod drawing;
mod edits;
mod history;
mod paint;
mod parts;
mod places;
mod queries;
mod request;
mod scans;
mod state;

pub(crate) use can::OPEN_FIRST;
use can::{Situation, Status};
pub(crate) use request::Request;
use request::{Command, Edit, Query, Shape};
pub(crate) use scans::OpenedSession;

use std::path::PathBuf;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::{channel, Receiver, RecvTimeoutError, Sender};
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

use mesh_core::{Landmark, TriangleBvh};
use mesh_draping::Preset;
use serde_json::Value;
use tokio::sync::oneshot;

use crate::broadcast::{Broadcast, Provenance, ShownKind, ShownShape};
use crate::checkpoint;
use crate::displayed::{DisplayedPair, DisplayedSource, DisplayedTarget};
use crate::figures::{judge, FiguresJob};
use crate::kept_files::KeptFiles;
use crate::latest::Latest;
use crate::preview::{live_preview, preview, PreviewJob, PreviewOf};
use crate::runner::{Runner, Update};
use crate::session::{Document, InputRecord, Lines, RunLog, Session};
use crate::shapes::Shapes;

/// Edits are on disk after this long.
const SAVE_DELAY: Duration = Duration::from_millis(400);

/// What comes to the controller.
pub(crate) enum Inbox {
    Request(Request, oneshot::Sender<Result<Value, String>>),
    Opened(Opened, oneshot::Sender<Result<(), String>>),
    Snapshot(oneshot::Sender<Snapshot>),
    /// From the runner of this number.
    Update(u32, Update),
    /// From the preview of this number.
    Previewed(u32, Result<Vec<String>, String>),
    /// The inner surfaces of these are known.
    LookedInside(Shapes),
    /// A kept result is drawn and judged.
    Examined(u32, Value),
}

/// A file that was opened.
pub(crate) enum Opened {
    Source(Arc<DisplayedSource>, InputRecord),
    Target(Arc<DisplayedTarget>, InputRecord),
    Landmarks(Vec<Landmark>),
    /// A file that a mesh names: there is nothing to show of it alone.
    Beside,
    /// A target for later.
    Queued(InputRecord),
    Session(Box<OpenedSession>),
}

/// Everything that an export needs.
pub(crate) struct Snapshot {
    pub(crate) session: Session,
    pub(crate) source: Option<Arc<DisplayedSource>>,
    pub(crate) target: Option<Arc<DisplayedTarget>>,
    /// The two, where both are open.
    pub(crate) displayed: Option<DisplayedPair>,
    /// The shape that is shown; where there is a drape, that, with how it came about.
    pub(crate) shown: Option<Arc<ShownShape>>,
}

/// A drape and its thread.
struct ActiveRun {
    number: u32,
    runner: Runner,
    status: Status,
    /// Why it failed.
    error: Option<String>,
    log: RunLog,
    /// How many iterations it gets when it is to go on longer.
    n_more: usize,
}

/// How to reach the controller.
#[derive(Clone)]
pub(crate) struct ControllerHandle(Sender<Inbox>);

impl ControllerHandle {
    pub(crate) fn send(&self, message: Inbox) {
        // The controller lives as long as the server.
        drop(self.0.send(message));
    }
}

/// What a controller is provenance of.
pub(crate) struct ControllerParts {
    pub(crate) broadcast: Arc<Broadcast>,
    pub(crate) session: Session,
    pub(crate) source: Option<Arc<DisplayedSource>>,
    pub(crate) target: Option<Arc<DisplayedTarget>>,
    pub(crate) session_path: PathBuf,
    /// What the user should know at first.
    pub(crate) notice: Option<String>,
}

pub(crate) struct Controller {
    broadcast: Arc<Broadcast>,
    inbox: Sender<Inbox>,
    session: Session,
    session_path: PathBuf,
    /// Where kept results and other sessions are.
    files: KeptFiles,
    source: Option<Arc<DisplayedSource>>,
    target: Option<Arc<DisplayedTarget>>,
    /// The two, where both are open.
    displayed: Option<DisplayedPair>,
    /// The document's settings, read.
    preset: Preset,
    run: Option<ActiveRun>,
    n_runs: u32,
    preview: Latest<PreviewJob>,
    live: Latest<PreviewJob>,
    n_previews: u32,
    newest_preview: Arc<AtomicU32>,
    figures: Arc<Latest<FiguresJob>>,
    warnings: Vec<String>,
    preview_error: Option<String>,
    notice: Option<String>,
    /// The document before the drag that goes on.
    dragged_from: Option<Document>,
    /// The curve that is being drawn.
    drawing: Option<Lines>,
    /// The stroke of the brush that goes on.
    stroke: Option<paint::Stroke>,
    /// The stroke on the result that goes on.
    brushing: Option<brush::Brushing>,
    /// The shape shown under this number, to pick on.
    shown_bvh: Option<(u32, TriangleBvh)>,
    revision: u64,
    /// When the session last changed without being saved.
    unsaved_since: Option<Instant>,
}

impl Controller {
    /// Starts the controller's thread.
    pub(crate) fn start(parts: ControllerParts) -> anyhow::Result<ControllerHandle> {
        let (inbox, messages) = channel();
        let previewed = inbox.clone();
        let preset = Preset::from_toml(&parts.session.document.settings)?;
        let mut controller = Self {
            figures: Arc::new(judge(Arc::clone(&parts.broadcast))),
            preview: preview(Arc::clone(&parts.broadcast), move |number, found| {
                drop(previewed.send(Inbox::Previewed(number, found)))
            }),
            live: live_preview(Arc::clone(&parts.broadcast)),
            inbox: inbox.clone(),
            broadcast: parts.broadcast,
            session: parts.session,
            files: KeptFiles::beside(&parts.session_path),
            session_path: parts.session_path,
            displayed: both(parts.source.as_ref(), parts.target.as_ref()),
            source: parts.source,
            target: parts.target,
            preset,
            run: None,
            n_runs: 0,
            n_previews: 0,
            newest_preview: Arc::default(),
            warnings: Vec::new(),
            preview_error: None,
            notice: parts.notice,
            dragged_from: None,
            drawing: None,
            stroke: None,
            brushing: None,
            shown_bvh: None,
            revision: 0,
            unsaved_since: Some(Instant::now()),
        };
        let displayed = controller.displayed.clone();
        controller.broadcast.set_displayed(displayed);
        controller.take_up_run();
        controller.look_inside();
        controller.ask_preview();
        controller.publish();
        thread::spawn(move || controller.work(&messages));
        Ok(ControllerHandle(inbox))
    }

    fn work(&mut self, messages: &Receiver<Inbox>) {
        loop {
            let wait = self.unsaved_since.map_or(Duration::from_secs(3600), |at| {
                SAVE_DELAY.saturating_sub(at.elapsed())
            });
            match messages.recv_timeout(wait) {
                Ok(message) => self.handle(message),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return,
            }
            if self
                .unsaved_since
                .is_some_and(|at| at.elapsed() >= SAVE_DELAY)
            {
                self.save();
            }
        }
    }

    fn handle(&mut self, message: Inbox) {
        match message {
            Inbox::Request(request, reply) => {
                let answer = self.answer(request).map_err(|e| format!("{e:#}"));
                // A page that is gone needs no answer.
                drop(reply.send(answer));
            }
            Inbox::Opened(opened, reply) => {
                let answer = self.open(opened).map_err(|e| format!("{e:#}"));
                drop(reply.send(answer));
            }
            Inbox::Snapshot(reply) => {
                if self.are_strokes_pending() {
                    // Where it does not come to rest, what is shown is taken.
                    drop(self.bring_to_rest());
                }
                drop(reply.send(self.snapshot()));
            }
            Inbox::Update(number, news) => self.hear(number, news),
            Inbox::Previewed(number, outcome) if number == self.n_previews => {
                match outcome {
                    Ok(warnings) => (self.warnings, self.preview_error) = (warnings, None),
                    Err(error) => self.preview_error = Some(error),
                }
                self.publish();
            }
            Inbox::Previewed(..) => {}
            Inbox::LookedInside(shapes) => self.looked_inside(&shapes),
            Inbox::Examined(id, figures) => self.examined(id, figures),
        }
    }

    /// Does what a page asks for.
    fn answer(&mut self, request: Request) -> anyhow::Result<Value> {
        match request {
            Request::Query(query) => Ok(self.look_up(&query)),
            Request::Edit(edit) => self.make(edit),
            Request::Kept(kept) => self.handle_kept(kept),
            Request::Command(command) => self.drive(command).map(|()| Value::Null),
        }
    }

    /// All that decides what can be done.
    fn situation(&self) -> Situation {
        Situation {
            has_inputs: self.displayed.is_some(),
            run: self.run.as_ref().map(|run| run.status),
            is_pending: self.are_marks_pending() || self.are_parts_pending(),
            has_landmarks: !self.session.document.marks.is_empty(),
            has_undo: self.session.can_undo(),
            has_redo: self.session.can_redo(),
        }
    }

    /// What the session looks like now goes to every page, and soon to disk.
    fn changed(&mut self) {
        self.unsaved_since.get_or_insert_with(Instant::now);
        self.publish();
    }

    fn publish(&mut self) {
        self.revision += 1;
        let state = self.state().to_string();
        self.broadcast.state.send_replace(Arc::from(state));
    }

    fn save(&mut self) {
        self.unsaved_since = None;
        if let Err(error) = self.session.write(&self.session_path) {
            self.notice = Some(format!("the session cannot be saved: {error:#}"));
            self.publish();
        }
    }

    /// Asks for the shape that the landmarks as they are would give.
    fn ask_preview(&mut self) {
        let Some(displayed) = self.displayed.clone() else {
            return;
        };
        self.n_previews = self.n_previews.wrapping_add(1);
        let is_pending = self.are_marks_pending();
        let shown = match &self.run {
            None => PreviewOf::Initial,
            Some(run) if run.status.is_busy() || !is_pending => PreviewOf::Nothing,
            Some(_) => self.broadcast.draped().map_or(PreviewOf::Nothing, |f| {
                PreviewOf::Adjusted(Arc::clone(&f.positions))
            }),
        };
        if !is_pending && !self.are_strokes_pending() {
            self.show_drape_again();
        }
        self.newest_preview.store(self.n_previews, Ordering::SeqCst);
        let job = PreviewJob {
            number: self.n_previews,
            displayed,
            method: self.preset.initial,
            landmarks: self.landmarks(),
            shown,
            newest: Arc::clone(&self.newest_preview),
            figures: Arc::clone(&self.figures),
        };
        self.live.ask(job.clone());
        self.preview.ask(job);
    }

    /// Shows and judges the drape again, where a shape that it might have taken is shown.
    fn show_drape_again(&self) {
        if let (true, Some(displayed), Some(shown)) = (
            self.broadcast.show_drape_again(),
            self.displayed.clone(),
            self.broadcast.draped(),
        ) {
            self.figures.ask(FiguresJob {
                displayed,
                positions: Arc::clone(&shown.positions),
                counterparts: shown.counterparts(),
                landmarks: self.landmarks(),
                iteration: Some(shown.iteration()),
                is_resting: true,
            });
        }
    }

    fn landmarks(&self) -> Vec<Landmark> {
        let source = self.source.as_ref();
        source.map_or_else(Vec::new, |source| {
            crate::session::landmarks(&self.session.document.marks, &source.source)
        })
    }

    fn snapshot(&self) -> Snapshot {
        let mut session = self.session.clone();
        let shown = self.broadcast.draped().filter(|_| self.run.is_some());
        if let Some(Provenance { log, .. }) =
            shown.as_ref().and_then(|shown| shown.provenance.as_ref())
        {
            // A drape that goes on is taken as it was when it was last shown.
            session.run = Some(log.clone());
        }
        let preview = self.broadcast.shown.borrow().clone();
        let preview = preview.filter(|shown| shown.kind == ShownKind::Initial);
        Snapshot {
            session,
            source: self.source.clone(),
            target: self.target.clone(),
            displayed: self.displayed.clone(),
            shown: shown.or(preview),
        }
    }

    fn checkpoint_path(&self) -> PathBuf {
        checkpoint::path_beside(&self.session_path)
    }
}

/// A source and a target, where both are there.
fn both(
    source: Option<&Arc<DisplayedSource>>,
    target: Option<&Arc<DisplayedTarget>>,
) -> Option<DisplayedPair> {
    Some(DisplayedPair::new(Arc::clone(source?), Arc::clone(target?)))
}
