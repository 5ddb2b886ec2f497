//! `drape transfer`

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use mesh_core::io::write_atomic;
use mesh_core::Positions;
use mesh_draping::mesh_metrics::Report;
use mesh_draping::{Motion, Outcome, Pair, Population, Stages, Transfer};
use mesh_render::{Gallery, Image, Page, View, DISTANCE_AT_TOP};

use crate::args::{
    bake, check_bakeable, check_maps, read_population, read_truth, say_beside, wrote, BakeArgs,
    Inputs, MorphArgs, PartArgs, PipeArgs, SettingsArgs, ViewArgs, WeldArgs,
};
use crate::output::{check_distinct, check_writable, warn};
use crate::profile::{self, ProfileArgs};
use crate::progress::Progress;
use crate::requirement::Requirements;
use crate::usage::{Stopwatch, Usage};
use crate::words;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Mesh to deform: its faces, texture coordinates, groups and order survive; - for standard input
    pub(super) source: PathBuf,
    /// Mesh or point cloud to drape it over; - for standard input
    pub(super) target: PathBuf,
    /// Places that belong together, as JSON
    #[arg(short, long, value_name = "FILE")]
    pub(super) landmarks: Option<PathBuf>,
    /// File to write: the source with its vertices moved; - for standard output
    #[arg(short, long, value_name = "OUT")]
    pub(super) output: PathBuf,
    #[command(flatten)]
    pub(super) pipe: PipeArgs,
    #[command(flatten)]
    pub(super) weld: WeldArgs,
    #[command(flatten)]
    pub(super) morphs: MorphArgs,
    #[command(flatten)]
    pub(super) settings: SettingsArgs,
    #[command(flatten)]
    pub(super) parts: PartArgs,
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
    /// Start from this shape of the source, the result of the frame before: no start is searched, and the run is a third
    /// as long
    #[arg(long, value_name = "FILE")]
    pub(super) from: Option<PathBuf>,
    /// The result of a motion's first frame: the surface holds to its angles and areas, which lead back what slid along it
    #[arg(long, value_name = "FILE", requires = "from")]
    pub(super) first_frame: Option<PathBuf>,
    /// Weight of an even change along the surface from that shape: less trembling over the frames of a motion, and limbs
    /// that lag behind. 50 is a good value
    #[arg(long, value_name = "WEIGHT", requires = "from")]
    pub(super) smooth_change: Option<f64>,
    /// Expect a shape like the results in this folder: their mean and the modes in which they differ. The one that fits best is
    /// one more start to try, and what the target does not show is taken from them
    #[arg(long, value_name = "FOLDER", conflicts_with = "from")]
    pub(super) prior: Option<PathBuf>,
    /// Make the result as symmetric as the source is
    #[arg(long)]
    pub(super) symmetric: bool,
    #[command(flatten)]
    pub(super) bake: BakeArgs,
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
    let figures = drape_files(args)?.figures();
    Ok(args
        .require
        .as_ref()
        .map_or(ExitCode::SUCCESS, |r| r.verdict(&figures)))
}

/// Drapes, writes and tells all that was asked for.
pub(super) fn drape_files(args: &Args) -> anyhow::Result<Done<'_>> {
    let watch = Stopwatch::start();
    let mut stages = args.profile.stages();
    check_outputs(args)?;
    let preset = args.settings.preset()?;
    let inputs = Inputs {
        source: &args.source,
        target: &args.target,
        landmarks: args.landmarks.as_deref(),
        seams: args.weld.weld,
        output: Some(&args.output),
        pipe: args.pipe,
    };
    let mut pair = stages.time("reading", || inputs.read())?;
    pair.source = pair.source.with_morphs(args.morphs.morphs.into());
    let truth = read_shape(args.truth.as_deref(), &pair)?;
    let frames = Frames::read(args, &pair)?;
    let prior = read_prior(args, &pair, &mut stages)?;
    check_bakeable(&args.bake.maps(), &pair.source, &args.target)?;
    let mut warnings = words::about_inputs(&pair);
    if let Some(file) = pair.source.file() {
        warnings.extend(
            args.morphs
                .check_output(file, &args.pipe.name(file, &args.output))?,
        );
    }
    let parts = args.parts.resolve(&pair)?;
    warnings.extend(words::notes(&parts.notes));
    warn(&warnings);

    let mut transfer = Transfer::of_pair(pair, preset)
        .with_regions(parts.regions)
        .with_stages(stages);
    if let Some(truth) = truth.clone() {
        transfer = transfer.with_truth(truth);
    }
    if args.symmetric {
        transfer = transfer.symmetric();
    }
    transfer = expected(transfer, frames, prior);
    let mut outcome = drape(transfer)?;
    let notes: Vec<String> = words::notes(&outcome.notes).collect();
    warn(&notes);
    warnings.extend(notes);
    let mut stages = std::mem::take(&mut outcome.stages);
    let mut done = Done {
        args,
        truth,
        warnings,
        usage: watch.read(),
        seconds: profile::seconds(&stages),
        outcome,
    };
    stages.time("writing", || done.write())?;
    let baked = stages.time("baking", || done.bake())?;
    warn(&baked);
    done.warnings.extend(baked);
    done.tell(&watch, &stages)?;
    Ok(done)
}

