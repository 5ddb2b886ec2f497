//! From one scan to the next: what is kept, what is set aside, what waits.

use std::sync::Arc;

use anyhow::Result;
use serde_json::{json, Value};

use super::state::file_name;
use super::{both, Controller, Opened};
use crate::displayed::{DisplayedSource, DisplayedTarget};
use crate::session::{InputRecord, Session};

/// A session that was opened, with its inputs and the drape that was found beside it.
pub(crate) struct OpenedSession {
    pub(crate) session: Session,
    pub(crate) source: Arc<DisplayedSource>,
    pub(crate) target: Arc<DisplayedTarget>,
    /// The bytes of the file that keeps its drape.
    pub(crate) run: Option<Vec<u8>>,
}

impl Controller {
    /// Takes what was opened.
    pub(super) fn open(&mut self, opened: Opened) -> Result<()> {
        match opened {
            Opened::Landmarks(landmarks) => return self.adopt(&landmarks),
            Opened::Beside => return Ok(()),
            Opened::Queued(record) => {
                self.session.queue.push(record);
                self.changed();
                return Ok(());
            }
            Opened::Source(source, record) => {
                if self.session.source.as_ref() != Some(&record) {
                    self.leave_scan()?;
                    self.session.wait_for_source();
                }
                self.source = Some(source);
                self.session.source = Some(record);
            }
            Opened::Target(target, record) => {
                if self.session.target.as_ref() != Some(&record) {
                    self.leave_scan()?;
                    self.session.wait_for_target();
                }
                self.session.queue.retain(|waiting| *waiting != record);
                self.target = Some(target);
                self.session.target = Some(record);
            }
            Opened::Session(opened) => self.take_session(*opened)?,
        }
        self.show_inputs();
        Ok(())
    }

    /// Another source or target is open.
    fn show_inputs(&mut self) {
        self.dragged_from = None;
        self.drawing = None;
        self.shown_bvh = None;
        self.warnings.clear();
        self.notice = None;
        self.displayed = both(self.source.as_ref(), self.target.as_ref());
        self.broadcast.set_displayed(self.displayed.clone());
        self.take_up_run();
        self.look_inside();
        self.edited();
    }

    /// Keeps the result, and sets the session aside as that of its target: nothing is lost where another is opened.
    fn leave_scan(&mut self) -> Result<()> {
        self.finish_drag();
        self.keep_result()?;
        let has_work = self.run.is_some() || !self.session.document.marks.is_empty();
        let target = self.session.target.as_ref().filter(|_| has_work);
        if let Some(name) = target.map(name_of) {
            self.save();
            self.files
                .set_aside(&name, &self.session, &self.checkpoint_path())?;
        }
        self.leave_run();
        Ok(())
    }

    /// Another session in the place of this one, whose results and waiting targets stay.
    fn take_session(&mut self, opened: OpenedSession) -> Result<()> {
        self.leave_scan()?;
        let OpenedSession {
            mut session,
            source,
            target,
            run,
        } = opened;
        session.next_id = session.next_id.max(self.session.next_id);
        session.kept = std::mem::take(&mut self.session.kept);
        session.queue = std::mem::take(&mut self.session.queue);
        self.session = session;
        (self.source, self.target) = (Some(source), Some(target));
        match run {
            Some(run) => mesh_core::io::write_atomic(self.checkpoint_path(), &run)?,
            // Without its own drape it is done again; one of another session would be taken for it.
            None => drop(std::fs::remove_file(self.checkpoint_path())),
        }
        Ok(())
    }

    /// Targets that wait and sessions that were set aside, as pages get them.
    pub(super) fn scans_state(&self) -> Value {
        let waiting = self.session.queue.iter();
        let waiting: Vec<String> = waiting.map(|r| file_name(&r.path)).collect();
        let present = self.session.target.as_ref().map(name_of);
        let mut aside = self.files.aside_names();
        aside.retain(|name| Some(name) != present.as_ref());
        json!({ "queue": waiting, "aside": aside })
    }
}

/// What the session of a target is called: by the target's name, and by what is in it.
fn name_of(target: &InputRecord) -> String {
    let stem = target.path.file_stem().unwrap_or_default();
    format!(
        "{}-{}",
        stem.to_string_lossy(),
        target.fnv1a.get(..6).unwrap_or_default()
    )
}
