//! Creatures built in code, whose truth is known.

use mesh_creatures::{CreaturePair, Dial, Individual, PairConfig, Plan, Variant};
use numpy::PyArray2;
use pyo3::prelude::*;

use crate::arrays::{self, Polygons};
use crate::error::Error;

/// A source, a target in other triangles, and where each vertex of the source truly belongs.
#[pyclass(frozen, module = "mesh_draping")]
pub(crate) struct Creature(CreaturePair);

#[pymethods]
impl Creature {
    /// The template of a plan and an individual drawn by a seed.
    #[new]
    #[pyo3(signature = (plan, *, seed, angle, ratio, landmarks, variant))]
    fn new(
        py: Python<'_>,
        plan: &str,
        seed: u64,
        angle: f64,
        ratio: f64,
        landmarks: usize,
        variant: &str,
    ) -> PyResult<Self> {
        let plan = plan.parse().map_err(|error| wrong(plan, &error))?;
        let variant: Variant = variant.parse().map_err(|error| wrong(variant, &error))?;
        check_dial(angle, ratio)?;
        let config = PairConfig {
            variant,
            n_landmarks: landmarks,
            seed,
            ..PairConfig::standard()
        };
        Ok(py.detach(|| {
            let target = Individual::drawn(plan, seed, Dial { angle, ratio });
            Self(CreaturePair::new(
                &Individual::template(plan),
                &target,
                &config,
            ))
        }))
    }

    /// One frame of a motion: the individual of a seed with the joints of a pose turned by up to `angle`.
    #[staticmethod]
    #[pyo3(signature = (plan, *, seed, frame, angle, ratio, landmarks))]
    fn posed(
        py: Python<'_>,
        plan: &str,
        seed: u64,
        frame: u64,
        angle: f64,
        ratio: f64,
        landmarks: usize,
    ) -> PyResult<Self> {
        let plan: Plan = plan.parse().map_err(|error| wrong(plan, &error))?;
        check_dial(angle, ratio)?;
        // Each frame is a scan of its own: other triangles.
        let config = PairConfig {
            n_landmarks: landmarks,
            seed: frame,
            ..PairConfig::standard()
        };
        Ok(py.detach(|| {
            let body = Individual::drawn(plan, seed, Dial { angle: 0.0, ratio });
            let target = Individual::posed(plan, *body.proportions(), angle, seed);
            let source = Individual::template(plan);
            Self(CreaturePair::new(&source, &target, &config))
        }))
    }

    /// The source's vertices.
    #[getter]
    fn source_vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        arrays::of_points(py, &self.0.source.soup.positions)
    }

    /// The source's polygons.
    #[getter]
    fn source_polygons<'py>(&self, py: Python<'py>) -> Polygons<'py> {
        arrays::of_faces(py, &self.0.source.soup.faces)
    }

    /// The source as an OBJ file, with UVs and groups.
    fn source_obj(&self) -> String {
        self.0.source.to_obj()
    }

    /// The target's vertices or points.
    #[getter]
    fn target_vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        arrays::of_points(py, &self.0.target.positions)
    }

    /// The target's polygons; none for a cloud.
    #[getter]
    fn target_polygons<'py>(&self, py: Python<'py>) -> Polygons<'py> {
        arrays::of_faces(py, &self.0.target.faces)
    }

    /// The target as a PLY file.
    fn target_ply(&self) -> String {
        self.0.target_ply()
    }

    /// Where each vertex of the source truly belongs.
    #[getter]
    fn truth<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        arrays::of_points(py, &self.0.truth)
    }

    /// The landmarks as a file.
    fn landmarks_json(&self) -> String {
        self.0.landmarks_json()
    }
}

fn wrong(what: &str, error: &dyn std::fmt::Display) -> PyErr {
    Error::new_err(format!("{what}: {error}"))
}

fn check_dial(angle: f64, ratio: f64) -> PyResult<()> {
    if !(0.0..=120.0).contains(&angle) {
        return Err(wrong("angle", &"use 0 to 120 degrees"));
    }
    if !(1.0..=3.0).contains(&ratio) {
        return Err(wrong("ratio", &"use 1 to 3"));
    }
    Ok(())
}