/// The shapes that the source took before, where a folder of them is given.
fn read_prior(args: &Args, pair: &Pair, stages: &mut Stages) -> anyhow::Result<Option<Population>> {
    let read = |folder| stages.time("prior", || read_population(folder, &pair.source));
    args.prior.as_deref().map(read).transpose()
}

/// What a motion came to so far, and how evenly it shall go on.
struct Frames {
    before: Option<Positions>,
    first: Option<Positions>,
    smooth_change: Option<f64>,
}

impl Frames {
    fn read(args: &Args, pair: &Pair) -> anyhow::Result<Self> {
        Ok(Self {
            before: read_shape(args.from.as_deref(), pair)?,
            first: read_shape(args.first_frame.as_deref(), pair)?,
            smooth_change: args.smooth_change,
        })
    }
}

/// After the frames of a motion so far; or with the shapes that the source took before.
fn expected(transfer: Transfer, frames: Frames, prior: Option<Population>) -> Transfer {
    let transfer = match frames.smooth_change {
        Some(weight) => transfer.with_smooth_change(weight),
        None => transfer,
    };
    match (frames.before, frames.first, prior) {
        (Some(before), Some(first), _) => transfer.with_motion(Motion { first, before }),
        (Some(before), None, _) => transfer.with_start(before),
        (None, _, Some(prior)) => transfer.with_prior(prior),
        (None, _, None) => transfer,
    }
}

/// A shape of the source in a file, where one is given.
fn read_shape(path: Option<&Path>, pair: &Pair) -> anyhow::Result<Option<Positions>> {
    path.map(|path| read_truth(path, &pair.source)).transpose()
}

/// Drapes and shows it.
fn drape(transfer: Transfer) -> anyhow::Result<Outcome> {
    let mut draping = transfer.start()?;
    let mut progress = Progress::start(draping.n_iterations());
    while let Some(step) = draping.step()? {
        progress.show(&step);
    }
    progress.finish();
    Ok(draping.finish()?)
}

fn check_outputs(args: &Args) -> anyhow::Result<()> {
    args.pipe
        .check(&[&args.source, &args.target], Some(&args.output))?;
    let inputs: Vec<&Path> = [
        Some(&args.source),
        Some(&args.target),
        args.landmarks.as_ref(),
        args.truth.as_ref(),
        args.from.as_ref(),
        args.first_frame.as_ref(),
    ]
    .into_iter()
    .flatten()
    .map(PathBuf::as_path)
    .collect();
    args.pipe.check_output(&args.output, &inputs)?;
    let outputs = [&args.report, &args.render, &args.warp];
    for path in outputs.into_iter().flatten() {
        check_writable(path)?;
        check_distinct(path, &inputs)?;
    }
    check_maps(&args.bake.maps(), &args.target, &inputs)
}

/// A finished run and what it was asked for.
pub(super) struct Done<'a> {
    args: &'a Args,
    truth: Option<Positions>,
    warnings: Vec<String>,
    outcome: Outcome,
    usage: Usage,
    /// Seconds of each stage.
    seconds: Vec<(&'static str, f64)>,
}

