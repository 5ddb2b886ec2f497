//! Results that are kept: put beside the drape, compared with it, brought back.

use std::sync::mpsc::channel;
use std::sync::Arc;
use std::thread;
use std::time::Duration;

use anyhow::{ensure, Context as _, Result};
use mesh_core::Positions;
use mesh_render::{Gallery, View};
use serde_json::{json, Value};

use super::can::{Status, OPEN_FIRST};
use super::request::KeptRequest;
use super::{Controller, Inbox};
use crate::checkpoint::{self, Checkpoint};
use crate::figures::{Figures, FiguresJob};
use crate::kept_files::{bytes_of, KeptFiles};
use crate::runner::Order;
use crate::session::{fnv1a, landmarks, Kept};

/// A drape comes to rest within this time: an iteration, the last stage, and writing.
const PATIENCE: Duration = Duration::from_secs(60);
/// Pixels along the side of a picture.
const PICTURE: usize = 192;
/// More results than this are a mistake.
const MAX_KEPT: usize = 200;

impl Controller {
    /// Keeps the present result, or goes back to one.
    pub(super) fn handle_kept(&mut self, request: KeptRequest) -> Result<Value> {
        self.finish_drag();
        match request {
            KeptRequest::Keep => {
                let is_kept = self.keep_result()?;
                ensure!(is_kept, "there is no result that is not kept already");
            }
            KeptRequest::BringBack { result } => self.bring_back(result)?,
        }
        self.changed();
        Ok(Value::Null)
    }

    /// Keeps what the drape came to; false where it came to nothing yet, or to what is kept already.
    pub(super) fn keep_result(&mut self) -> Result<bool> {
        let status = self.run.as_ref().map(|run| run.status);
        match status {
            None | Some(Status::Starting | Status::Failed) => return Ok(false),
            Some(Status::Running) => self.bring_to_rest()?,
            Some(Status::Paused | Status::Stopped | Status::Finished) => {
                if self.are_strokes_pending() {
                    self.bring_to_rest()?;
                }
            }
        }
        let inputs = (self.session.source.clone(), self.session.target.clone());
        let (Some(shown), (Some(source), Some(target))) = (self.broadcast.draped(), inputs) else {
            return Ok(false);
        };
        let hash = format!("{:016x}", fnv1a(&bytes_of(&shown.positions)));
        let is_known = self.session.kept.iter().any(|kept| kept.fnv1a == hash);
        if shown.iteration() == 0 || is_known {
            return Ok(false);
        }
        ensure!(
            self.session.kept.len() < MAX_KEPT,
            "{MAX_KEPT} results are enough"
        );
        let id = self.session.fresh_id();
        self.files
            .write(id, &shown.positions, &self.checkpoint_path())?;
        self.session.kept.push(Kept {
            id,
            source,
            target,
            iteration: shown.iteration(),
            fnv1a: hash,
            figures: None,
        });
        let log = shown.provenance.as_ref().map(|p| &p.log);
        let displayed = self.displayed.clone().context(OPEN_FIRST)?;
        let source = &displayed.shapes.source.clone();
        let job = FiguresJob {
            displayed,
            positions: Arc::clone(&shown.positions),
            counterparts: shown.counterparts(),
            landmarks: log.map_or_else(Vec::new, |log| landmarks(log.last_landmarks(), source)),
            iteration: Some(shown.iteration()),
            is_resting: true,
        };
        self.examine(id, job);
        Ok(true)
    }

    /// Judges and draws a result that was kept, on a thread of its own.
    fn examine(&self, id: u32, job: FiguresJob) {
        let (inbox, files) = (self.inbox.clone(), self.files.clone());
        thread::spawn(move || {
            // A result that cannot be drawn has no picture.
            drop(draw(&files, id, &job));
            let figures = json!(Figures::of(&job));
            drop(inbox.send(Inbox::Examined(id, figures)));
        });
    }

    pub(super) fn examined(&mut self, id: u32, figures: Value) {
        if let Some(kept) = self.session.kept.iter_mut().find(|kept| kept.id == id) {
            kept.figures = Some(figures);
            self.changed();
        }
    }

    /// Lets a running drape come to rest, shown and saved.
    pub(super) fn bring_to_rest(&mut self) -> Result<()> {
        let (sender, rested) = channel();
        self.order(Order::Rest(sender))?;
        rested
            .recv_timeout(PATIENCE)
            .context("the drape does not come to rest")?;
        Ok(())
    }

    /// Takes a kept result up again as the drape; the present one is kept. Its landmarks, parts and settings hold again,
    /// as one edit.
    fn bring_back(&mut self, id: u32) -> Result<()> {
        let kept = self.session.kept.iter().find(|kept| kept.id == id);
        let kept = kept.with_context(|| format!("there is no kept result {id}"))?;
        ensure!(
            self.is_of_present(kept),
            "it is of another source or target: go back to that one first"
        );
        let Checkpoint { history, saved } = checkpoint::read(&self.files.run(id))?;
        self.keep_result()?;
        self.leave_run();
        self.broadcast.forget_drape();
        self.broadcast.set_curves(history.curves);
        let log = history.log;
        let (marks, parts) = (log.last_landmarks().to_vec(), log.last_parts().clone());
        self.session.edit(|d| {
            let half = d.marks.iter().filter(|m| !m.is_complete()).cloned();
            d.marks = marks.into_iter().chain(half.collect::<Vec<_>>()).collect();
            (d.parts, d.settings) = (parts, log.settings.clone());
        });
        let strokes = log.strokes().into_iter().cloned().collect();
        self.session.begin_strokes(strokes);
        self.start_runner(log, Some(saved))?;
        self.edited();
        Ok(())
    }

    /// Whether a kept result is of the source and the target that are open.
    fn is_of_present(&self, kept: &Kept) -> bool {
        let hash = |record: &crate::session::InputRecord| record.fnv1a.clone();
        self.session.source.as_ref().map(hash) == Some(kept.source.fnv1a.clone())
            && self.session.target.as_ref().map(hash) == Some(kept.target.fnv1a.clone())
    }

    /// The kept results as pages get them, but those that were removed.
    pub(super) fn kept_state(&self) -> Value {
        let dismissed = &self.session.document.dismissed;
        let kept = self.session.kept.iter();
        let shown = kept.filter(|kept| !dismissed.contains(&kept.id));
        let about = |kept: &Kept| {
            json!({
                "id": kept.id,
                "target": super::state::file_name(&kept.target.path),
                "iteration": kept.iteration,
                "figures": kept.figures,
                "is_present": self.is_of_present(kept),
            })
        };
        shown.map(about).collect()
    }
}

/// A picture of a result.
fn draw(files: &KeptFiles, id: u32, job: &FiguresJob) -> Result<()> {
    let pair = job.displayed.shapes.pair(job.landmarks.clone());
    let x: &Positions = &job.positions;
    let gallery = Gallery::new(&pair, x, None, PICTURE)?;
    gallery
        .result(x, View::FRONT_QUARTER)
        .save(files.picture(id))?;
    Ok(())
}
