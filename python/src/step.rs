//! What an iteration did.

use std::collections::BTreeMap;

use mesh_draping::neural_drape::StepReport;
use pyo3::prelude::*;

/// What an iteration did.
#[pyclass(frozen, module = "mesh_draping")]
pub(crate) struct Step(pub(crate) StepReport);

#[pymethods]
impl Step {
    /// The iteration, counted from 0.
    #[getter]
    fn iteration(&self) -> usize {
        self.0.iteration
    }

    /// How many there are.
    #[getter]
    fn n_iterations(&self) -> usize {
        self.0.n_iterations
    }

    /// The sum of weight times value over the terms, before the step.
    #[getter]
    fn total(&self) -> f64 {
        self.0.total
    }

    /// Value and weight of each term, before the step.
    #[getter]
    fn terms(&self) -> BTreeMap<&'static str, (f64, f64)> {
        let terms = self.0.terms.iter();
        terms.map(|t| (t.name, (t.value, t.weight))).collect()
    }

    fn __repr__(&self) -> String {
        format!(
            "Step(iteration={}, n_iterations={}, total={})",
            self.0.iteration, self.0.n_iterations, self.0.total
        )
    }
}
