//! Starting, pausing and ending drapes.

use std::sync::Arc;

use anyhow::{bail, Context as _, Result};

use super::{ActiveRun, Desk, Inbox, Request, Status};
use crate::checkpoint::{self, Checkpoint};
use crate::course::more_iterations;
use crate::runner::{News, Order, Runner, RunnerParts};
use crate::session::{landmarks, Mark, RunLog};

impl Desk {
    /// Follows a request that is about the drape.
    pub(super) fn command(&mut self, request: &Request) -> Result<()> {
        match request {
            Request::Drape => self.begin()?,
            Request::Extend => self.extend()?,
            Request::Reset => {
                self.leave_run();
                self.hub.forget_drape();
                self.ask_preview();
            }
            Request::Pause => self.order(Order::Pause)?,
            Request::Resume => self.resume(Order::Go)?,
            Request::Step => {
                if self.run.is_none() {
                    self.begin_paused()?;
                }
                self.resume(Order::Step)?;
            }
            Request::Stop => {
                self.order(Order::Pause)?;
                if let Some(run) = &mut self.run {
                    run.status = Status::Stopped;
                }
            }
            _ => bail!("this is no command of the drape"),
        }
        self.changed();
        Ok(())
    }

    /// A drape from the landmarks as they are; an earlier one is dropped.
    fn begin(&mut self) -> Result<()> {
        self.begin_paused()?;
        self.order(Order::Go)
    }

    fn begin_paused(&mut self) -> Result<()> {
        self.finish_drag();
        self.notice = None;
        let log = RunLog {
            settings: self.settings.toml.clone(),
            parts: self.session.document.parts.clone(),
            landmarks: self.complete_marks(),
            events: Vec::new(),
            iteration: 0,
        };
        self.leave_run();
        self.hub.forget_drape();
        self.start_runner(log, None)
    }

    fn start_runner(&mut self, log: RunLog, state: Option<neural_drape::DrapeState>) -> Result<()> {
        let scene = self.scene().context("open a source and a target first")?;
        let n_more = more_iterations(&self.toolbox.settings(&log.settings)?.config);
        self.n_runs += 1;
        let (number, inbox) = (self.n_runs, self.inbox.clone());
        let parts = RunnerParts {
            scene,
            toolbox: Arc::clone(&self.toolbox),
            hub: Arc::clone(&self.hub),
            figures: Arc::clone(&self.figures),
            checkpoint: self.checkpoint_path(),
            log: log.clone(),
            state,
        };
        self.session.run = Some(log.clone());
        self.run = Some(ActiveRun {
            number,
            runner: Runner::start(parts, move |news| {
                drop(inbox.send(Inbox::News(number, news)));
            }),
            status: Status::Starting,
            log,
            n_more,
        });
        Ok(())
    }

    fn order(&mut self, order: Order) -> Result<()> {
        let run = self.run.as_ref().context("there is no drape")?;
        run.runner.order(order);
        Ok(())
    }

    /// Goes on, with the landmarks as they are.
    fn resume(&mut self, order: Order) -> Result<()> {
        self.finish_drag();
        self.order_pending()?;
        self.order(order)
    }

    /// Gives the drape more iterations; one that is over goes on.
    fn extend(&mut self) -> Result<()> {
        self.finish_drag();
        let run = self.run.as_ref().context("there is no drape")?;
        let is_over = matches!(run.status, Status::Finished | Status::Stopped);
        if is_over {
            self.order_pending()?;
        }
        self.order(Order::Extend)?;
        if is_over {
            self.order(Order::Go)?;
        }
        Ok(())
    }

    /// Hands the drape what it has not seen yet; it is on disk by then, so that no drape that is taken up
    /// after a sudden end knows of edits that its session has lost.
    fn order_pending(&mut self) -> Result<()> {
        let (marks, parts) = (self.are_marks_pending(), self.are_parts_pending());
        if marks || parts {
            self.save();
        }
        if marks {
            self.order(Order::Marks(self.complete_marks()))?;
        }
        if parts {
            self.order(Order::Parts(self.session.document.parts.clone()))?;
        }
        Ok(())
    }

    /// Ends the drape and forgets it.
    pub(super) fn leave_run(&mut self) {
        if self.run.take().is_some() {
            self.session.run = None;
            // Where it cannot be removed, the session says that there is no drape.
            drop(std::fs::remove_file(self.checkpoint_path()));
        }
    }

    /// Goes on, after a restart, with the drape that was in progress.
    pub(super) fn take_up_run(&mut self) {
        if self.session.run.is_none() || self.scene().is_none() {
            self.session.run = None;
            return;
        }
        let path = self.checkpoint_path();
        let (log, state) = match checkpoint::read(&path) {
            Ok(Checkpoint { story, state }) => {
                self.hub.set_curves(story.curves);
                (Some(story.log), Some(state))
            }
            // A session that came without its drape: it is done again.
            Err(_) => (self.session.run.clone(), None),
        };
        if let Some(log) = log {
            if let Err(error) = self.start_runner(log, state) {
                self.session.run = None;
                self.notice = Some(format!("the drape in progress is lost: {error:#}"));
            }
        }
    }

    /// What the runner tells.
    pub(super) fn hear(&mut self, number: u32, news: News) {
        let Some(run) = self.run.as_mut().filter(|run| run.number == number) else {
            return;
        };
        match news {
            News::Running => run.status = Status::Running,
            News::Paused(log) => {
                if run.status != Status::Stopped {
                    run.status = Status::Paused;
                }
                run.log = log;
            }
            News::Finished(log) => (run.status, run.log) = (Status::Finished, log),
            News::Changed(log) => run.log = log,
            News::Failed(error) => run.status = Status::Failed(error),
        }
        self.session.run = Some(run.log.clone());
        self.changed();
    }

    /// A running drape takes edits at once; one that stands shows what they would do.
    pub(super) fn pass_on(&mut self) {
        let is_running = self
            .run
            .as_ref()
            .is_some_and(|run| run.status == Status::Running);
        if is_running {
            // Never fails: there is a run.
            drop(self.order_pending());
        }
    }

    /// Whether the drape has not seen the parts as they are treated now.
    pub(super) fn are_parts_pending(&self) -> bool {
        let parts = &self.session.document.parts;
        self.run
            .as_ref()
            .is_some_and(|run| run.log.last_parts() != parts)
    }

    /// Whether the drape has not seen the landmarks as they are.
    pub(super) fn are_marks_pending(&self) -> bool {
        let Some(run) = &self.run else {
            return false;
        };
        let places = |marks: &[Mark]| {
            let unnamed = landmarks(marks)
                .into_iter()
                .map(|l| (l.source, l.target, l.kind));
            unnamed.collect::<Vec<_>>()
        };
        places(run.log.last_landmarks()) != places(&self.session.document.marks)
    }

    fn complete_marks(&self) -> Vec<Mark> {
        let marks = self.session.document.marks.iter();
        marks.filter(|m| m.landmark().is_some()).cloned().collect()
    }
}
