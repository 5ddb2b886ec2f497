//! `drape apply`

use std::path::PathBuf;
use std::process::ExitCode;

use mesh_core::io;
use mesh_core::Positions;
use neural_drape::Warp;

use crate::args::MorphArgs;
use crate::output::{check_distinct, check_mesh, findings, say, warn};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Map saved by `drape transfer --warp`
    warp: PathBuf,
    /// Mesh or points in the coordinates of the drape's source: another level of detail, hair, a collision hull
    mesh: PathBuf,
    /// File to write: the mesh with its vertices moved
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    morphs: MorphArgs,
}

pub(super) fn run(args: &Args) -> anyhow::Result<ExitCode> {
    check_mesh(&args.output)?;
    check_distinct(&args.output, &[&args.warp, &args.mesh])?;
    let warp = Warp::load(&args.warp)?;
    let mut file = io::read_mesh(&args.mesh)?;
    file.set_morphs(args.morphs.morphs.into());
    warn(&findings(&file));
    warn(&args.morphs.check_output(&file, &args.output)?);
    let moved = Positions::from(warp.apply(&file.soup().positions));
    file.write(&args.output, &moved)?;
    say(&format!(
        "moved {} vertices\nwrote {}\n",
        moved.len(),
        args.output.display()
    ))?;
    Ok(ExitCode::SUCCESS)
}
