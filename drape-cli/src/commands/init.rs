//! `drape init`

use std::path::PathBuf;
use std::process::ExitCode;

use mesh_core::Positions;
use mesh_draping::{initial_deformation, Pair};
use mesh_render::{Gallery, Image, View};

use crate::args::{
    read_truth, say_beside, wrote, InitialArg, Inputs, MorphArgs, PipeArgs, ViewArgs, WeldArgs,
};
use crate::output::{check_writable, warn};
use crate::usage::Stopwatch;
use crate::words;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Mesh to deform; - for standard input
    source: PathBuf,
    /// Mesh or point cloud to bring it to; - for standard input
    target: PathBuf,
    /// Places that belong together, as JSON
    #[arg(short, long, value_name = "FILE")]
    landmarks: Option<PathBuf>,
    /// File to write: the source with its vertices moved; - for standard output
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    pipe: PipeArgs,
    #[command(flatten)]
    weld: WeldArgs,
    #[command(flatten)]
    morphs: MorphArgs,
    /// How the source is brought to its landmarks
    #[arg(long, value_name = "NAME", default_value = "standard")]
    initial: InitialArg,
    /// Mesh whose vertices are where those of the result belong, to judge by
    #[arg(long, value_name = "FILE")]
    truth: Option<PathBuf>,
    /// Print JSON
    #[arg(long)]
    json: bool,
    /// Draw source, target and result into a PNG file
    #[arg(long, value_name = "PNG")]
    render: Option<PathBuf>,
    #[command(flatten)]
    view: ViewArgs,
}

/// Pixels along the side of a picture.
const PICTURE_SIZE: usize = 480;

pub(super) fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let watch = Stopwatch::start();
    check_outputs(args)?;
    let inputs = Inputs {
        source: &args.source,
        target: &args.target,
        landmarks: args.landmarks.as_deref(),
        seams: args.weld.weld,
        output: Some(&args.output),
        pipe: args.pipe,
    };
    let mut pair = inputs.read()?;
    pair.source = pair.source.with_morphs(args.morphs.morphs.into());
    let truth = args.truth.as_deref();
    let truth = truth
        .map(|path| read_truth(path, &pair.source))
        .transpose()?;
    let mut warnings = words::about_inputs(&pair);
    if let Some(file) = pair.source.file() {
        warnings.extend(
            args.morphs
                .check_output(file, &args.pipe.name(file, &args.output))?,
        );
    }
    let initial = initial_deformation(&pair, args.initial.into())?;
    warnings.extend(words::notes(&initial.notes));
    warn(&warnings);
    let positions = initial.positions;
    let report = pair.judge(&positions, truth.as_ref())?;
    args.pipe
        .write_source(&pair.source, &positions, &args.output)?;
    if let Some(path) = &args.render {
        picture(args, &pair, &positions)?.save(path)?;
    }
    if args.json {
        let usage = watch.read().figures();
        let figures = report
            .figures()
            .into_iter()
            .chain(usage)
            .collect::<std::collections::BTreeMap<_, _>>();
        let json =
            serde_json::json!({ "figures": figures, "report": report, "warnings": warnings });
        say_beside(&args.output, &format!("{json:#}\n"))?;
    } else {
        let told = format!("{report}\n{}", wrote(&args.output));
        say_beside(&args.output, &told)?;
    }
    Ok(ExitCode::SUCCESS)
}

/// Source, target and result, a row for each view.
fn picture(args: &Args, pair: &Pair, positions: &Positions) -> anyhow::Result<Image> {
    let gallery = Gallery::new(pair, positions, args.view.up, PICTURE_SIZE)?;
    let row = |view| {
        Image::row(&[
            gallery.source(view),
            gallery.target(view),
            gallery.initial(positions, view),
        ])
    };
    let views = args.view.views_or(&[View::FRONT_QUARTER]);
    let rows: Vec<Image> = views.into_iter().map(row).collect();
    Ok(Image::column(&rows))
}

fn check_outputs(args: &Args) -> anyhow::Result<()> {
    args.pipe
        .check(&[&args.source, &args.target], Some(&args.output))?;
    args.pipe
        .check_output(&args.output, &[&args.source, &args.target])?;
    if let Some(path) = &args.render {
        check_writable(path)?;
    }
    Ok(())
}
