//! A drape that keeps a log of what was done to it, so that it can be done again to the bit.

use anyhow::{Context as _, Result};
use mesh_core::{Landmark, Positions};
use mesh_init::InitInput;
use neural_drape::network::NetworkMap;
use neural_drape::{Drape, DrapeConfig, DrapeInput, DrapeState, Regions, StepReport};

use crate::session::{landmarks, Change, Event, Mark, RunLog};
use crate::{Parts, Scene, Settings, Toolbox};

/// A drape that is changed gets at least this share of the settings' iterations (the paper: 500 of 1500).
const MORE_ITERATIONS: (usize, usize) = (1, 3);

/// What a course starts from.
pub(crate) struct Start<'a> {
    scene: &'a Scene,
    toolbox: &'a dyn Toolbox,
    pub(crate) settings: Settings,
    pub(crate) initial: Positions,
    landmarks: Vec<Landmark>,
    parts: Parts,
    regions: Regions,
}

impl<'a> Start<'a> {
    /// Deforms the source for the run of `log`.
    pub(crate) fn new(scene: &'a Scene, toolbox: &'a dyn Toolbox, log: &RunLog) -> Result<Self> {
        let settings = toolbox.settings(&log.settings)?;
        let landmarks = landmarks(&log.landmarks);
        let initial = toolbox.deform(scene, &landmarks, &settings)?.positions;
        let (regions, _) = toolbox.regions(scene, &log.parts)?;
        Ok(Self {
            scene,
            toolbox,
            settings,
            initial,
            landmarks,
            parts: log.parts.clone(),
            regions,
        })
    }

    /// The drape at its start.
    fn drape(&self) -> Result<Drape> {
        let input = DrapeInput {
            triangulation: &self.scene.source.triangulation,
            rest: &self.scene.source.rest,
            initial: &self.initial,
            target: &self.scene.target.parts.over,
            landmarks: &self.landmarks,
        };
        let mut drape = Drape::new(input, self.settings.config.clone())?;
        if !self.regions.is_none() {
            drape.set_regions(&self.regions)?;
        }
        Ok(drape)
    }

    /// The drape of `log` in a state that it had come to at the end of the log.
    fn drape_in(&self, state: &DrapeState, log: &RunLog) -> Result<Drape> {
        let mut drape = self.drape()?;
        drape.set_landmarks(&landmarks(log.last_landmarks()))?;
        if log.last_parts() != &self.parts {
            drape.set_regions(&self.regions(log.last_parts())?)?;
        }
        drape.restore(state)?;
        Ok(drape)
    }

    fn regions(&self, parts: &Parts) -> Result<Regions> {
        Ok(self.toolbox.regions(self.scene, parts)?.0)
    }
}

/// A drape and its log.
pub(crate) struct Course<'a> {
    start: &'a Start<'a>,
    drape: Drape,
    log: RunLog,
}

impl<'a> Course<'a> {
    /// The drape at its start. Of `log`, only what it started with counts.
    pub(crate) fn new(start: &'a Start<'a>, log: RunLog) -> Result<Self> {
        Ok(Self {
            drape: start.drape()?,
            start,
            log: RunLog {
                events: Vec::new(),
                iteration: 0,
                ..log
            },
        })
    }

    /// The drape of `log` as it was when `state` was saved, at the end of the log.
    pub(crate) fn restored(start: &'a Start<'a>, log: RunLog, state: &DrapeState) -> Result<Self> {
        let mut course = Self {
            drape: start.drape_in(state, &log)?,
            start,
            log,
        };
        course.note(Change::Rebuilt);
        Ok(course)
    }

    /// Does everything again that is in `log`; `show` sees every step and can end it with an error.
    pub(crate) fn replayed(
        start: &'a Start<'a>,
        log: &RunLog,
        mut show: impl FnMut(&StepReport) -> Result<()>,
    ) -> Result<Self> {
        let mut course = Self::new(start, log.clone())?;
        for event in &log.events {
            course.advance(event.iteration, &mut show)?;
            match &event.change {
                Change::Landmarks(marks) => course.mark(marks.clone())?,
                Change::Parts(parts) => course.treat(parts.clone())?,
                Change::Extended(n) => course.extend(*n),
                Change::Rebuilt => course.rebuild()?,
            }
        }
        course.advance(log.iteration, &mut show)?;
        Ok(course)
    }

    fn advance(
        &mut self,
        iteration: usize,
        mut show: impl FnMut(&StepReport) -> Result<()>,
    ) -> Result<()> {
        while self.drape.iteration() < iteration {
            let step = self.step()?;
            show(&step.context("the session goes on after the end of its run")?)?;
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
    pub(crate) fn mark(&mut self, marks: Vec<Mark>) -> Result<()> {
        let landmarks = landmarks(&marks);
        let present = self.drape.positions();
        let moved = adjusted(self.start.scene, &landmarks, &present)?;
        self.drape.set_landmarks(&landmarks)?;
        self.drape
            .displace(&moved.iter().zip(&present).map(|(m, p)| m - p).collect())?;
        self.ensure_time();
        self.note(Change::Landmarks(marks));
        Ok(())
    }

    /// Goes on with other parts free and rigid; likewise.
    pub(crate) fn treat(&mut self, parts: Parts) -> Result<()> {
        let regions = self.start.regions(&parts)?;
        self.drape.set_regions(&regions)?;
        self.ensure_time();
        self.note(Change::Parts(parts));
        Ok(())
    }

    /// Gives the run more iterations.
    pub(crate) fn extend(&mut self, n_iterations: usize) {
        self.drape.extend(n_iterations);
        self.note(Change::Extended(n_iterations));
    }

    /// What changed gets time to settle.
    fn ensure_time(&mut self) {
        let left = self.drape.n_iterations() - self.drape.iteration();
        let least = more_iterations(&self.start.settings.config);
        if left < least {
            self.drape.extend(least - left);
        }
    }

    /// Puts the drape together again from its own state, as after a restart.
    fn rebuild(&mut self) -> Result<()> {
        self.drape = self.start.drape_in(&self.drape.state(), &self.log)?;
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

    /// The network that moves the vertices; none where there is none, or where it alone does not.
    pub(crate) fn network(&self) -> Option<NetworkMap> {
        self.drape.network()
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
        target_frame: scene.target.judged().principal_frame(),
    };
    Ok(mesh_init::adjust(input, present)?)
}

/// How many iterations a drape gets that is to go on.
pub(crate) fn more_iterations(config: &DrapeConfig) -> usize {
    let n: usize = config.stages.iter().map(|s| s.n_iterations).sum();
    (n * MORE_ITERATIONS.0 / MORE_ITERATIONS.1).max(1)
}
