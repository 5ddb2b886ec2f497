//! A drape in progress on disk, so that a killed server loses next to nothing.
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `DRAPERUN` |
//! | 8 | length of the log, u64, little-endian |
//! | … | the log as JSON |
//! | … | the state of the drape |

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{ensure, Context as _, Result};
use mesh_core::io::write_atomic;
use neural_drape::DrapeState;

use crate::session::RunLog;

const MAGIC: &[u8; 8] = b"DRAPERUN";

/// Where the drape of a session file is kept.
pub(crate) fn path_beside(session: &Path) -> PathBuf {
    session.with_extension("run")
}

/// Writes a drape, all or nothing.
pub(crate) fn write(path: &Path, log: &RunLog, state: &DrapeState) -> Result<()> {
    let log = serde_json::to_vec(log)?;
    let mut bytes = MAGIC.to_vec();
    bytes.extend((log.len() as u64).to_le_bytes());
    bytes.extend(log);
    bytes.extend(state.as_bytes());
    Ok(write_atomic(path, &bytes)?)
}

/// Reads what [`write`] wrote.
pub(crate) fn read(path: &Path) -> Result<(RunLog, DrapeState)> {
    let bytes = fs::read(path).with_context(|| format!("{}: cannot be read", path.display()))?;
    parse(&bytes).with_context(|| path.display().to_string())
}

fn parse(bytes: &[u8]) -> Result<(RunLog, DrapeState)> {
    let (magic, rest) = bytes.split_first_chunk::<8>().context("is cut off")?;
    ensure!(magic == MAGIC, "is not a drape in progress");
    let (length, rest) = rest.split_first_chunk::<8>().context("is cut off")?;
    let length = usize::try_from(u64::from_le_bytes(*length)).context("is damaged")?;
    ensure!(length <= rest.len(), "is cut off");
    let (log, state) = rest.split_at(length);
    Ok((
        serde_json::from_slice(log).context("is damaged")?,
        DrapeState::from_bytes(state.to_vec()),
    ))
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
            parts: crate::Parts::default(),
            landmarks: Vec::new(),
            events: Vec::new(),
            iteration: 7,
        };
        let state = DrapeState::from_bytes(vec![1, 2, 3]);
        write(&path, &log, &state).unwrap();
        assert_eq!(read(&path).unwrap(), (log, state));
        let bytes = fs::read(&path).unwrap();
        for n in [0, 7, 12, 30] {
            assert!(parse(&bytes[..n]).is_err(), "{n} bytes");
        }
    }
}
