//! Starting, pausing and ending drapes.

use std::sync::Arc;

use anyhow::{Context as _, Result};
use mesh_draping::{Draping, Preset};

use super::can::{Action, Status, OPEN_FIRST};
use super::{ActiveRun, Command, Controller, Inbox};
use crate::checkpoint::{self, Checkpoint};
use crate::logged_run::SavedRun;
use crate::runner::{Order, Runner, RunnerParts, Update};
use crate::session::{Mark, RunLog};

impl Controller {
    /// Does what drives the drape, if that fits it as it is.
    pub(super) fn drive(&mut self, command: Command) -> Result<()> {
        self.finish_drag();
        self.situation().check(Action::Command(command))?;
        match command {
            Command::Drape => {
                self.keep_result()?;
                self.begin_paused()?;
                self.order(Order::Go)?;
            }
            Command::Pause => self.order(Order::Pause)?,
            Command::Resume => self.resume(Order::Go)?,
            Command::Step => {
                if self.run.is_none() {
                    self.begin_paused()?;
                }
                self.resume(Order::Step)?;
            }
            Command::Stop => {
                self.order(Order::Pause)?;
                self.set_status(Status::Stopped);
            }
            Command::Extend => {
                self.order(Order::Extend)?;
                self.resume(Order::Go)?;
            }
            Command::Reset => {
                self.keep_result()?;
                self.leave_run();
                self.broadcast.forget_drape();
                self.ask_preview();
            }
        }
        self.changed();
        Ok(())
    }

    /// A drape from the landmarks as they are that does not go yet; an earlier one is dropped.
    fn begin_paused(&mut self) -> Result<()> {
        self.notice = None;
        let log = RunLog {
            settings: self.session.document.settings.clone(),
            parts: self.session.document.parts.clone(),
            landmarks: self.complete_marks(),
            events: Vec::new(),
            iteration: 0,
        };
        self.leave_run();
        self.session.begin_strokes(Vec::new());
        self.broadcast.forget_drape();
        self.start_runner(log, None)
    }

    pub(super) fn start_runner(&mut self, log: RunLog, saved: Option<SavedRun>) -> Result<()> {
        let displayed = self.displayed.clone().context(OPEN_FIRST)?;
        let n_more = Draping::n_more(&Preset::from_toml(&log.settings)?);
        self.n_runs += 1;
        let (number, inbox) = (self.n_runs, self.inbox.clone());
        let parts = RunnerParts {
            displayed,
            broadcast: Arc::clone(&self.broadcast),
            figures: Arc::clone(&self.figures),
            checkpoint: self.checkpoint_path(),
            log: log.clone(),
            saved,
        };
        self.session.run = Some(log.clone());
        self.run = Some(ActiveRun {
            number,
            runner: Runner::start(parts, move |news| {
                drop(inbox.send(Inbox::Update(number, news)));
            }),
            status: Status::Starting,
            error: None,
            log,
            n_more,
        });
        Ok(())
    }

    pub(super) fn order(&mut self, order: Order) -> Result<()> {
        let run = self.run.as_ref().context("there is no drape")?;
        run.runner.order(order);
        Ok(())
    }

    fn set_status(&mut self, status: Status) {
        if let Some(run) = &mut self.run {
            run.status = status;
        }
    }

    /// Goes on, with the landmarks and parts as they are.
    fn resume(&mut self, order: Order) -> Result<()> {
        if self
            .run
            .as_ref()
            .is_some_and(|run| run.status == Status::Stopped)
        {
            self.set_status(Status::Paused);
        }
        self.order_pending()?;
        self.order(order)
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
            self.session.begin_strokes(Vec::new());
            // Where it cannot be removed, the session says that there is no drape.
            drop(std::fs::remove_file(self.checkpoint_path()));
        }
    }

    /// Goes on, after a restart, with the drape that was in progress.
    pub(super) fn take_up_run(&mut self) {
        if self.session.run.is_none() || self.displayed.is_none() {
            self.session.run = None;
            return;
        }
        let path = self.checkpoint_path();
        let (log, saved) = match checkpoint::read(&path) {
            Ok(Checkpoint { history, saved }) => {
                self.broadcast.set_curves(history.curves);
                (Some(history.log), Some(saved))
            }
            // A session that came without its drape: it is done again.
            Err(_) => (self.session.run.clone(), None),
        };
        if let Some(log) = log {
            if let Err(error) = self.start_runner(log, saved) {
                self.session.run = None;
                self.notice = Some(format!("the drape in progress is lost: {error:#}"));
            }
        }
    }

    /// What the runner tells.
    pub(super) fn hear(&mut self, number: u32, news: Update) {
        let Some(run) = self.run.as_mut().filter(|run| run.number == number) else {
            return;
        };
        // One that was stopped before it began goes for a moment, and stands still again.
        let is_stopped = run.status == Status::Stopped;
        match news {
            Update::Running if is_stopped => {}
            Update::Running => run.status = Status::Running,
            Update::Paused(log) => {
                if !is_stopped {
                    run.status = Status::Paused;
                }
                run.log = log;
            }
            Update::Finished(log) => (run.status, run.log) = (Status::Finished, log),
            Update::Changed(log) => run.log = log,
            Update::Failed(error) => (run.status, run.error) = (Status::Failed, Some(error)),
        }
        let is_alive = run.status != Status::Failed;
        self.session.run = Some(run.log.clone());
        if is_alive {
            self.order_strokes();
        }
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
            let complete = marks.iter().filter(|mark| mark.is_complete());
            let unnamed = complete.map(Mark::unnamed);
            unnamed.collect::<Vec<_>>()
        };
        places(run.log.last_landmarks()) != places(&self.session.document.marks)
    }

    fn complete_marks(&self) -> Vec<Mark> {
        let marks = self.session.document.marks.iter();
        marks.filter(|m| m.is_complete()).cloned().collect()
    }
}
