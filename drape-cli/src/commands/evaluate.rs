//! `drape evaluate`

use std::path::PathBuf;
use std::process::ExitCode;

use super::bench;
use crate::args::GateArgs;
use crate::output::say;
use crate::suite::{self, Pool, RunList};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// TOML lists of pairs, presets and seeds
    #[arg(required_unless_present = "family", value_name = "MANIFEST")]
    manifests: Vec<PathBuf>,
    /// Pairs built in code beside them: those of `drape bench` with its defaults
    #[arg(long, value_name = "NAME")]
    family: Option<Family>,
    /// Folder for results, tables and pictures; what is done in it already is not done again
    #[arg(short, long, value_name = "FOLDER")]
    output: PathBuf,
    /// Runs at a time
    #[arg(long, value_name = "N", default_value_t = 1)]
    jobs: usize,
    #[command(flatten)]
    gate: GateArgs,
}

/// Pairs built in code.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum Family {
    Creatures,
}

pub(super) fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let list = args.list()?;
    args.gate.check(&list)?;
    let absent = list.absent();
    if !absent.is_empty() {
        let names = absent.join(", ");
        say(&format!(
            "left out, no data here: {} pairs: {names}\n",
            absent.len()
        ))?;
    }
    let tasks = list.tasks(&args.output)?;
    let rows = suite::run(&tasks, &args.output, &Pool::new(args.jobs)?)?;
    let n_failed = tell(&rows, &args.output)?;
    let holds = args.gate.judge(&list, &rows)?;
    Ok(ExitCode::from(u8::from(n_failed > 0 || !holds)))
}

impl Args {
    fn list(&self) -> anyhow::Result<RunList> {
        let mut list = RunList::read(&self.manifests)?;
        if let Some(Family::Creatures) = self.family {
            let creatures = bench::Args::with_defaults(&self.output, self.jobs);
            list.push(creatures.manifest([])?)?;
        }
        Ok(list)
    }
}

/// Says which runs failed and where the tables are; how many failed.
pub(super) fn tell(rows: &[suite::Row], folder: &std::path::Path) -> anyhow::Result<usize> {
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
    Ok(failed.len())
}
