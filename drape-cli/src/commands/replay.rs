//! `drape replay`

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use crate::args::{is_pipe, say_beside, wrote, PipeArgs};
use crate::output::{check_distinct, check_writable};
use crate::progress::Progress;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Session file of the studio
    session: PathBuf,
    /// File to write: the source with its vertices moved; - for standard output
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    pipe: PipeArgs,
    /// Save the map, for `drape apply`
    #[arg(long, value_name = "WARP")]
    warp: Option<PathBuf>,
}

pub(super) fn run(args: &Args) -> anyhow::Result<ExitCode> {
    args.pipe.check(&[], Some(&args.output))?;
    args.pipe.check_output(&args.output, &[&args.session])?;
    if let Some(path) = &args.warp {
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
    let output = Some(&args.output).filter(|path| !is_pipe(path));
    let outputs = [output, args.warp.as_ref()];
    for path in outputs.into_iter().flatten() {
        check_distinct(path, &inputs)?;
    }
    args.pipe
        .write_source(&pair.source, &replayed.draped, &args.output)?;
    if let Some(path) = &args.warp {
        replayed.warp()?.save(path)?;
    }
    for path in outputs.into_iter().flatten() {
        say_beside(&args.output, &wrote(path))?;
    }
    Ok(ExitCode::SUCCESS)
}
