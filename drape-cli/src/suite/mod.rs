//! Many runs: each in a process of its own, each finished one a row that survives whatever comes after.
//!
//! A process a run means that one that crashes takes no other along, and that each counts its own time and memory.

mod bounds;
mod manifest;
mod page;
mod row;
mod run_list;
mod runner;
mod shard;
mod summary;

use std::path::{Path, PathBuf};

use anyhow::Context as _;
use mesh_core::io::write_atomic;

pub(crate) use bounds::{Bounds, Verdict};
pub(crate) use manifest::Manifest;
pub(crate) use page::{origin, Marks, Page};
pub(crate) use row::Row;
pub(crate) use run_list::RunList;
pub(crate) use runner::Pool;
pub(crate) use shard::Shard;

/// The preset that stands for the initial deformation alone.
pub(crate) const INITIAL: &str = "initial";

/// The file of finished rows.
const STORE: &str = "results.jsonl";

/// One run to be done.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Task {
    pub(crate) pair: Pair,
    pub(crate) method: Method,
    /// The frames of the motion so far.
    pub(crate) frames: Option<Frames>,
    /// More options of the command line.
    pub(crate) options: Vec<String>,
    pub(crate) seed: u64,
    /// The draped mesh.
    pub(crate) output: PathBuf,
    pub(crate) picture: PathBuf,
}

/// What is draped over what, and what to judge by.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Pair {
    pub(crate) name: String,
    pub(crate) source: PathBuf,
    pub(crate) target: PathBuf,
    pub(crate) landmarks: Option<PathBuf>,
    /// Where each vertex belongs.
    pub(crate) truth: Option<PathBuf>,
    /// Target to judge against in place of the one that was draped over.
    pub(crate) judge: Option<PathBuf>,
}

/// Results of a motion that the next frame follows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Frames {
    pub(crate) first: PathBuf,
    pub(crate) before: PathBuf,
}

/// The settings of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Method {
    Preset(String),
    /// A TOML file.
    Config(PathBuf),
}

impl Method {
    /// A name for tables and files.
    pub(crate) fn label(&self) -> String {
        match self {
            Self::Preset(name) => name.clone(),
            Self::Config(path) => stem(path),
        }
    }
}

/// The name of a file without folder and extension.
pub(crate) fn stem(path: &Path) -> String {
    path.file_stem()
        .unwrap_or(path.as_os_str())
        .to_string_lossy()
        .into_owned()
}

/// Runs what is not done yet, by this program or shards of it, and writes `results.csv`, `results.json` and `index.html`
/// beside `results.jsonl` in `folder`; gives the rows of all tasks.
pub(crate) fn run(tasks: &[Task], folder: &Path, pool: &Pool) -> anyhow::Result<Vec<Row>> {
    let known = known(folder, None)?;
    make_folder(folder)?;
    let rows = pool.run(tasks, &known, &folder.join(STORE))?;
    write_atomic(folder.join("results.csv"), summary::csv(&rows).as_bytes())?;
    write_atomic(
        folder.join("results.json"),
        serde_json::to_string_pretty(&rows)?.as_bytes(),
    )?;
    write_atomic(
        folder.join("index.html"),
        summary::html(&rows, folder).as_bytes(),
    )?;
    Ok(rows)
}

/// Runs what is not done yet of a shard's tasks; the tables are written by [`run`], when all shards are done.
pub(crate) fn run_shard(
    shard: Shard,
    tasks: &[Task],
    folder: &Path,
    pool: &Pool,
) -> anyhow::Result<Vec<Row>> {
    let (known, store) = (known(folder, Some(shard))?, shard.store(folder));
    make_folder(store.parent().unwrap_or(folder))?;
    pool.run(tasks, &known, &store)
}

/// The rows of `tasks` that are not done yet, by this program or shards of it.
pub(crate) fn left(tasks: &[Task], folder: &Path, pool: &Pool) -> anyhow::Result<Vec<usize>> {
    let done = pool.done(tasks, &known(folder, None)?);
    let rows = done.iter().enumerate();
    Ok(rows
        .filter(|(_, row)| row.is_none())
        .map(|(k, _)| k)
        .collect())
}

/// What the files of rows in `folder` have, as far as the shard `own` need know it.
fn known(folder: &Path, own: Option<Shard>) -> anyhow::Result<Vec<Row>> {
    let mut known = Vec::new();
    for rows in shard::stores(folder, own) {
        known.extend(row::load(&rows)?);
    }
    Ok(known)
}

fn make_folder(folder: &Path) -> anyhow::Result<()> {
    std::fs::create_dir_all(folder)
        .with_context(|| format!("{}: the folder cannot be made", folder.display()))
}
