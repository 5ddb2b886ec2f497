//! The `drape` command.

use std::ffi::OsString;
use std::path::PathBuf;

use drape_cli::Program;
use pyo3::prelude::*;

/// Runs the command line `args`, program name first, and gives its exit code. `again` starts this program again, which
/// is in `file`.
#[pyfunction]
pub(crate) fn run_command(
    py: Python<'_>,
    args: Vec<OsString>,
    again: Vec<OsString>,
    file: PathBuf,
) -> u8 {
    let program = Program { again, file };
    let code = py.detach(|| drape_cli::run_as(program, args));
    (0..=u8::MAX).find(|&n| code == n.into()).unwrap_or(1)
}
