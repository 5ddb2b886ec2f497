//! Session files: JSON, every number exact, with a check sum.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{anyhow, ensure, Context as _};
use mesh_core::io::write_atomic;
use mesh_draping::landmarks::MAX_WEIGHT;
use mesh_draping::{plain_words, Stroke};
use serde::{Deserialize, Serialize};

use super::mark::Mark;
use super::{Change, Session};

pub(super) const VERSION: u32 = 1;
/// The key of the check sum, beside what is in the session.
const CHECK_SUM: &str = "check_sum";
/// No drape gets more iterations at once.
const MAX_MORE_ITERATIONS: usize = 1_000_000_000;

/// An input file and what it held when it was opened.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct InputRecord {
    pub(crate) path: PathBuf,
    /// FNV-1a hash of its bytes, hexadecimal.
    pub(crate) fnv1a: String,
}

impl InputRecord {
    /// The record of the file at `path`, as it is now.
    pub(crate) fn of(path: &Path) -> anyhow::Result<Self> {
        let bytes =
            fs::read(path).with_context(|| format!("{}: cannot be read", path.display()))?;
        Ok(Self {
            path: path.canonicalize().unwrap_or_else(|_| path.to_owned()),
            fnv1a: format!("{:016x}", fnv1a(&bytes)),
        })
    }

    /// Refuses a file that changed since.
    pub(crate) fn check(&self) -> anyhow::Result<()> {
        ensure!(
            Self::of(&self.path)?.fnv1a == self.fnv1a,
            "{}: is not the file that the session was recorded with",
            self.path.display()
        );
        Ok(())
    }
}

