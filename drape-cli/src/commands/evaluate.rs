//! `drape evaluate`

use std::path::PathBuf;
use std::process::ExitCode;

use super::bench;
use crate::output::say;
use crate::suite::{self, Manifest, Pool};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// TOML list of pairs, presets and seeds
    #[arg(required_unless_present = "family")]
    manifest: Option<PathBuf>,
    /// Pairs built in code in place of a list: the same as `drape bench` with its defaults
    #[arg(long, value_name = "NAME", conflicts_with = "manifest")]
    family: Option<Family>,
    /// Folder for results, tables and pictures; what is done in it already is not done again
    #[arg(short, long, value_name = "FOLDER")]
    output: PathBuf,
    /// Runs at a time
    #[arg(long, value_name = "N", default_value_t = 1)]
    jobs: usize,
}

/// Pairs built in code.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum Family {
    Creatures,
}

pub(super) fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let manifest = match (&args.manifest, args.family) {
        (Some(path), _) => Manifest::read(path)?,
        (None, Some(Family::Creatures) | None) => {
            return bench::run(&bench::Args::with_defaults(&args.output, args.jobs));
        }
    };
    let tasks = manifest.tasks(&args.output)?;
    let rows = suite::run(&tasks, &args.output, &Pool::new(args.jobs)?)?;
    finish(&rows, &args.output)
}

/// Says where the tables are; exit code 1 where a run failed.
pub(super) fn finish(rows: &[suite::Row], folder: &std::path::Path) -> anyhow::Result<ExitCode> {
    let failed: Vec<&suite::Row> = rows.iter().filter(|row| row.error.is_some()).collect();
    for row in &failed {
        let error = row.error.as_deref().unwrap_or_default();
        eprintln!(
            "failed: {} {} seed {}: {error}",
            row.pair, row.preset, row.seed
        );
    }
    let folder = folder.display();
    say(&format!(
        "{} of {} runs done; wrote {folder}/results.csv, {folder}/results.json and {folder}/index.html\n",
        rows.len() - failed.len(),
        rows.len()
    ))?;
    Ok(ExitCode::from(u8::from(!failed.is_empty())))
}
