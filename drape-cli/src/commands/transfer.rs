//! `drape transfer`

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use mesh_core::io::write_atomic;
use mesh_core::Positions;

use crate::gallery::{Gallery, ViewArgs, DISTANCE_AT_TOP};
use crate::input::{read_positions, Pair};
use crate::landmarks::doctor;
use crate::output::{check_distinct, check_mesh, check_writable, say, warn};
use crate::render::{Image, View};
use crate::report::Page;
use crate::requirement::Requirements;
use crate::run::Run;
use crate::settings::SettingsArgs;
use crate::usage::Stopwatch;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Mesh to deform: its faces, texture coordinates, groups and order survive
    pub(super) source: PathBuf,
    /// Mesh or point cloud to drape it over
    pub(super) target: PathBuf,
    /// Places that belong together, as JSON
    #[arg(short, long, value_name = "FILE")]
    pub(super) landmarks: Option<PathBuf>,
    /// File to write: the source with its vertices moved
    #[arg(short, long, value_name = "OUT")]
    pub(super) output: PathBuf,
    #[command(flatten)]
    pub(super) settings: SettingsArgs,
    /// Write a page with pictures, figures, curves and settings
    #[arg(long, value_name = "HTML")]
    pub(super) report: Option<PathBuf>,
    /// Draw source, target, initial deformation, result and distances into a PNG file
    #[arg(long, value_name = "PNG")]
    pub(super) render: Option<PathBuf>,
    #[command(flatten)]
    pub(super) view: ViewArgs,
    /// Mesh whose vertices are where those of the result belong, to judge by
    #[arg(long, value_name = "FILE")]
    pub(super) truth: Option<PathBuf>,
    /// Save the map, for `drape apply`
    #[arg(long, value_name = "WARP")]
    pub(super) warp: Option<PathBuf>,
    /// Conditions such as 'q>=0.85,folds=0'; the exit code is 1 where one does not hold
    #[arg(long, value_name = "CONDITIONS")]
    pub(super) require: Option<Requirements>,
    /// Print JSON
    #[arg(long)]
    pub(super) json: bool,
}

/// Pixels along the side of a picture in the report.
const REPORT_PICTURE: usize = 440;
/// Pixels along the side of a picture in a PNG file.
const PNG_PICTURE: usize = 420;

pub(super) fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let watch = Stopwatch::start();
    check_outputs(args)?;
    let settings = args.settings.settings()?;
    let pair = Pair::read(&args.source, &args.target, args.landmarks.as_deref())?;
    pair.file.check_writable(&args.output)?;
    let truth = args
        .truth
        .as_deref()
        .map(|path| read_positions(path, &pair.source))
        .transpose()?;

    let mut warnings = doctor::examine(&pair);
    warnings.extend(pair.file.lost_in(&args.output));
    warn(&warnings);
    let run = Run::new(&pair, settings, truth.as_ref(), (&watch, warnings))?;

    pair.file.write(&args.output, &run.draped)?;
    if let Some(path) = &args.warp {
        run.warp(&pair)?.save(path)?;
    }
    draw(args, &pair, &run, truth.as_ref())?;
    say(&if args.json {
        json(args, &run)?
    } else {
        text(args, &run)
    })?;
    Ok(args
        .require
        .as_ref()
        .map_or(ExitCode::SUCCESS, |r| r.verdict(&run.figures())))
}

fn check_outputs(args: &Args) -> anyhow::Result<()> {
    check_mesh(&args.output)?;
    let inputs: Vec<&Path> = [
        Some(&args.source),
        Some(&args.target),
        args.landmarks.as_ref(),
        args.truth.as_ref(),
    ]
    .into_iter()
    .flatten()
    .map(PathBuf::as_path)
    .collect();
    let outputs = [
        Some(&args.output),
        args.report.as_ref(),
        args.render.as_ref(),
        args.warp.as_ref(),
    ];
    for path in outputs.into_iter().flatten() {
        check_writable(path)?;
        check_distinct(path, &inputs)?;
    }
    Ok(())
}

fn draw(args: &Args, pair: &Pair, run: &Run, truth: Option<&Positions>) -> anyhow::Result<()> {
    let gallery = |size| {
        Gallery::new(
            &pair.source,
            &pair.target,
            &pair.landmarks,
            &run.initial,
            (args.view.up, size),
        )
    };
    if let Some(path) = &args.render {
        let gallery = gallery(PNG_PICTURE);
        let row = |view| {
            Image::row(&[
                gallery.source(view),
                gallery.target(view),
                gallery.initial(&run.initial, view),
                gallery.result(&run.draped, view),
                gallery.heat(
                    &run.draped,
                    &run.report.vertex_distances,
                    DISTANCE_AT_TOP,
                    view,
                ),
            ])
        };
        let rows: Vec<Image> = args
            .view
            .views_or(&[View::FRONT_QUARTER])
            .into_iter()
            .map(row)
            .collect();
        Image::column(&rows).save(path)?;
    }
    if let Some(path) = &args.report {
        let page = Page {
            title: &format!("{} draped over {}", stem(&args.source), stem(&args.target)),
            run,
            gallery: &gallery(REPORT_PICTURE),
            views: &args
                .view
                .views_or(&[View::FRONT_QUARTER, View::BACK_QUARTER]),
            truth,
        };
        write_atomic(path, page.to_html()?.as_bytes())?;
    }
    Ok(())
}

fn stem(path: &Path) -> String {
    path.file_name()
        .unwrap_or(path.as_os_str())
        .to_string_lossy()
        .into_owned()
}

fn text(args: &Args, run: &Run) -> String {
    let outputs = [
        Some(&args.output),
        args.warp.as_ref(),
        args.render.as_ref(),
        args.report.as_ref(),
    ];
    let written: String = outputs
        .into_iter()
        .flatten()
        .map(|path| format!("wrote {}\n", path.display()))
        .collect();
    let settings = &run.settings;
    format!(
        "{}\npreset {}, seed {}: {}\n{written}",
        run.report, settings.preset, settings.config.seed, run.usage
    )
}

fn json(args: &Args, run: &Run) -> anyhow::Result<String> {
    let json = serde_json::json!({
        "source": args.source,
        "target": args.target,
        "landmarks": args.landmarks,
        "output": args.output,
        "preset": run.settings.preset,
        "settings": run.settings.config,
        "figures": run.figures().into_iter().collect::<BTreeMap<_, _>>(),
        "report": run.report,
        "usage": run.usage,
        "stages": run.stages.iter().copied().collect::<BTreeMap<_, _>>(),
        "warnings": run.warnings,
    });
    Ok(format!("{json:#}\n"))
}
