//! `drape replay`

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use crate::output::{check_distinct, check_mesh, check_writable, say};
use crate::progress::Progress;

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
    let replayed = drape_studio::replay(&args.session, |step| {
        progress
            .get_or_insert_with(|| Progress::start(step.n_iterations))
            .show(step);
    })?;
    if let Some(progress) = progress {
        progress.finish();
    }
    let pair = &replayed.pair;
    let inputs = [
        pair.source.file().map(|file| file.path()),
        pair.target.path(),
    ];
    let inputs: Vec<&Path> = inputs.into_iter().flatten().collect();
    for path in outputs.into_iter().flatten() {
        check_distinct(path, &inputs)?;
    }
    pair.source.write(&args.output, &replayed.draped)?;
    if let Some(path) = &args.warp {
        replayed.warp()?.save(path)?;
    }
    for path in outputs.into_iter().flatten() {
        say(&format!("wrote {}\n", path.display()))?;
    }
    Ok(ExitCode::SUCCESS)
}
