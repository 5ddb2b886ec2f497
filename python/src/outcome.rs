//! What a drape came to, the judge, and the initial deformation alone.

use std::path::PathBuf;

use mesh_draping::mesh_core::Point3;
use mesh_draping::mesh_metrics::Report;
use mesh_draping::{initial_deformation, Preset};
use mesh_render::bake::{Depth, Maps};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use serde_json::json;

use crate::arrays::{self, Rows};
use crate::error::{told, waited, Error};
use crate::landmarks::Landmarks;
use crate::shapes::{Source, Target};
use crate::warp::Warp;

/// A draped source with its report.
#[pyclass(frozen, module = "mesh_draping")]
pub(crate) struct Outcome(pub(crate) mesh_draping::Outcome);

#[pymethods]
impl Outcome {
    /// The result: one row per vertex of the source's file or array, in the target's coordinates.
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let run = &self.0;
        arrays::of_points(py, &run.pair.source.spread(&run.draped))
    }

    /// Where the drape started, likewise.
    #[getter]
    fn initial<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let run = &self.0;
        arrays::of_points(py, &run.pair.source.spread(&run.initial))
    }

    /// Distance of each vertex to the target, in longest sides of the target's box.
    #[getter]
    fn distances<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let (source, distances) = (&self.0.pair.source, &self.0.report.vertex_distances);
        let rows = (0..source.n_file_vertices()).filter_map(|row| source.vertex_at(row));
        PyArray1::from_iter(py, rows.map(|v| distances[v]))
    }

    /// The source.
    #[getter]
    fn source(&self) -> Source {
        Source(self.0.pair.source.clone())
    }

    /// All figures, all measures, what is worst, the curves and the settings, as JSON.
    fn json(&self) -> PyResult<String> {
        let run = &self.0;
        let curves = run.history.curves.iter();
        let mut told = judged(&run.report);
        told["figures"]["left_out"] = json!(run.left_out());
        told["explanation"] = json!(run.explanation);
        told["history"] = curves
            .map(|c| (c.name.to_owned(), json!(c.points)))
            .collect();
        told["notes"] = self.notes().into();
        told["preset"] = json!(run.preset.name);
        told["settings"] = json!(run.preset.drape);
        Ok(told.to_string())
    }

    /// What was found in the inputs, assumed, left out and repaired, in words.
    fn notes(&self) -> Vec<String> {
        let run = &self.0;
        let findings = run.pair.findings().into_iter().map(|f| f.to_string());
        let notes = run.pair.notes().into_iter().chain(run.notes.clone());
        findings.chain(notes.map(|note| note.to_string())).collect()
    }

    /// The report as the command line prints it.
    fn text(&self) -> String {
        self.0.report.to_string()
    }

    /// Writes the source's file with its vertices at the result.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| self.0.write(path)).map_err(told)
    }

    /// Displacements from the rest shape, such as those of shape keys, taken to the result.
    fn carry<'py>(
        &self,
        py: Python<'py>,
        displacements: Rows<'py>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (source, draped) = (&self.0.pair.source, &self.0.draped);
        let given = arrays::vectors(&displacements, "displacements")?;
        if given.len() != source.n_file_vertices() {
            return Err(Error::new_err(format!(
                "displacements has {} rows, but the source has {} vertices",
                given.len(),
                source.n_file_vertices()
            )));
        }
        let carried = py.detach(|| source.carry(draped, &given));
        let points: Vec<Point3> = carried.into_iter().map(Point3::from).collect();
        arrays::of_points(py, &points)
    }

    /// Bakes the target's colours, normals and relief into the source's texture coordinates; what is worth knowing, in words.
    fn bake(
        &self,
        py: Python<'_>,
        maps: [Option<PathBuf>; 3],
        size: usize,
        depth: u8,
        painted: Option<PathBuf>,
    ) -> PyResult<Vec<String>> {
        let [colors, normals, displacement] = maps;
        let depth = match depth {
            8 => Depth::Eight,
            16 => Depth::Sixteen,
            _ => return Err(Error::new_err(format!("depth {depth}: use 8 or 16"))),
        };
        let run = &self.0;
        let (source, target) = (&run.pair.source, &run.pair.target);
        let painted = painted.or_else(|| target.path().map(PathBuf::from));
        let maps = Maps {
            colors: colors.as_deref(),
            normals: normals.as_deref(),
            displacement: displacement.as_deref(),
            size,
            depth,
        };
        if maps.colors.is_some() && painted.is_none() {
            return Err(Error::new_err(
                "the target was given as arrays, without colours; name its file as painted",
            ));
        }
        let painted = painted.unwrap_or_default();
        let baked = py.detach(|| maps.write((source, &run.draped), target, &painted));
        let findings = baked.map_err(|error| Error::new_err(error.to_string()))?;
        Ok(findings.iter().map(ToString::to_string).collect())
    }

    /// What the drape did to space.
    fn warp(&self, py: Python<'_>) -> PyResult<Warp> {
        let warp = py.detach(|| self.0.warp());
        Ok(Warp(warp.map_err(told)?))
    }
}

/// Figures and measures.
fn judged(report: &Report) -> serde_json::Value {
    let figures = report.figures().into_iter();
    let figures: serde_json::Map<_, _> = figures
        .map(|(name, value)| (name.to_owned(), json!(value)))
        .collect();
    json!({ "figures": figures, "report": report })
}

/// The initial deformation alone: positions and notes.
#[pyfunction]
pub(crate) fn initial<'py>(
    py: Python<'py>,
    source: &Source,
    target: &Target,
    landmarks: &Landmarks,
    method: &str,
) -> PyResult<(Bound<'py, PyArray2<f64>>, Vec<String>)> {
    let method = Preset::standard()
        .with_toml(&format!("initial = {method:?}"))
        .map_err(told)?
        .initial;
    let pair = landmarks.pair(source, target);
    let shape = waited(py, move || initial_deformation(&pair, method))?.map_err(told)?;
    let notes = shape.notes.iter().map(ToString::to_string).collect();
    let positions = arrays::of_points(py, &source.0.spread(&shape.positions))?;
    Ok((positions, notes))
}

/// Every measure of a result, as JSON.
#[pyfunction]
#[pyo3(signature = (source, result, target, landmarks, truth))]
pub(crate) fn metrics(
    py: Python<'_>,
    source: &Source,
    result: Rows<'_>,
    target: &Target,
    landmarks: &Landmarks,
    truth: Option<Rows<'_>>,
) -> PyResult<String> {
    let draped = source.gathered(&result, "the result")?;
    let truth = truth
        .map(|t| source.gathered(&t, "the truth"))
        .transpose()?;
    let pair = landmarks.pair(source, target);
    let report = waited(py, move || pair.judge(&draped, truth.as_ref()))?;
    Ok(judged(&report.map_err(told)?).to_string())
}

/// Positions for a source from a file that has its vertices.
#[pyfunction]
pub(crate) fn read_vertices<'py>(
    py: Python<'py>,
    source: &Source,
    path: PathBuf,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let gathered = source.0.read_positions(&path).map_err(told)?;
    if !gathered.widest_gap.is_finite() {
        return Err(Error::new_err(format!(
            "{}: holds no shape",
            path.display()
        )));
    }
    arrays::of_points(py, &source.0.spread(&gathered.positions))
}
