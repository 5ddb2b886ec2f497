//! Finished runs, one line of JSON each, appended as they finish.

use std::collections::BTreeMap;
use std::fs::{self, OpenOptions};
use std::io::Write as _;
use std::path::{Path, PathBuf};

use anyhow::Context as _;
use serde::{Deserialize, Serialize};

/// What a run gave.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Row {
    pub(crate) pair: String,
    pub(crate) preset: String,
    pub(crate) seed: u64,
    /// Why there is no result; none where there is one.
    pub(crate) error: Option<String>,
    pub(crate) figures: BTreeMap<String, f64>,
    pub(crate) warnings: Vec<String>,
    pub(crate) output: PathBuf,
    pub(crate) picture: PathBuf,
    /// The command line, without the program.
    pub(crate) command: Vec<String>,
    /// When the run ended, in seconds since 1970.
    pub(crate) finished: u64,
}

impl Row {
    pub(crate) fn figure(&self, name: &str) -> Option<f64> {
        self.figures.get(name).copied()
    }
}

/// The rows of a file; none where there is no file. The last line may be cut short by an interruption.
pub(super) fn load(path: &Path) -> anyhow::Result<Vec<Row>> {
    let text = match fs::read_to_string(path) {
        Ok(text) => text,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => {
            return Err(error).with_context(|| format!("{}: cannot be read", path.display()))
        }
    };
    Ok(text
        .lines()
        .filter_map(|line| serde_json::from_str(line).ok())
        .collect())
}

/// Adds a row at the end of a file.
pub(super) fn append(path: &Path, row: &Row) -> anyhow::Result<()> {
    let line = format!("{}\n", serde_json::to_string(row)?);
    OpenOptions::new()
        .create(true)
        .append(true)
        .open(path)
        .and_then(|mut file| file.write_all(line.as_bytes()))
        .with_context(|| format!("{}: cannot be written", path.display()))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(crate) fn row(pair: &str, preset: &str, q: Option<f64>) -> Row {
        Row {
            pair: pair.to_owned(),
            preset: preset.to_owned(),
            seed: 0,
            error: q.is_none().then(|| "no, \"really\"".to_owned()),
            figures: q
                .map(|q| ("q_transfer".to_owned(), q))
                .into_iter()
                .collect(),
            warnings: Vec::new(),
            output: "out.obj".into(),
            picture: "out.png".into(),
            command: vec!["transfer".to_owned()],
            finished: 5,
        }
    }

    #[test]
    fn rows_survive_and_a_cut_line_does_not() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rows.jsonl");
        assert!(load(&path).unwrap().is_empty());
        let rows = [row("a", "standard", Some(0.5)), row("b", "paper", None)];
        rows.iter().for_each(|r| append(&path, r).unwrap());
        let text = fs::read_to_string(&path).unwrap();
        fs::write(&path, format!("{text}{}", &text[..40])).unwrap();
        assert_eq!(load(&path).unwrap(), rows);
    }
}
