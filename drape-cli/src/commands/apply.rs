//! `drape apply`

use std::path::PathBuf;
use std::process::ExitCode;

use mesh_core::Positions;
use neural_drape::Warp;

use crate::args::{say_beside, wrote, MorphArgs, PipeArgs};
use crate::output::{findings, warn};

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
    args.pipe
        .check_output(&args.output, &[&args.warp, &args.mesh])?;
    let warp = Warp::load(&args.warp)?;
    let mut file = args.pipe.read(&args.mesh, Some(&args.output))?;
    file.set_morphs(args.morphs.morphs.into());
    warn(&findings(&file));
    let name = args.pipe.name(&file, &args.output);
    warn(&args.morphs.check_output(&file, &name)?);
    let moved = Positions::from(warp.apply(&file.soup().positions));
    args.pipe.write(&file, &moved, &args.output)?;
    let told = format!("moved {} vertices\n{}", moved.len(), wrote(&args.output));
    say_beside(&args.output, &told)?;
    Ok(ExitCode::SUCCESS)
}
