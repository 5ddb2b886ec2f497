//! `drape replay`

use std::path::PathBuf;
use std::process::ExitCode;

use crate::output::{check_distinct, check_mesh, check_writable, say};
use crate::progress::Progress;
use crate::toolbox::CommandLine;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Session file of the studio
    session: PathBuf,
    /// File to write: the source with its vertices moved
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    /// Save the map, for `drape apply`
    #[arg(long, value_name = "WARP")]
    warp: Option<PathBuf>,
}

pub(super) fn run(args: &Args) -> anyhow::Result<ExitCode> {
    check_mesh(&args.output)?;
    let outputs = [Some(&args.output), args.warp.as_ref()];
    for path in outputs.into_iter().flatten() {
        check_writable(path)?;
        check_distinct(path, &[&args.session])?;
    }
    let mut progress = None;
    let replayed = drape_studio::replay(&args.session, &CommandLine::default(), |step| {
        progress
            .get_or_insert_with(|| Progress::start(step.n_iterations))
            .show(step);
    })?;
    drop(progress.map(Progress::finish));
    let (file, target) = (&replayed.scene.source.file, &replayed.scene.target.path);
    for path in outputs.into_iter().flatten() {
        check_distinct(path, &[file.path(), target])?;
    }
    let positions = replayed.scene.source.spread(&replayed.draped);
    file.write(&args.output, &positions)?;
    if let Some(path) = &args.warp {
        replayed.warp()?.save(path)?;
    }
    for path in outputs.into_iter().flatten() {
        say(&format!("wrote {}\n", path.display()))?;
    }
    Ok(ExitCode::SUCCESS)
}
