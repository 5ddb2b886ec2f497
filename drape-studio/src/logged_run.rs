//! A drape that keeps a log of what was done to it, so that it can be done again to the bit.

use anyhow::{ensure, Context as _, Result};
use mesh_core::Positions;
use mesh_draping::{Draping, Moves, Parts, Preset, Stroke, Transfer};
use mesh_metrics::Counterparts;
use neural_drape::network::NetworkMap;
use neural_drape::{DrapeState, StepReport};

use crate::session::{landmarks, Change, Event, Mark, RunLog};
use crate::shapes::Shapes;

/// A drape and its log. The source is draped itself, however dense: it can be changed at any time.
pub(crate) struct LoggedRun {
    shapes: Shapes,
    draping: Draping,
    log: RunLog,
    /// What each stroke that holds moved, to take it back.
    moves: Vec<Moves>,
}

/// What a drape has come to, to go on from later.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SavedRun {
    pub(crate) state: DrapeState,
    /// What each stroke that holds moved.
    pub(crate) moves: Vec<Moves>,
}

impl LoggedRun {
    /// The drape at its start. Of `log`, only what it started with counts.
    pub(crate) fn new(shapes: &Shapes, log: RunLog) -> Result<Self> {
        Ok(Self {
            draping: begin(shapes, &log)?,
            shapes: shapes.clone(),
            moves: Vec::new(),
            log: RunLog {
                events: Vec::new(),
                iteration: 0,
                ..log
            },
        })
    }

    /// The drape of `log` as it was when it was saved, at the end of the log.
    pub(crate) fn restored(shapes: &Shapes, log: RunLog, saved: &SavedRun) -> Result<Self> {
        ensure!(
            log.strokes().len() == saved.moves.len(),
            "the drape is saved with strokes that it does not have"
        );
        let mut run = Self {
            draping: restore(shapes, &log, &saved.state)?,
            shapes: shapes.clone(),
            moves: saved.moves.clone(),
            log,
        };
        run.note(Change::Rebuilt);
        Ok(run)
    }

    /// Does everything again that is in `log`; `show` sees every step and can end it with an error.
    pub(crate) fn replayed(
        shapes: &Shapes,
        log: &RunLog,
        mut show: impl FnMut(&StepReport) -> Result<()>,
    ) -> Result<Self> {
        let mut run = Self::new(shapes, log.clone())?;
        for event in &log.events {
            run.advance(event.iteration, &mut show)?;
            match &event.change {
                Change::Landmarks(marks) => run.set_marks(marks.clone())?,
                Change::Parts(parts) => run.set_parts(parts.clone())?,
                Change::Brushed(stroke) => run.brush(stroke.clone())?,
                Change::Unbrushed => run.unbrush()?,
                Change::Extended(n) => run.extend(*n),
                Change::Rebuilt => run.rebuild()?,
            }
        }
        run.advance(log.iteration, &mut show)?;
        Ok(run)
    }

    fn advance(
        &mut self,
        iteration: usize,
        mut show: impl FnMut(&StepReport) -> Result<()>,
    ) -> Result<()> {
        while self.draping.iteration() < iteration {
            let step = self.step()?;
            show(&step.context("the session goes on after the end of its run")?)?;
        }
        Ok(())
    }

    /// One iteration; none when the run is over.
    pub(crate) fn step(&mut self) -> Result<Option<StepReport>> {
        let step = self.draping.step()?;
        self.log.iteration = self.draping.iteration();
        Ok(step)
    }

    /// Goes on with other landmarks.
    pub(crate) fn set_marks(&mut self, marks: Vec<Mark>) -> Result<()> {
        let landmarks = landmarks(&marks, &self.shapes.source);
        self.draping.set_landmarks(landmarks)?;
        self.note(Change::Landmarks(marks));
        Ok(())
    }

    /// Goes on with other parts free and rigid.
    pub(crate) fn set_parts(&mut self, parts: Parts) -> Result<()> {
        self.draping.set_regions(self.shapes.regions(&parts)?)?;
        self.note(Change::Parts(parts));
        Ok(())
    }

    /// Goes on with other strokes: those that hold no longer are taken back, the newest first, and new ones are done.
    pub(crate) fn set_strokes(&mut self, strokes: &[Stroke]) -> Result<()> {
        let known = self.log.strokes().into_iter();
        let n_kept = known.zip(strokes).take_while(|(a, b)| *a == *b).count();
        while self.moves.len() > n_kept {
            self.unbrush()?;
        }
        for stroke in &strokes[n_kept..] {
            self.brush(stroke.clone())?;
        }
        Ok(())
    }

    fn brush(&mut self, stroke: Stroke) -> Result<()> {
        self.moves.push(self.draping.brush(&stroke)?);
        self.note(Change::Brushed(stroke));
        Ok(())
    }

    fn unbrush(&mut self) -> Result<()> {
        let moves = self.moves.pop();
        let moves = moves.context("the session takes back a stroke that was never done")?;
        self.draping.displace(&moves.reversed())?;
        self.note(Change::Unbrushed);
        Ok(())
    }

    /// Gives the run more iterations.
    pub(crate) fn extend(&mut self, n_iterations: usize) {
        self.draping.extend(n_iterations);
        self.note(Change::Extended(n_iterations));
    }

    /// Puts the drape together again from its own state, as after a restart.
    fn rebuild(&mut self) -> Result<()> {
        self.draping = restore(&self.shapes, &self.log, &self.draping.state())?;
        self.note(Change::Rebuilt);
        Ok(())
    }

    fn note(&mut self, change: Change) {
        let iteration = self.draping.iteration();
        self.log.iteration = iteration;
        self.log.events.push(Event { iteration, change });
    }

    /// Where the vertices are; at the end of the run, after its last stage.
    pub(crate) fn positions(&self) -> Positions {
        self.draping.positions()
    }

    /// Where the drape started.
    pub(crate) fn initial(&self) -> &Positions {
        self.draping.initial()
    }

    /// The network that moves the vertices; none where there is none, or where it alone does not.
    pub(crate) fn network(&self) -> Option<NetworkMap> {
        self.draping.network()
    }

    /// What of the two shapes is compared.
    pub(crate) fn counterparts(&self) -> Counterparts {
        self.draping.counterparts()
    }

    /// What it has come to.
    pub(crate) fn saved(&mut self) -> SavedRun {
        SavedRun {
            state: self.draping.state(),
            moves: self.moves.clone(),
        }
    }

    pub(crate) fn log(&self) -> &RunLog {
        &self.log
    }

    pub(crate) fn preset(&self) -> &Preset {
        self.draping.preset()
    }

    pub(crate) fn n_iterations(&self) -> usize {
        self.draping.n_iterations()
    }

    pub(crate) fn is_over(&self) -> bool {
        self.draping.is_over()
    }
}

/// The drape of a log at its start.
fn begin(shapes: &Shapes, log: &RunLog) -> Result<Draping> {
    let preset = Preset::from_toml(&log.settings)?;
    let transfer = Transfer::of_pair(
        shapes.pair(landmarks(&log.landmarks, &shapes.source)),
        preset,
    )
    .with_regions(shapes.regions(&log.parts)?)
    .without_stand_in();
    Ok(transfer.start()?)
}

/// The drape of a log in a state that it had come to at the end of the log.
fn restore(shapes: &Shapes, log: &RunLog, state: &DrapeState) -> Result<Draping> {
    let mut draping = begin(shapes, log)?;
    let regions = shapes.regions(log.last_parts())?;
    let landmarks = landmarks(log.last_landmarks(), &shapes.source);
    draping.restore(state, landmarks, regions)?;
    Ok(draping)
}