impl Done<'_> {
    fn write(&self) -> anyhow::Result<()> {
        let Self { args, outcome, .. } = self;
        let source = &outcome.pair.source;
        args.pipe
            .write_source(source, &outcome.draped, &args.output)?;
        if let Some(path) = &args.warp {
            outcome.warp()?.save(path)?;
        }
        if let Some(path) = &args.render {
            self.picture()?.save(path)?;
        }
        if let Some(path) = &args.report {
            write_atomic(path, self.page()?.as_bytes())?;
        }
        Ok(())
    }

    /// Bakes the maps that were asked for; what is worth knowing about them.
    fn bake(&self) -> anyhow::Result<Vec<String>> {
        let Self { args, outcome, .. } = self;
        let (source, target) = (&outcome.pair.source, &outcome.pair.target);
        let maps = args.bake.maps();
        bake(&maps, (source, &outcome.draped), target, &args.target)
    }

    fn gallery(&self, size: usize) -> anyhow::Result<Gallery<'_>> {
        let (pair, initial) = (&self.outcome.pair, &self.outcome.initial);
        Ok(Gallery::new(pair, initial, self.args.view.up, size)?)
    }

    /// All figures by name: of the result, of what was left out, of time and memory.
    fn figures(&self) -> Vec<(&'static str, f64)> {
        let mut figures = self.outcome.report.figures();
        figures.push(("left_out", self.outcome.left_out()));
        figures.extend(self.usage.figures());
        figures
    }

    /// What the judge says of the initial deformation and of the result.
    pub(super) fn reports(&self) -> anyhow::Result<[Report; 2]> {
        let run = &self.outcome;
        let initial = run.pair.judge(&run.by_landmarks, self.truth.as_ref())?;
        Ok([initial, run.report.clone()])
    }

    /// Source, target, initial deformation, result and distances, a row for each view.
    fn picture(&self) -> anyhow::Result<Image> {
        let (args, run) = (self.args, &self.outcome);
        let gallery = self.gallery(PNG_PICTURE)?;
        let distances = &run.report.vertex_distances;
        let marks = run.explanation.marks();
        let row = |view| {
            Image::row(&[
                gallery.source(view),
                gallery.target(view),
                gallery.initial(&run.by_landmarks, view),
                gallery.result(&run.draped, view),
                gallery.marked_heat(&run.draped, distances, DISTANCE_AT_TOP, &marks, view),
            ])
        };
        let views = args.view.views_or(&[View::FRONT_QUARTER]);
        Ok(Image::column(
            &views.into_iter().map(row).collect::<Vec<_>>(),
        ))
    }

    fn page(&self) -> anyhow::Result<String> {
        let args = self.args;
        let times = self.seconds.iter();
        let times = times.map(|(name, s)| ((*name).to_owned(), format!("{s:.2} s")));
        let all = ("all".to_owned(), self.usage.to_string());
        let page = Page {
            title: &format!("{} draped over {}", name(&args.source), name(&args.target)),
            outcome: &self.outcome,
            gallery: &self.gallery(REPORT_PICTURE)?,
            views: &args
                .view
                .views_or(&[View::FRONT_QUARTER, View::BACK_QUARTER]),
            warnings: &self.warnings,
            seconds: Some(self.usage.wall_seconds),
            times: &times.chain([all]).collect::<Vec<_>>(),
            truth: self.truth.as_ref(),
        };
        Ok(page.to_html()?)
    }

    /// Prints the figures, and where the time went if that was asked for.
    fn tell(&self, watch: &Stopwatch, stages: &Stages) -> anyhow::Result<()> {
        let is_profiled = self.args.profile.profile;
        if self.args.json {
            let mut json = self.json();
            if is_profiled {
                json["profile"] = profile::json(stages);
            }
            return Ok(self.say(&format!("{json:#}\n"))?);
        }
        self.say(&self.text())?;
        if is_profiled {
            self.say(&profile::table(stages, &watch.read()))?;
        }
        Ok(())
    }

    fn say(&self, text: &str) -> std::io::Result<()> {
        say_beside(&self.args.output, text)
    }

    fn text(&self) -> String {
        let (args, run) = (self.args, &self.outcome);
        let outputs = [
            Some(&args.output),
            args.warp.as_ref(),
            args.render.as_ref(),
            args.report.as_ref(),
        ];
        let maps = args.bake.maps();
        let written = outputs.into_iter().flatten().map(PathBuf::as_path);
        let written = written.chain(maps.paths()).map(wrote);
        let written: String = written.collect();
        let seams = words::seams(&run.pair.source);
        let seams = seams.map_or_else(String::new, |words| format!("{words}\n"));
        format!(
            "{}{}\n{seams}preset {}, seed {}: {}\n{written}",
            run.report,
            words::explanation(&run.explanation),
            run.preset.name,
            run.preset.drape.seed,
            self.usage
        )
    }

    fn json(&self) -> serde_json::Value {
        let (args, run) = (self.args, &self.outcome);
        serde_json::json!({
            "source": args.source,
            "target": args.target,
            "landmarks": args.landmarks,
            "output": args.output,
            "preset": run.preset.name,
            "initial": run.preset.initial,
            "settings": run.preset.drape,
            "figures": self.figures().into_iter().collect::<BTreeMap<_, _>>(),
            "report": run.report,
            "explanation": words::explanation_json(&run.explanation),
            "usage": self.usage,
            "stages": self.seconds.iter().copied().collect::<BTreeMap<_, _>>(),
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