/// FNV-1a hash.
pub(crate) fn fnv1a(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

/// Reads a session file.
pub(crate) fn read(path: &Path) -> anyhow::Result<Session> {
    let text =
        fs::read_to_string(path).with_context(|| format!("{}: cannot be read", path.display()))?;
    Session::of_json(&text).with_context(|| path.display().to_string())
}

impl Session {
    /// Reads what [`Self::to_json`] wrote; paths that are not there are left to whoever opens them.
    pub(crate) fn of_json(text: &str) -> anyhow::Result<Self> {
        let mut value: serde_json::Value =
            serde_json::from_str(text).context("is not a session file")?;
        let version = value.get("version").and_then(serde_json::Value::as_u64);
        ensure!(
            version == Some(u64::from(VERSION)),
            "is not a session file of version {VERSION}"
        );
        let stated = value.as_object_mut().and_then(|all| all.remove(CHECK_SUM));
        ensure!(
            stated == Some(check_sum(&value)?.into()),
            "is damaged: its content is not that of its check sum"
        );
        let session: Self = serde_json::from_value(value).map_err(|error| {
            anyhow!("is not a session file: {}", plain_words(&error.to_string()))
        })?;
        session.check()?;
        Ok(session)
    }

    /// Numbers that no studio would have written are refused.
    fn check(&self) -> anyhow::Result<()> {
        let documents = self.undo.iter().chain(&self.redo).chain([&self.document]);
        let runs = self.run.iter();
        let runs = runs.flat_map(|run| run.changed_landmarks().chain([&run.landmarks]));
        let mirrors = documents.clone().filter_map(|d| d.mirror).flatten();
        ensure!(
            mirrors.into_iter().all(|axis| axis < 3),
            "names an axis that is none"
        );
        let mut held = documents.clone().map(|d| d.n_strokes);
        ensure!(
            held.all(|n| n <= self.strokes.len()),
            "names strokes of a brush that are not there"
        );
        let mut strokes = self.strokes.iter();
        strokes.try_for_each(Stroke::check)?;
        let events = self.run.iter().flat_map(|run| &run.events);
        for event in events {
            if let Change::Brushed(stroke) = &event.change {
                stroke.check()?;
            }
            let is_long = matches!(event.change, Change::Extended(n) if n > MAX_MORE_ITERATIONS);
            ensure!(!is_long, "gives a drape more iterations than it can do");
        }
        for mark in documents.map(|d| &d.marks).chain(runs).flatten() {
            ensure!(
                is_finite(mark),
                "landmark {} is not at a finite place",
                mark.id
            );
        }
        Ok(())
    }

    /// The session as a file.
    pub(crate) fn to_json(&self) -> anyhow::Result<String> {
        let mut value = serde_json::to_value(self)?;
        let sum = check_sum(&value)?;
        if let Some(all) = value.as_object_mut() {
            all.insert(CHECK_SUM.to_owned(), sum.into());
        }
        Ok(serde_json::to_string(&value)? + "\n")
    }

    /// Writes the session, all or nothing.
    pub(crate) fn write(&self, path: &Path) -> anyhow::Result<()> {
        Ok(write_atomic(path, self.to_json()?.as_bytes())?)
    }

    /// The largest row of the source that any place names.
    pub(crate) fn check_places(&self, n_vertices: usize) -> anyhow::Result<()> {
        let runs = self.run.iter();
        let runs = runs.flat_map(|run| run.changed_landmarks().chain([&run.landmarks]));
        let documents = self.undo.iter().chain(&self.redo).chain([&self.document]);
        let places = documents
            .map(|d| &d.marks)
            .chain(runs)
            .flatten()
            .flat_map(Mark::source_places);
        for vertex in places.flat_map(|place| place.vertices) {
            ensure!(
                (vertex as usize) < n_vertices,
                "the session names vertex {vertex}, but the source has {n_vertices}"
            );
        }
        Ok(())
    }
}

/// FNV-1a hash of what is in a session, keys in alphabetical order and without blanks, hexadecimal: the layout of its file
/// does not matter.
fn check_sum(session: &serde_json::Value) -> anyhow::Result<String> {
    Ok(format!("{:016x}", fnv1a(&serde_json::to_vec(session)?)))
}

fn is_finite(mark: &Mark) -> bool {
    let weights = mark.source_places().flat_map(|s| s.weights);
    let line = mark
        .curve
        .iter()
        .flat_map(|lines| lines.target.iter().flatten());
    let target = mark.target.iter().flatten().chain(line).copied();
    let is_in_range = (0.0..=MAX_WEIGHT).contains(&mark.weight);
    is_in_range && weights.chain(target).all(f64::is_finite)
}

#[cfg(test)]
mod tests {
    use super::super::{Event, MarkKind, RunLog, SourcePlace};
    use super::*;
    use mesh_draping::Parts;

    fn session() -> Session {
        let mut session = Session::new("preset = \"standard\"\n".to_owned());
        let mark = Mark {
            id: session.fresh_id(),
            name: "nose".to_owned(),
            source: Some(SourcePlace {
                vertices: [1, 2, 3],
                weights: [0.1 + 0.2, 1.0 / 3.0, 1e-17],
            }),
            target: Some([f64::MIN_POSITIVE, -0.0, 1e300]),
            kind: MarkKind::Rigid,
            weight: 0.1 + 0.2,
            curve: None,
        };
        let parts = Parts {
            free: vec!["bag".to_owned()],
            rigid: Vec::new(),
            draped: vec!["hidden:2".to_owned()],
            ..Parts::default()
        };
        session.edit(|d| {
            d.marks.push(mark.clone());
            d.parts = parts.clone();
        });
        session.run = Some(RunLog {
            settings: session.document.settings.clone(),
            parts: Parts::default(),
            landmarks: Vec::new(),
            events: vec![
                Event {
                    iteration: 3,
                    change: Change::Landmarks(vec![mark]),
                },
                Event {
                    iteration: 4,
                    change: Change::Rebuilt,
                },
                Event {
                    iteration: 4,
                    change: Change::Parts(parts.clone()),
                },
                Event {
                    iteration: 5,
                    change: Change::Extended(500),
                },
            ],
            iteration: 5,
        });
        session
    }

    #[test]
    fn a_session_survives_its_file_to_the_bit() {
        let before = session();
        let after = Session::of_json(&before.to_json().unwrap()).unwrap();
        assert_eq!(after, before);
        let run = after.run.unwrap();
        assert_eq!(run.last_landmarks(), before.document.marks.as_slice());
        assert_eq!(run.last_parts(), &before.document.parts);
    }

    /// A session file that was changed, with the check sum of what it holds now.
    fn summed(text: &str) -> String {
        let Ok(mut value) = serde_json::from_str::<serde_json::Value>(text) else {
            return text.to_owned();
        };
        if let Some(all) = value.as_object_mut() {
            all.remove(CHECK_SUM);
        }
        let sum = check_sum(&value).unwrap();
        if let Some(all) = value.as_object_mut() {
            all.insert(CHECK_SUM.to_owned(), sum.into());
        }
        value.to_string()
    }

    #[test]
    fn other_files_are_refused() {
        let good = session().to_json().unwrap();
        for bad in [
            "",
            "{}",
            "[1]",
            &good.replace("\"version\":1", "\"version\":2"),
            &good.replace("\"marks\"", "\"spots\""),
            &good.replace("\"extended\":500", "\"extended\":5000000000"),
            &good.replace("\"mirror\":null", "\"mirror\":[0,3]"),
            &good[..good.len() / 2],
        ] {
            let told = Session::of_json(&summed(bad)).unwrap_err().to_string();
            assert!(!told.contains("damaged"), "{bad}: {told}");
        }
        assert!(Session::of_json(&summed(&good)).is_ok());
        let changed = good.replace("\"extended\":500", "\"extended\":501");
        let told = Session::of_json(&changed).unwrap_err().to_string();
        assert!(told.contains("damaged"), "{told}");
        assert!(session().check_places(3).is_err());
        assert!(session().check_places(4).is_ok());
    }
}
