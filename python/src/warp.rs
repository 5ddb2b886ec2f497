//! The map of a finished drape.

use std::path::PathBuf;

use numpy::PyArray2;
use pyo3::prelude::*;

use crate::arrays::{self, Rows};
use crate::error::{told, waited};

/// What a drape did to space, to do it to other points.
#[pyclass(frozen, module = "mesh_draping")]
pub(crate) struct Warp(pub(crate) mesh_draping::neural_drape::Warp);

#[pymethods]
impl Warp {
    /// Reads a map from a `.drape` file.
    #[staticmethod]
    fn load(path: PathBuf) -> PyResult<Self> {
        let warp = mesh_draping::neural_drape::Warp::load(path);
        Ok(Self(warp.map_err(told)?))
    }

    /// Writes the map to a `.drape` file.
    fn save(&self, path: PathBuf) -> PyResult<()> {
        self.0.save(path).map_err(told)
    }

    /// The images of points, an array of shape (n, 3) in the coordinates of the drape's source.
    fn apply<'py>(
        &self,
        py: Python<'py>,
        points: Rows<'py>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let points = arrays::points(&points, "points")?;
        let warp = self.0.clone();
        let moved = waited(py, move || warp.apply(&points))?;
        arrays::of_points(py, &moved)
    }
}
