//! Settings of a run: a preset, a TOML file over it, and what the call says over both.

use std::path::PathBuf;

use mesh_draping::Preset;
use pyo3::prelude::*;

use crate::error::{told, Error};

/// All settings of a run.
#[pyclass(frozen, module = "mesh_draping")]
pub(crate) struct Settings(pub(crate) Preset);

#[pymethods]
impl Settings {
    /// `changes` is a JSON object of settings over those of the file or preset.
    #[new]
    fn new(
        preset: Option<&str>,
        config: Option<PathBuf>,
        seed: Option<u64>,
        changes: &str,
    ) -> PyResult<Self> {
        let base = match (config, preset) {
            (Some(path), name) => Preset::read(path, name),
            (None, Some(name)) => Preset::named(name),
            (None, None) => Ok(Preset::standard()),
        };
        let changes = toml_of(changes)?;
        let changed = base.and_then(|base| base.with_toml(&changes));
        let mut preset = changed.map_err(told)?;
        if let Some(seed) = seed {
            preset.drape.seed = seed;
        }
        Ok(Self(preset))
    }

    /// As a TOML file has them.
    fn toml(&self) -> String {
        self.0.to_toml()
    }

    /// The names of the presets, the default first.
    #[staticmethod]
    fn names() -> Vec<&'static str> {
        Preset::names().collect()
    }
}

/// A JSON object as TOML.
fn toml_of(json: &str) -> PyResult<String> {
    let wrong = |error: &dyn std::fmt::Display| Error::new_err(format!("settings: {error}"));
    let value: serde_json::Value = serde_json::from_str(json).map_err(|error| wrong(&error))?;
    toml::to_string(&value).map_err(|error| wrong(&error))
}
