//! `drape apply`

use std::path::PathBuf;
use std::process::ExitCode;

use mesh_core::Positions;
use neural_drape::Warp;

use crate::args::{is_pipe, say_beside, MorphArgs, PipeArgs};
use crate::output::{check_distinct, findings, warn};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Map saved by `drape transfer --warp`
    warp: PathBuf,
    /// Mesh or points in the coordinates of the drape's source: another level of detail, hair, a collision hull;
    /// - for standard input
    mesh: PathBuf,
    /// File to write: the mesh with its vertices moved; - for standard output
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    pipe: PipeArgs,
    #[command(flatten)]
    morphs: MorphArgs,
}

pub(super) fn run(args: &Args) -> anyhow::Result<ExitCode> {
    args.pipe.check(&[&args.mesh], Some(&args.output))?;
    args.pipe.check_output(&args.output)?;
    if !is_pipe(&args.output) {
        check_distinct(&args.output, &[&args.warp, &args.mesh])?;
    }
    let warp = Warp::load(&args.warp)?;
    let mut file = args.pipe.read(&args.mesh, Some(&args.output))?;
    file.set_morphs(args.morphs.morphs.into());
    warn(&findings(&file));
    let name = args.pipe.name(&file, &args.output);
    warn(&args.morphs.check_output(&file, &name)?);
    let moved = Positions::from(warp.apply(&file.soup().positions));
    args.pipe.write(&file, &moved, &args.output)?;
    let wrote = match is_pipe(&args.output) {
        true => String::new(),
        false => format!("wrote {}\n", args.output.display()),
    };
    let told = format!("moved {} vertices\n{wrote}", moved.len());
    say_beside(&args.output, &told)?;
    Ok(ExitCode::SUCCESS)
}
