//! `drape bake`

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::ensure;
use mesh_draping::{Source, Target};

use crate::args::{bake, check_maps, wrote, MapArgs, WeldArgs};
use crate::output::{say, warn};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// A draped mesh with texture coordinates
    result: PathBuf,
    /// The mesh or point cloud that it was draped over
    target: PathBuf,
    /// PNG file for the target's picture and colours
    #[arg(short, long, value_name = "PNG")]
    output: Option<PathBuf>,
    /// PNG file for the target's normals, in the coordinates of the result (object space)
    #[arg(long, value_name = "PNG")]
    normal: Option<PathBuf>,
    /// PNG file for how far the target lies out of the result, with 16 bits: the middle is nothing
    #[arg(long, value_name = "PNG")]
    displacement: Option<PathBuf>,
    #[command(flatten)]
    maps: MapArgs,
    #[command(flatten)]
    weld: WeldArgs,
}

pub(super) fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let maps = args.maps.maps(
        args.output.as_deref(),
        args.normal.as_deref(),
        args.displacement.as_deref(),
    );
    ensure!(
        maps.paths().next().is_some(),
        "nothing to bake; give --output, --normal or --displacement"
    );
    check_maps(&maps, &args.target, &[&args.result, &args.target])?;
    let source = Source::read_with(&args.result, args.weld.weld)?;
    let target = Target::read(&args.target)?;
    let found = bake(&maps, (&source, source.rest()), &target, &args.target)?;
    warn(&found);
    say(&maps.paths().map(wrote).collect::<String>())?;
    Ok(ExitCode::SUCCESS)
}
