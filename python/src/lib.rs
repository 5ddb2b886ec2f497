//! Mesh draping in Python: what the package `mesh_draping` calls.
//!
//! Classes and functions here take what [`mesh_draping`] takes, arrays of numpy in the place of lists; the modules in
//! `python/mesh_draping` make these out of whatever a caller has, and tell in their docstrings what each is for. No step is
//! added to what the library does.

mod arrays;
mod command;
mod creatures;
mod draping;
mod error;
mod landmarks;
mod outcome;
mod rays;
mod settings;
mod shapes;
mod step;
mod warp;

use pyo3::prelude::*;

/// The compiled part of `mesh_draping`.
#[pymodule(name = "_native")]
mod native {
    #[pymodule_export]
    use crate::command::run_command;
    #[pymodule_export]
    use crate::creatures::Creature;
    #[pymodule_export]
    use crate::draping::{Draping, Inputs};
    #[pymodule_export]
    use crate::error::{Cancelled, Error};
    #[pymodule_export]
    use crate::landmarks::Landmarks;
    #[pymodule_export]
    use crate::outcome::{initial, metrics, read_vertices, Outcome};
    #[pymodule_export]
    use crate::rays::Surface;
    #[pymodule_export]
    use crate::settings::Settings;
    #[pymodule_export]
    use crate::shapes::{Source, Target};
    #[pymodule_export]
    use crate::step::Step;
    #[pymodule_export]
    use crate::warp::Warp;
}
