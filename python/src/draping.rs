//! A drape in progress.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use mesh_draping::mesh_core::Positions;
use mesh_draping::{Motion, Parts, Population, Transfer};
use numpy::PyArray2;
use pyo3::prelude::*;

use crate::arrays::{self, Rows};
use crate::error::{told, waited, Cancelled, Error};
use crate::landmarks::Landmarks;
use crate::outcome::Outcome;
use crate::settings::Settings;
use crate::shapes::{Source, Target};
use crate::step::Step;

/// A drape in progress. Threads may share it: one steps it, others look how far it is and cancel it.
#[pyclass(frozen, module = "mesh_draping")]
pub(crate) struct Draping {
    /// None once it is over or cancelled.
    draping: Mutex<Option<mesh_draping::Draping>>,
    source: Source,
    iteration: AtomicUsize,
    n_iterations: AtomicUsize,
    is_cancelled: AtomicBool,
}

/// What a drape starts from beside its settings.
#[pyclass(frozen, module = "mesh_draping")]
pub(crate) struct Inputs {
    source: Source,
    target: Target,
    landmarks: Py<Landmarks>,
    parts: Parts,
    is_symmetric: bool,
    /// Weight of an even change along the surface.
    smooth_change: f64,
    /// Shapes that the source took before.
    prior: Vec<Positions>,
}

#[pymethods]
impl Inputs {
    #[new]
    #[pyo3(signature = (source, target, landmarks, *, free, rigid, draped, weights, hidden, symmetric, smooth_change, prior))]
    #[allow(
        clippy::too_many_arguments,
        reason = "keywords of a call from Python; each is one option of the command line"
    )]
    fn new(
        source: &Source,
        target: &Target,
        landmarks: Py<Landmarks>,
        free: Vec<String>,
        rigid: Vec<String>,
        draped: Vec<String>,
        weights: Option<String>,
        hidden: bool,
        symmetric: bool,
        smooth_change: f64,
        prior: Vec<Rows<'_>>,
    ) -> PyResult<Self> {
        let prior = prior.iter();
        let prior = prior.map(|shape| source.gathered(shape, "a shape of the prior"));
        Ok(Self {
            source: source.clone(),
            target: target.clone(),
            landmarks,
            parts: Parts {
                free,
                rigid,
                draped,
                weights,
                is_hidden_draped: !hidden,
            },
            is_symmetric: symmetric,
            smooth_change,
            prior: prior.collect::<PyResult<_>>()?,
        })
    }
}

#[pymethods]
impl Draping {
    /// Finds the initial deformation, and sets the drape up.
    #[new]
    fn new(
        py: Python<'_>,
        inputs: &Inputs,
        settings: &Settings,
        truth: Option<Rows<'_>>,
        start: Option<Rows<'_>>,
        first_frame: Option<Rows<'_>>,
    ) -> PyResult<Self> {
        let pair = inputs.landmarks.get().pair(&inputs.source, &inputs.target);
        let mut transfer =
            Transfer::of_pair(pair, settings.0.clone()).with_parts(inputs.parts.clone());
        if let Some(truth) = truth {
            transfer = transfer.with_truth(inputs.source.gathered(&truth, "the truth")?);
        }
        if inputs.smooth_change != 0.0 {
            transfer = transfer.with_smooth_change(inputs.smooth_change);
        }
        if inputs.is_symmetric {
            transfer = transfer.symmetric();
        }
        transfer = followed(transfer, &inputs.source, start, first_frame)?;
        let prior = inputs.prior.clone();
        let start = move || match Population::of(&prior) {
            Some(population) => transfer.with_prior(population).start(),
            None => transfer.start(),
        };
        let draping = waited(py, start)?.map_err(told)?;
        Ok(Self {
            source: inputs.source.clone(),
            iteration: AtomicUsize::new(draping.iteration()),
            n_iterations: AtomicUsize::new(draping.n_iterations()),
            is_cancelled: AtomicBool::new(false),
            draping: Mutex::new(Some(draping)),
        })
    }

