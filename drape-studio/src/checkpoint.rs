//! A drape in progress on disk, so that a killed server loses next to nothing.
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `DRAPRUN2` |
//! | 8 | length of what follows, u64, little-endian |
//! | … | the log and the curves, as JSON |
//! | 8 | number of strokes that hold, u64 |
//! | … | for each 8: number of vertices that it moved, u64; for each of these 4: its row, u32; 24: its move, three f64 |
//! | … | the state of the drape |

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{ensure, Context as _, Result};
use mesh_core::io::write_atomic;
use mesh_core::{Vector3, VertexId};
use mesh_draping::Moves;
use neural_drape::DrapeState;
use serde::{Deserialize, Serialize};

use crate::broadcast::Curve;
use crate::logged_run::SavedRun;
use crate::session::RunLog;

const MAGIC: &[u8; 8] = b"DRAPRUN2";

/// A drape in progress.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Checkpoint {
    pub(crate) history: History,
    pub(crate) saved: SavedRun,
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
    write_moves(&mut bytes, &checkpoint.saved.moves);
    bytes.extend(checkpoint.saved.state.as_bytes());
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
    let mut rest = rest;
    let length = count(&mut rest)?;
    ensure!(length <= rest.len(), "is cut off");
    let (history, mut rest) = rest.split_at(length);
    let n_strokes = count(&mut rest)?;
    let moves = (0..n_strokes).map(|_| read_moves(&mut rest));
    let moves = moves.collect::<Result<_>>()?;
    Ok(Checkpoint {
        history: serde_json::from_slice(history).context("is damaged")?,
        saved: SavedRun {
            state: DrapeState::from_bytes(rest.to_vec()),
            moves,
        },
    })
}

/// The next number.
fn count(rest: &mut &[u8]) -> Result<usize> {
    let n = u64::from_le_bytes(next(rest)?);
    usize::try_from(n).context("is damaged")
}

/// The next bytes.
fn next<const N: usize>(rest: &mut &[u8]) -> Result<[u8; N]> {
    let (bytes, after) = rest.split_first_chunk::<N>().context("is cut off")?;
    *rest = after;
    Ok(*bytes)
}

fn write_moves(bytes: &mut Vec<u8>, strokes: &[Moves]) {
    bytes.extend((strokes.len() as u64).to_le_bytes());
    for Moves { entries } in strokes {
        bytes.extend((entries.len() as u64).to_le_bytes());
        for (v, by) in entries {
            bytes.extend((v.index() as u32).to_le_bytes());
            bytes.extend(by.iter().flat_map(|c| c.to_le_bytes()));
        }
    }
}

fn read_moves(rest: &mut &[u8]) -> Result<Moves> {
    let n = count(rest)?;
    let mut entries = Vec::new();
    for _ in 0..n {
        let row = u32::from_le_bytes(next(rest)?);
        let mut coordinate = || Ok::<_, anyhow::Error>(f64::from_le_bytes(next(rest)?));
        let by = Vector3::new(coordinate()?, coordinate()?, coordinate()?);
        entries.push((VertexId::new(row as usize), by));
    }
    Ok(Moves { entries })
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
            saved: SavedRun {
                state: DrapeState::from_bytes(vec![1, 2, 3]),
                moves: vec![
                    Moves::default(),
                    Moves {
                        entries: vec![(VertexId::new(5), Vector3::new(0.1 + 0.2, -0.0, 1e-300))],
                    },
                ],
            },
        };
        write(&path, &checkpoint).unwrap();
        assert_eq!(read(&path).unwrap(), checkpoint);
        let bytes = fs::read(&path).unwrap();
        for n in [0, 7, 12, 30, bytes.len() - 20] {
            assert!(parse(&bytes[..n]).is_err(), "{n} bytes");
        }
    }
}
