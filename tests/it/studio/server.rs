//! The studio as a process of its own.

use std::io::{BufRead as _, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};

/// The arguments of a short drape of what [`crate::support::Workplace`] holds.
pub(crate) const SHORT: [&str; 6] = [
    "source.obj",
    "target.ply",
    "--landmarks",
    "landmarks.json",
    "--config",
    "short.toml",
];

/// A running studio; it is killed with this.
pub(crate) struct Server {
    child: Child,
    pub(crate) url: String,
}

impl Server {
    /// Starts `drape studio` with a session file and a line of more arguments, in a folder.
    pub(crate) fn start(folder: &Path, more: &[&str]) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_drape-under-test"))
            .args(["studio", "--no-browser", "--session", "session.json"])
            .args(more)
            .current_dir(folder)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the studio starts");
        let stdout = child.stdout.take().expect("the studio prints");
        let first = BufReader::new(stdout).lines().next();
        let url = match first {
            Some(Ok(line)) => line.trim_start_matches("studio at ").to_owned(),
            _ => {
                let output = child.wait_with_output().expect("the studio ended");
                panic!("{}", String::from_utf8_lossy(&output.stderr));
            }
        };
        Self { child, url }
    }

    /// `127.0.0.1:PORT`
    pub(crate) fn host(&self) -> &str {
        self.url.split('/').nth(2).expect("an address")
    }

    /// `/TOKEN/`
    pub(crate) fn path(&self) -> String {
        format!("/{}/", self.url.split('/').nth(3).expect("a token"))
    }

    /// Ends it at once, in the middle of whatever it does.
    pub(crate) fn kill(mut self) {
        self.child.kill().expect("the studio is running");
        self.child.wait().expect("the studio ends");
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        drop(self.child.kill());
        drop(self.child.wait());
    }
}
