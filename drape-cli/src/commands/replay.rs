//! `drape replay`

use std::path::PathBuf;
use std::process::ExitCode;

use crate::output::{check_distinct, check_mesh, say};
use crate::progress::Progress;
use crate::toolbox::CommandLine;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Session file of the studio
    session: PathBuf,
    /// File to write: the source with its vertices moved
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
}

pub(super) fn run(args: &Args) -> anyhow::Result<ExitCode> {
    check_mesh(&args.output)?;
    check_distinct(&args.output, &[&args.session])?;
    let mut progress = None;
    let replayed = drape_studio::replay(&args.session, &CommandLine::default(), |step| {
        progress
            .get_or_insert_with(|| Progress::start(step.n_iterations))
            .show(step);
    })?;
    drop(progress.map(Progress::finish));
    let (file, target) = (&replayed.scene.source.file, &replayed.scene.target.path);
    check_distinct(&args.output, &[file.path(), target])?;
    let positions = replayed.scene.source.spread(&replayed.draped);
    file.write(&args.output, &positions)?;
    say(&format!("wrote {}\n", args.output.display()))?;
    Ok(ExitCode::SUCCESS)
}
