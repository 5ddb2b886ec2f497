//! A drape that keeps a log of what was done to it, so that it can be done again to the bit.

use anyhow::{Context as _, Result};
use mesh_core::{Landmark, Positions};
use mesh_init::InitInput;
use neural_drape::{Drape, DrapeConfig, DrapeInput, DrapeState, Regions, StepReport};

use crate::session::{landmarks, Change, Event, Mark, RunLog};
use crate::{Scene, Settings, Toolbox};

/// Changed landmarks get at least this share of the settings' iterations (the paper: 500 of 1500).
const MORE_ITERATIONS: (usize, usize) = (1, 3);

/// What a course starts from.
pub(crate) struct Start {
    pub(crate) settings: Settings,
    pub(crate) initial: Positions,
    landmarks: Vec<Landmark>,
    regions: Regions,
}

impl Start {
    /// Deforms the source for the run of `log`.
    pub(crate) fn new(scene: &Scene, toolbox: &dyn Toolbox, log: &RunLog) -> Result<Self> {
        let settings = toolbox.settings(&log.settings)?;
        let landmarks = landmarks(&log.landmarks);
        let initial = toolbox.deform(scene, &landmarks, &settings)?.positions;
        let (regions, _) = toolbox.regions(scene, &log.parts)?;
        Ok(Self {
            settings,
            initial,
            landmarks,
            regions,
        })
    }
}

/// A drape and its log.
pub(crate) struct Course<'a> {
    scene: &'a Scene,
    start: &'a Start,
    drape: Drape<'a>,
    log: RunLog,
}

impl<'a> Course<'a> {
    /// The drape at its start. Of `log`, only settings and first landmarks count.
    pub(crate) fn new(scene: &'a Scene, start: &'a Start, log: RunLog) -> Result<Self> {
        Ok(Self {
            drape: fresh(scene, start)?,
            scene,
            start,
            log: RunLog {
                events: Vec::new(),
                iteration: 0,
                ..log
            },
        })
    }

    /// The drape of `log` as it was when `state` was saved, at the end of the log.
    pub(crate) fn restored(
        scene: &'a Scene,
        start: &'a Start,
        log: RunLog,
        state: &DrapeState,
    ) -> Result<Self> {
        let mut drape = fresh(scene, start)?;
        drape.set_landmarks(&landmarks(log.last_landmarks()))?;
        drape.restore(state)?;
        let mut course = Self {
            drape,
            scene,
            start,
            log,
        };
        course.log.iteration = course.drape.iteration();
        course.note(Change::Rebuilt);
        Ok(course)
    }

    /// Does everything again that is in `log`.
    pub(crate) fn replayed(
        scene: &'a Scene,
        start: &'a Start,
        log: &RunLog,
        mut show: impl FnMut(&StepReport),
    ) -> Result<Self> {
        let mut course = Self::new(scene, start, log.clone())?;
        for event in &log.events {
            course.advance(event.iteration, &mut show)?;
            match &event.change {
                Change::Landmarks(marks) => course.change(marks.clone())?,
                Change::Rebuilt => course.rebuild()?,
            }
        }
        course.advance(log.iteration, &mut show)?;
        Ok(course)
    }

    fn advance(&mut self, iteration: usize, mut show: impl FnMut(&StepReport)) -> Result<()> {
        while self.drape.iteration() < iteration {
            let step = self.step()?;
            show(&step.context("the session goes on after the end of its run")?);
        }
        Ok(())
    }

    /// One iteration; none when the run is over.
    pub(crate) fn step(&mut self) -> Result<Option<StepReport>> {
        let step = self.drape.step()?;
        self.log.iteration = self.drape.iteration();
        Ok(step)
    }

    /// Goes on with other landmarks: they deform the present shape, and the run gets more iterations if few are left.
    ///
    /// Source: Mesh Draping, Interactive Mode.
    pub(crate) fn change(&mut self, marks: Vec<Mark>) -> Result<()> {
        let landmarks = landmarks(&marks);
        let present = self.drape.positions();
        let moved = adjusted(self.scene, &landmarks, &present)?;
        self.drape.set_landmarks(&landmarks)?;
        self.drape
            .displace(&moved.iter().zip(&present).map(|(m, p)| m - p).collect())?;

        let left = self.drape.n_iterations() - self.drape.iteration();
        let least = more_iterations(&self.start.settings.config);
        if left < least {
            self.drape.extend(least - left);
        }
        self.note(Change::Landmarks(marks));
        Ok(())
    }

    /// Puts the drape together again from its own state, as after a restart.
    fn rebuild(&mut self) -> Result<()> {
        let state = self.drape.state();
        let mut drape = fresh(self.scene, self.start)?;
        drape.set_landmarks(&landmarks(self.log.last_landmarks()))?;
        drape.restore(&state)?;
        self.drape = drape;
        self.note(Change::Rebuilt);
        Ok(())
    }

    fn note(&mut self, change: Change) {
        let iteration = self.drape.iteration();
        self.log.iteration = iteration;
        self.log.events.push(Event { iteration, change });
    }

    /// Where the vertices are; at the end of the run, after its last stage.
    pub(crate) fn positions(&self) -> Positions {
        if self.drape.iteration() == self.drape.n_iterations() {
            self.drape.finish().positions
        } else {
            self.drape.positions()
        }
    }

    pub(crate) fn state(&mut self) -> DrapeState {
        self.drape.state()
    }

    pub(crate) fn log(&self) -> &RunLog {
        &self.log
    }

    pub(crate) fn n_iterations(&self) -> usize {
        self.drape.n_iterations()
    }
}

/// The source at `present`, deformed so that its landmarks come to their places.
pub(crate) fn adjusted(
    scene: &Scene,
    landmarks: &[Landmark],
    present: &Positions,
) -> Result<Positions> {
    let input = InitInput {
        mesh: &scene.source.mesh,
        rest: &scene.source.rest,
        landmarks,
        target_bounds: scene.target.judged().bounds(),
    };
    Ok(mesh_init::adjust(input, present)?)
}

fn fresh<'a>(scene: &'a Scene, start: &'a Start) -> Result<Drape<'a>> {
    let input = DrapeInput {
        triangulation: &scene.source.triangulation,
        rest: &scene.source.rest,
        initial: &start.initial,
        target: scene.target.parts.over.as_ref(),
        landmarks: &start.landmarks,
    };
    let mut drape = Drape::new(input, start.settings.config.clone())?;
    if !start.regions.is_none() {
        drape.set_regions(&start.regions)?;
    }
    Ok(drape)
}

fn more_iterations(config: &DrapeConfig) -> usize {
    let n: usize = config.stages.iter().map(|s| s.n_iterations).sum();
    (n * MORE_ITERATIONS.0 / MORE_ITERATIONS.1).max(1)
}
