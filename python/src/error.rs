//! What Python is told when something is wrong.

use std::sync::mpsc::{channel, RecvTimeoutError};
use std::thread;
use std::time::Duration;

use pyo3::create_exception;
use pyo3::exceptions::{PyException, PyRuntimeError, PyValueError};
use pyo3::prelude::*;

create_exception!(
    mesh_draping,
    Error,
    PyValueError,
    "A mesh, a landmark, a setting or a file that cannot be worked with. The message is that of the command line."
);
create_exception!(
    mesh_draping,
    Cancelled,
    PyException,
    "The drape was cancelled: nothing is left of it."
);

/// How often a wait looks whether Ctrl-C was pressed.
const LOOK_EVERY: Duration = Duration::from_millis(50);

/// An error of the library, in its words.
pub(crate) fn told(error: impl Into<mesh_draping::Error>) -> PyErr {
    Error::new_err(error.into().to_string())
}

/// The value of `work`, which runs on a thread of its own without the interpreter's lock; Ctrl-C ends the wait.
pub(crate) fn waited<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    let (sender, mut receiver) = channel();
    // Nobody may be waiting any more.
    thread::spawn(move || drop(sender.send(work())));
    loop {
        let (back, got) = py.detach(move || {
            let got = receiver.recv_timeout(LOOK_EVERY);
            (receiver, got)
        });
        receiver = back;
        match got {
            Ok(value) => return Ok(value),
            Err(RecvTimeoutError::Timeout) => py.check_signals()?,
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err(
                    "the work stopped with a defect of mesh_draping",
                ))
            }
        }
    }
}
