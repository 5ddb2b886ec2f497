//! The files of kept results and of sessions that were set aside, beside the session's own.
//!
//! | file | what |
//! |---|---|
//! | `<session>.kept/N.run` | the drape of result N, to go on from |
//! | `<session>.kept/N.positions` | its positions, three f64 per vertex, little-endian |
//! | `<session>.kept/N.png` | its picture |
//! | `<session>.aside/NAME.json`, `NAME.run` | the session of another target, and its drape |

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{ensure, Context as _, Result};
use mesh_core::io::write_atomic;
use mesh_core::{Point3, Positions};

use crate::session::Session;

/// Where they are.
#[derive(Clone, Debug)]
pub(crate) struct KeptFiles {
    kept: PathBuf,
    aside: PathBuf,
}

impl KeptFiles {
    /// Those of a session file.
    pub(crate) fn beside(session: &Path) -> Self {
        Self {
            kept: session.with_extension("kept"),
            aside: session.with_extension("aside"),
        }
    }

    /// The drape of a result.
    pub(crate) fn run(&self, id: u32) -> PathBuf {
        self.kept.join(format!("{id}.run"))
    }

    /// The picture of a result.
    pub(crate) fn picture(&self, id: u32) -> PathBuf {
        self.kept.join(format!("{id}.png"))
    }

    fn positions(&self, id: u32) -> PathBuf {
        self.kept.join(format!("{id}.positions"))
    }

    /// Writes a result; its drape is a copy of the one at `run`.
    pub(crate) fn write(&self, id: u32, x: &Positions, run: &Path) -> Result<()> {
        make(&self.kept)?;
        write_atomic(self.positions(id), &bytes_of(x))?;
        fs::copy(run, self.run(id))
            .with_context(|| format!("{}: cannot be kept", run.display()))?;
        Ok(())
    }

    /// The positions of a result.
    pub(crate) fn read(&self, id: u32) -> Result<Positions> {
        let path = self.positions(id);
        let bytes =
            fs::read(&path).with_context(|| format!("{}: cannot be read", path.display()))?;
        ensure!(bytes.len() % 24 == 0, "{}: is cut off", path.display());
        let number = |b: &[u8]| b.first_chunk().map_or(f64::NAN, |b| f64::from_le_bytes(*b));
        let numbers: Vec<f64> = bytes.chunks_exact(8).map(number).collect();
        let points = numbers
            .chunks_exact(3)
            .map(|p| Point3::new(p[0], p[1], p[2]));
        Ok(points.collect())
    }

    /// Sets a session aside under the name of its target, with the drape at `run`, if there is one.
    pub(crate) fn set_aside(&self, name: &str, session: &Session, run: &Path) -> Result<()> {
        make(&self.aside)?;
        session.write(&self.aside_session(name))?;
        let kept_run = self.aside_run(name);
        if run.exists() {
            fs::copy(run, &kept_run)
                .with_context(|| format!("{}: cannot be kept", run.display()))?;
        } else {
            drop(fs::remove_file(&kept_run));
        }
        Ok(())
    }

    /// The file of a session that was set aside.
    pub(crate) fn aside_session(&self, name: &str) -> PathBuf {
        self.aside.join(format!("{name}.json"))
    }

    /// The file of its drape.
    pub(crate) fn aside_run(&self, name: &str) -> PathBuf {
        self.aside.join(format!("{name}.run"))
    }

    /// The names of the sessions that were set aside, in order.
    pub(crate) fn aside_names(&self) -> Vec<String> {
        let files = fs::read_dir(&self.aside).into_iter().flatten().flatten();
        let names = files.filter_map(|file| {
            let path = file.path();
            let is_session = path.extension().is_some_and(|e| e == "json");
            is_session.then(|| path.file_stem().map(|s| s.to_string_lossy().into_owned()))?
        });
        let mut names: Vec<String> = names.collect();
        names.sort_unstable();
        names
    }
}

/// The coordinates of all vertices, little-endian.
pub(crate) fn bytes_of(x: &Positions) -> Vec<u8> {
    let coordinates = x
        .iter()
        .flat_map(|p| p.coords.iter().copied().collect::<Vec<_>>());
    coordinates.flat_map(f64::to_le_bytes).collect()
}

fn make(folder: &Path) -> Result<()> {
    fs::create_dir_all(folder).with_context(|| format!("{}: cannot be made", folder.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kept_shape_comes_back_to_the_bit() {
        let folder = tempfile::tempdir().unwrap();
        let files = KeptFiles::beside(&folder.path().join("a.json"));
        let run = folder.path().join("a.run");
        fs::write(&run, b"drape").unwrap();
        let points = [
            Point3::new(0.1 + 0.2, -0.0, 1e300),
            Point3::new(1.0, 2.0, 3.0),
        ];
        let x: Positions = points.into_iter().collect();
        files.write(7, &x, &run).unwrap();
        assert_eq!(bytes_of(&files.read(7).unwrap()), bytes_of(&x));
        assert_eq!(fs::read(files.run(7)).unwrap(), b"drape");
        assert!(files.read(8).is_err());
    }

    #[test]
    fn sessions_are_set_aside_by_name() {
        let folder = tempfile::tempdir().unwrap();
        let files = KeptFiles::beside(&folder.path().join("a.json"));
        assert!(files.aside_names().is_empty());
        let session = Session::new("preset = \"standard\"\n".to_owned());
        let run = folder.path().join("a.run");
        for name in ["wolf", "cat"] {
            files.set_aside(name, &session, &run).unwrap();
        }
        assert_eq!(files.aside_names(), ["cat", "wolf"]);
        assert!(!files.aside_run("cat").exists());
    }
}
