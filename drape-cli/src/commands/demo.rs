//! `drape demo`

use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

use mesh_draping::mesh_metrics::Report;
use mesh_draping::Seams;

use super::transfer;
use crate::args::{
    BakeArgs, MorphArgs, Morphing, PartArgs, PipeArgs, SettingsArgs, ViewArgs, WeldArgs,
};
use crate::creatures;
use crate::output::say;
use crate::profile::ProfileArgs;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Folder for the files of the demo
    #[arg(short, long, value_name = "FOLDER", default_value = "drape-demo")]
    output: PathBuf,
    #[command(flatten)]
    settings: SettingsArgs,
}

pub(super) fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let files = creatures::write(&args.output, &creatures::demo_pair())?;
    let name = |name: &str| args.output.join(name);
    let transfer = transfer::Args {
        from: None,
        first_frame: None,
        prior: None,
        smooth_change: None,
        symmetric: false,
        bake: BakeArgs::none(),
        profile: ProfileArgs { profile: false },
        source: files.source,
        target: files.target,
        landmarks: files.landmarks,
        output: name("draped.obj"),
        pipe: PipeArgs::default(),
        weld: WeldArgs { weld: Seams::EXACT },
        morphs: MorphArgs {
            morphs: Morphing::Keep,
        },
        settings: args.settings.clone(),
        report: Some(name("report.html")),
        render: Some(name("draped.png")),
        parts: PartArgs::default(),
        view: ViewArgs::none(),
        truth: Some(files.truth),
        warp: Some(name("draped.drape")),
        require: None,
        json: false,
    };
    let folder = args.output.display();
    say(&format!(
        "A dog over a giraffe. The same as: drape transfer {folder}/source.obj {folder}/target.obj \
         --landmarks {folder}/landmarks.json --truth {folder}/truth.ply -o {folder}/draped.obj \
         --warp {folder}/draped.drape --report {folder}/report.html --render {folder}/draped.png\n\n"
    ))?;
    let done = transfer::drape_files(&transfer)?;
    say(&format!("\n{}", before_and_after(&done.reports()?)))?;
    Ok(ExitCode::SUCCESS)
}

/// Names, headings, factors and decimals of the figures that are shown beside each other.
const SHOWN: [(&str, &str, f64, usize); 4] = [
    ("q_transfer", "Q_transfer, 1 is best", 1.0, 4),
    ("truth_mean", "from the truth, mean, e-2", 100.0, 3),
    ("folds", "folded edges, new", 1.0, 0),
    ("self_intersections_new", "crossings, new", 1.0, 0),
];

/// The initial deformation beside the result.
fn before_and_after(reports: &[Report; 2]) -> String {
    let mut text = format!("{:28} {:>10} {:>10}\n", "", "initial", "result");
    for (name, heading, factor, decimals) in SHOWN {
        let values = reports.each_ref().map(|report| {
            let figures = report.figures();
            figures
                .iter()
                .find(|f| f.0 == name)
                .map_or(f64::NAN, |f| f.1 * factor)
        });
        let [before, after] = values.map(|v| format!("{v:.decimals$}"));
        let _ = writeln!(text, "{heading:28} {before:>10} {after:>10}");
    }
    text
}