    /// One iteration; none when the run is over.
    fn step(&self, py: Python<'_>) -> PyResult<Option<Step>> {
        let step = self.with(py, |draping| draping.step().map_err(told))?;
        py.check_signals()?;
        Ok(step.map(Step))
    }

    /// How many iterations are done.
    #[getter]
    fn iteration(&self) -> usize {
        self.iteration.load(Ordering::Relaxed)
    }

    /// How many iterations the run has.
    #[getter]
    fn n_iterations(&self) -> usize {
        self.n_iterations.load(Ordering::Relaxed)
    }

    /// Whether it was cancelled.
    #[getter]
    fn is_cancelled(&self) -> bool {
        self.is_cancelled.load(Ordering::Relaxed)
    }

    /// Ends it after the iteration that goes on; the memory is free at once where none does.
    fn cancel(&self) {
        self.is_cancelled.store(true, Ordering::Relaxed);
        if let Ok(mut draping) = self.draping.try_lock() {
            *draping = None;
        }
    }

    /// Where the vertices are now.
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let source = &self.source.0;
        let now = self.with(py, |draping| Ok(source.spread(&draping.positions())))?;
        arrays::of_points(py, &now)
    }

    /// Where it started.
    #[getter]
    fn initial<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let source = &self.source.0;
        let start = self.with(py, |draping| Ok(source.spread(draping.initial())))?;
        arrays::of_points(py, &start)
    }

    /// What was assumed and decided so far, in words.
    #[getter]
    fn notes(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        self.with(py, |draping| {
            Ok(draping.notes().iter().map(ToString::to_string).collect())
        })
    }

    /// Goes on with other landmarks.
    fn set_landmarks(&self, py: Python<'_>, landmarks: &Landmarks) -> PyResult<()> {
        let list = landmarks.0.clone();
        self.with(py, |draping| draping.set_landmarks(list).map_err(told))
    }

    /// Gives the run more iterations.
    fn extend(&self, py: Python<'_>, n_iterations: usize) -> PyResult<()> {
        self.with(py, |draping| {
            draping.extend(n_iterations);
            Ok(())
        })
    }

    /// Ends the drape where it is: the last stage, the judge, the explanation.
    fn finish(&self, py: Python<'_>) -> PyResult<Outcome> {
        let draping = py.detach(|| lock(&self.draping).take());
        let draping = draping.ok_or_else(|| self.gone())?;
        let outcome = waited(py, move || draping.finish())?;
        Ok(Outcome(outcome.map_err(told)?))
    }
}

impl Draping {
    /// Does something to the drape without the interpreter's lock, and notes how far it is.
    fn with<T: Send>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&mut mesh_draping::Draping) -> PyResult<T> + Send,
    ) -> PyResult<T> {
        py.detach(|| {
            let mut held = lock(&self.draping);
            if self.is_cancelled() {
                *held = None;
            }
            let draping = held.as_mut().ok_or_else(|| self.gone())?;
            let done = work(draping)?;
            self.iteration.store(draping.iteration(), Ordering::Relaxed);
            self.n_iterations
                .store(draping.n_iterations(), Ordering::Relaxed);
            Ok(done)
        })
    }

    fn gone(&self) -> PyErr {
        if self.is_cancelled() {
            return Cancelled::new_err("the drape was cancelled");
        }
        Error::new_err("the drape is finished; start another one")
    }
}

/// From a shape on, or after the first frame of a motion and the one before.
fn followed(
    transfer: Transfer,
    source: &Source,
    start: Option<Rows<'_>>,
    first_frame: Option<Rows<'_>>,
) -> PyResult<Transfer> {
    let gathered = |rows: Option<Rows<'_>>, what| {
        let shape = rows.map(|rows| source.gathered(&rows, what));
        shape.transpose()
    };
    let before = gathered(start, "the start")?;
    match (before, gathered(first_frame, "the first frame")?) {
        (Some(before), Some(first)) => Ok(transfer.with_motion(Motion { first, before })),
        (Some(before), None) => Ok(transfer.with_start(before)),
        (None, Some(_)) => Err(Error::new_err(
            "a first frame needs a start: the frame before",
        )),
        (None, None) => Ok(transfer),
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
