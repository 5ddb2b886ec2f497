//! `drape transfer`

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

use mesh_core::io::write_atomic;
use mesh_core::Positions;

use crate::gallery::{Gallery, ViewArgs, DISTANCE_AT_TOP};
use crate::input::{read_positions, Pair};
use crate::output::{check_distinct, check_mesh, check_writable, left_beside, say, warn};
use crate::profile::{ProfileArgs, Stages};
use crate::regions::RegionArgs;
use crate::render::{Image, View};
use crate::report::Page;
use crate::requirement::Requirements;
use crate::run::Run;
use crate::seams::{MorphArgs, WeldArgs};
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
    pub(super) weld: WeldArgs,
    #[command(flatten)]
    pub(super) morphs: MorphArgs,
    #[command(flatten)]
    pub(super) settings: SettingsArgs,
    #[command(flatten)]
    pub(super) regions: RegionArgs,
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
    #[command(flatten)]
    pub(super) profile: ProfileArgs,
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
    let mut stages = Stages::new(&args.profile);
    check_outputs(args)?;
    let settings = args.settings.settings()?;
    let landmarks = args.landmarks.as_deref();
    let mut pair = stages.time("reading", || {
        Pair::read(&args.source, &args.target, landmarks, args.weld.weld)
    })?;
    Arc::make_mut(&mut pair.file).set_morphs(args.morphs.morphs.into());
    pair.file.check_writable(&args.output)?;
    let truth = args
        .truth
        .as_deref()
        .map(|path| read_positions(path, &pair.source))
        .transpose()?;

    let mut warnings = pair.warnings();
    warnings.extend(args.morphs.left_behind(&pair.file, &args.output));
    let chosen = args.regions.resolve(&pair)?;
    warnings.extend(chosen.notes);
    warnings.extend(pair.file.lost_in(&args.output));
    warnings.extend(left_beside(&pair.file, &args.output));
    warn(&warnings);
    let run = Run::new(
        &pair,
        settings,
        &chosen.regions,
        truth.as_ref(),
        &watch,
        &mut stages,
    )?;
    warn(&run.notes);
    warnings.extend(run.notes.iter().cloned());
    let done = Done {
        args,
        pair,
        truth,
        warnings,
        run,
    };
    stages.time("writing", || done.write())?;
    done.tell(&watch, &stages)?;
    let figures = done.run.figures();
    Ok(args
        .require
        .as_ref()
        .map_or(ExitCode::SUCCESS, |r| r.verdict(&figures)))
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

/// A finished run and what it was asked for.
struct Done<'a> {
    args: &'a Args,
    pair: Pair,
    truth: Option<Positions>,
    warnings: Vec<String>,
    run: Run,
}

impl Done<'_> {
    fn write(&self) -> anyhow::Result<()> {
        let Self {
            args, pair, run, ..
        } = self;
        let draped = pair.source.spread(&run.draped);
        pair.file.write(&args.output, &draped)?;
        if let Some(path) = &args.warp {
            run.warp(pair)?.save(path)?;
        }
        if let Some(path) = &args.render {
            self.picture().save(path)?;
        }
        if let Some(path) = &args.report {
            write_atomic(path, self.page()?.as_bytes())?;
        }
        Ok(())
    }

    /// Source, target, initial deformation, result and distances, a row for each view.
    fn picture(&self) -> Image {
        let Self { args, run, .. } = self;
        let gallery = Gallery::new(&self.pair, &run.initial, args.view.up, PNG_PICTURE);
        let distances = &run.report.vertex_distances;
        let marks = run.explanation.marks();
        let row = |view| {
            Image::row(&[
                gallery.source(view),
                gallery.target(view),
                gallery.initial(&run.initial, view),
                gallery.result(&run.draped, view),
                gallery.marked_heat(&run.draped, distances, DISTANCE_AT_TOP, &marks, view),
            ])
        };
        let views = args.view.views_or(&[View::FRONT_QUARTER]);
        Image::column(&views.into_iter().map(row).collect::<Vec<_>>())
    }

    fn page(&self) -> anyhow::Result<String> {
        let Self { args, run, .. } = self;
        let page = Page {
            title: &format!("{} draped over {}", name(&args.source), name(&args.target)),
            run,
            gallery: &Gallery::new(&self.pair, &run.initial, args.view.up, REPORT_PICTURE),
            views: &args
                .view
                .views_or(&[View::FRONT_QUARTER, View::BACK_QUARTER]),
            warnings: &self.warnings,
            truth: self.truth.as_ref(),
        };
        page.to_html()
    }

    /// Prints the figures, and where the time went if that was asked for.
    fn tell(&self, watch: &Stopwatch, stages: &Stages) -> anyhow::Result<()> {
        let is_profiled = self.args.profile.profile;
        if self.args.json {
            let mut json = self.json();
            if is_profiled {
                json["profile"] = stages.json();
            }
            return Ok(say(&format!("{json:#}\n"))?);
        }
        say(&self.text())?;
        if is_profiled {
            say(&stages.table(&watch.read()))?;
        }
        Ok(())
    }

    fn text(&self) -> String {
        let Self { args, run, .. } = self;
        let outputs = [
            Some(&args.output),
            args.warp.as_ref(),
            args.render.as_ref(),
            args.report.as_ref(),
        ];
        let wrote = |path: &PathBuf| format!("wrote {}\n", path.display());
        let written: String = outputs.into_iter().flatten().map(wrote).collect();
        let (settings, usage) = (&run.settings, &run.usage);
        let seed = settings.config.seed;
        let seams = self.pair.source.seams_in_words();
        let seams = seams.map_or_else(String::new, |words| format!("{words}\n"));
        format!(
            "{}{}\n{seams}preset {}, seed {seed}: {usage}\n{written}",
            run.report,
            run.explanation.text(),
            settings.preset
        )
    }

    fn json(&self) -> serde_json::Value {
        let Self { args, run, .. } = self;
        serde_json::json!({
            "source": args.source,
            "target": args.target,
            "landmarks": args.landmarks,
            "output": args.output,
            "preset": run.settings.preset,
            "initial": run.settings.start,
            "settings": run.settings.config,
            "figures": run.figures().into_iter().collect::<BTreeMap<_, _>>(),
            "report": run.report,
            "explanation": run.explanation,
            "usage": run.usage,
            "stages": run.stages.iter().copied().collect::<BTreeMap<_, _>>(),
            "warnings": self.warnings,
        })
    }
}

fn name(path: &Path) -> String {
    path.file_name()
        .unwrap_or(path.as_os_str())
        .to_string_lossy()
        .into_owned()
}
