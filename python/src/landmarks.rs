//! Places that belong together.

use std::path::PathBuf;

use mesh_draping::landmarks::{self, leave_one_out_residuals, Finding, Form, Lost, WrapPoints};
use mesh_draping::mesh_core::{Curve, Landmark};
use mesh_draping::Pair;
use pyo3::prelude::*;
use serde_json::json;

use crate::error::{told, waited, Error};
use crate::shapes::{Source, Target};

/// Landmarks of one source and one target.
#[pyclass(frozen, module = "mesh_draping")]
pub(crate) struct Landmarks(pub(crate) Vec<Landmark>);

#[pymethods]
impl Landmarks {
    /// None at all.
    #[staticmethod]
    fn none() -> Self {
        Self(Vec::new())
    }

    /// Reads a landmark file of any form.
    #[staticmethod]
    fn read(path: PathBuf, source: &Source, target: &Target) -> PyResult<Self> {
        let read = landmarks::read(path, &source.0, &target.0);
        Ok(Self(read.map_err(told)?))
    }

    /// Reads the two point files of Faceform Wrap.
    #[staticmethod]
    fn read_wrap(
        on_source: PathBuf,
        on_target: PathBuf,
        source: &Source,
        target: &Target,
    ) -> PyResult<Self> {
        let files = WrapPoints {
            source: on_source.as_path(),
            target: on_target.as_path(),
        };
        let read = landmarks::read_wrap(files, &source.0, &target.0);
        Ok(Self(read.map_err(told)?))
    }

    /// The texts of the two point files of Faceform Wrap, and what they leave out.
    fn wrap_texts(
        &self,
        source: &Source,
        target: &Target,
    ) -> PyResult<(String, String, Vec<String>)> {
        let written = landmarks::write_wrap(&self.0, &source.0, &target.0).map_err(told)?;
        let lost = Lost::without_both(&self.0).into_iter();
        let lost = lost.map(|lost| lost.to_string());
        Ok((written.source, written.target, lost.collect()))
    }

    /// The landmarks in the text of a landmark file.
    #[staticmethod]
    fn parse(text: &str, source: &Source, target: &Target) -> PyResult<Self> {
        let parsed = landmarks::parse(text, None, &source.0, target.0.vertices());
        Ok(Self(parsed.map_err(told)?))
    }

    /// How many landmarks and curves there are.
    fn __len__(&self) -> usize {
        Landmark::marked(&self.0).count() + Curve::runs(&self.0).count()
    }

    /// The text of a landmark file, how far the farthest place had to move to a vertex, and what the form leaves out.
    fn text(
        &self,
        source: &Source,
        target: &Target,
        form: &str,
    ) -> PyResult<(String, f64, Vec<String>)> {
        let written = landmarks::write(&self.0, &source.0, &target.0, named(form)?);
        let lost = written.lost.iter().map(Lost::to_string);
        Ok((written.text, written.moved, lost.collect()))
    }

    /// How far each is from where the others expect it, and what looks wrong.
    fn check(
        &self,
        py: Python<'_>,
        source: &Source,
        target: &Target,
    ) -> PyResult<(Vec<f64>, Vec<String>)> {
        let pair = self.pair(source, target);
        waited(py, move || {
            let findings = pair.findings();
            let findings = findings.iter().map(Finding::to_string).collect();
            (leave_one_out_residuals(&pair), findings)
        })
    }

    /// The `n` most useful places to mark next, as JSON.
    fn suggest(
        &self,
        py: Python<'_>,
        source: &Source,
        target: &Target,
        n: usize,
    ) -> PyResult<String> {
        let pair = self.pair(source, target);
        let found = waited(py, move || landmarks::suggest(&pair, n))?;
        let entry = |s: &landmarks::Suggestion| {
            json!({
                "source": { "vertex": source.0.file_row(s.vertex) },
                "target": { "point": s.target.coords.as_slice() },
                "distance_to_landmarks": s.alone.is_finite().then_some(s.alone),
                "initial_miss": s.missed,
            })
        };
        let list: Vec<_> = found.map_err(told)?.iter().map(entry).collect();
        Ok(json!(list).to_string())
    }

    /// These and those of the other half of a symmetric source.
    fn mirrored(&self, py: Python<'_>, source: &Source, target: &Target) -> PyResult<Self> {
        let pair = self.pair(source, target);
        let found = waited(py, move || landmarks::mirror(&pair))?;
        let mirrored = found.map_err(|error| Error::new_err(error.to_string()))?;
        let all = self.0.iter().cloned().chain(mirrored.added);
        Ok(Self(all.collect()))
    }
}

impl Landmarks {
    pub(crate) fn pair(&self, source: &Source, target: &Target) -> Pair {
        Pair {
            source: source.0.clone(),
            target: target.0.clone(),
            landmarks: self.0.clone(),
        }
    }
}

fn named(form: &str) -> PyResult<Form> {
    match form {
        "json" => Ok(Form::Json),
        "lists" => Ok(Form::Lists),
        "text" => Ok(Form::Text),
        "ids" => Ok(Form::Ids),
        "points" => Ok(Form::Points),
        _ => Err(Error::new_err(format!(
            "form '{form}': there are json, lists, text, ids and points"
        ))),
    }
}
