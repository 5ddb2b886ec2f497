//! This very program, to start it again: each run of a suite is a process of its own.

use std::ffi::OsString;
use std::io;
use std::path::PathBuf;
use std::process::Command;
use std::sync::OnceLock;

static PRESENT: OnceLock<Program> = OnceLock::new();

/// How this program is started.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Program {
    /// The executable, and what stands before the arguments of the command line.
    pub again: Vec<OsString>,
    /// The file that the code is in: results older than it are not taken over.
    pub file: PathBuf,
}

impl Program {
    /// The running executable.
    fn of_process() -> io::Result<Self> {
        let file = std::env::current_exe()?;
        Ok(Self {
            again: vec![file.clone().into_os_string()],
            file,
        })
    }

    /// A process has one program: the first that it is told.
    pub(crate) fn remember(self) {
        PRESENT.get_or_init(|| self);
    }

    /// What was remembered, else the running executable.
    pub(crate) fn present() -> io::Result<Self> {
        match PRESENT.get() {
            Some(program) => Ok(program.clone()),
            None => Self::of_process(),
        }
    }

    /// The program again, its arguments to be added.
    pub(crate) fn command(&self) -> Command {
        let mut words = self.again.iter().map(OsString::as_os_str);
        let mut command = Command::new(words.next().unwrap_or(self.file.as_os_str()));
        command.args(words);
        command
    }
}
