//! A drape in progress on disk, so that a killed server loses next to nothing.
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `DRAPERUN` |
//! | 8 | length of what follows, u64, little-endian |
//! | … | the log and the curves, as JSON |
//! | … | the state of the drape |

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{ensure, Context as _, Result};
use mesh_core::io::write_atomic;
use neural_drape::DrapeState;
use serde::{Deserialize, Serialize};

use crate::broadcast::Curve;
use crate::session::RunLog;

const MAGIC: &[u8; 8] = b"DRAPERUN";

/// A drape in progress.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Checkpoint {
    pub(crate) history: History,
    pub(crate) state: DrapeState,
}

/// What happened to it so far.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct History {
    pub(crate) log: RunLog,
    pub(crate) curves: Vec<Curve>,
}

/// Where the drape of a session file is kept.
pub(crate) fn path_beside(session: &Path) -> PathBuf {
    session.with_extension("run")
}

/// Writes a drape, all or nothing.
pub(crate) fn write(path: &Path, checkpoint: &Checkpoint) -> Result<()> {
    let history = serde_json::to_vec(&checkpoint.history)?;
    let mut bytes = MAGIC.to_vec();
    bytes.extend((history.len() as u64).to_le_bytes());
    bytes.extend(history);
    bytes.extend(checkpoint.state.as_bytes());
    Ok(write_atomic(path, &bytes)?)
}

/// Reads what [`write`] wrote.
pub(crate) fn read(path: &Path) -> Result<Checkpoint> {
    let bytes = fs::read(path).with_context(|| format!("{}: cannot be read", path.display()))?;
    parse(&bytes).with_context(|| path.display().to_string())
}

fn parse(bytes: &[u8]) -> Result<Checkpoint> {
    let (magic, rest) = bytes.split_first_chunk::<8>().context("is cut off")?;
    ensure!(magic == MAGIC, "is not a drape in progress");
    let (length, rest) = rest.split_first_chunk::<8>().context("is cut off")?;
    let length = usize::try_from(u64::from_le_bytes(*length)).context("is damaged")?;
    ensure!(length <= rest.len(), "is cut off");
    let (history, state) = rest.split_at(length);
    Ok(Checkpoint {
        history: serde_json::from_slice(history).context("is damaged")?,
        state: DrapeState::from_bytes(state.to_vec()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_checkpoint_survives_and_a_cut_one_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = path_beside(&folder.path().join("a.drape.json"));
        let log = RunLog {
            settings: "seed = 1\n".to_owned(),
            parts: mesh_draping::Parts::default(),
            landmarks: Vec::new(),
            events: Vec::new(),
            iteration: 7,
        };
        let curves = vec![Curve {
            name: "loss".to_owned(),
            points: vec![(0, 0.1 + 0.2), (1, 1e-300)],
        }];
        let checkpoint = Checkpoint {
            history: History { log, curves },
            state: DrapeState::from_bytes(vec![1, 2, 3]),
        };
        write(&path, &checkpoint).unwrap();
        assert_eq!(read(&path).unwrap(), checkpoint);
        let bytes = fs::read(&path).unwrap();
        for n in [0, 7, 12, 30] {
            assert!(parse(&bytes[..n]).is_err(), "{n} bytes");
        }
    }
}
