//! `drape evaluate`

use std::path::PathBuf;
use std::process::ExitCode;

use super::bench;
use crate::args::{write_between, GateArgs};
use crate::output::say;
use crate::study::{Report, Study};
use crate::suite::{self, Marks, Pool, RunList};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// TOML lists of pairs, presets and seeds
    #[arg(required_unless_present_any = ["family", "study"], value_name = "MANIFEST")]
    manifests: Vec<PathBuf>,
    /// Pairs built in code beside them: those of `drape bench` with its defaults
    #[arg(long, value_name = "NAME")]
    family: Option<Family>,
    /// Compare settings as the paper does, on the pairs of the manifests, or on creatures where none is given
    #[arg(long, value_name = "NAME", conflicts_with = "family")]
    study: Option<Study>,
    /// Seeds of a study: 0 to N − 1
    #[arg(long, value_name = "N", requires = "study", default_value_t = 3)]
    seeds: u64,
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
    if let Some(study) = args.study {
        return args.run_study(study);
    }
    let list = args.list()?;
    args.gate.check(&list)?;
    say_absent(&list)?;
    let tasks = list.tasks(&args.output)?;
    let rows = suite::run(&tasks, &args.output, &Pool::new(args.jobs)?)?;
    let n_failed = tell(&rows, &args.output)?;
    let holds = args.gate.judge(&list, &rows)?;
    Ok(ExitCode::from(u8::from(n_failed > 0 || !holds)))
}

impl Args {
    /// Runs a study, prints its tables, and writes them into the page.
    fn run_study(&self, study: Study) -> anyhow::Result<ExitCode> {
        let page = self.gate.page_of_study()?;
        let marks = Marks::study(study.name());
        if let Some((path, _)) = page {
            write_between(&marks, path, None)?;
        }
        let given = RunList::read(&self.manifests)?;
        let list = study.list(given, self.seeds.max(1), &self.output)?;
        say_absent(&list)?;
        let rows = suite::run(
            &list.tasks(&self.output)?,
            &self.output,
            &Pool::new(self.jobs)?,
        )?;
        let report = Report {
            study,
            list: &list,
            rows: &rows,
        };
        report.write_curve(&self.output)?;
        let n_failed = tell(&rows, &self.output)?;
        say(&report.tables())?;
        if let Some((path, commit)) = page {
            let images = path.with_file_name("images");
            std::fs::create_dir_all(&images)?;
            let curve = report.write_curve(&images)?;
            let address = curve.as_deref().and_then(|c| c.file_name());
            let address = address.map(|name| format!("images/{}", name.to_string_lossy()));
            let text = report.page(commit, address.as_deref())?;
            write_between(&marks, path, Some(&text))?;
        }
        Ok(ExitCode::from(u8::from(n_failed > 0)))
    }

    fn list(&self) -> anyhow::Result<RunList> {
        let mut list = RunList::read(&self.manifests)?;
        if let Some(Family::Creatures) = self.family {
            let creatures = bench::Args::with_defaults(&self.output, self.jobs);
            list.push(creatures.manifest([])?)?;
        }
        Ok(list)
    }
}

/// Names the pairs whose data is not here.
fn say_absent(list: &RunList) -> anyhow::Result<()> {
    let absent = list.absent();
    if !absent.is_empty() {
        let names = absent.join(", ");
        say(&format!(
            "left out, no data here: {} pairs: {names}\n",
            absent.len()
        ))?;
    }
    Ok(())
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
