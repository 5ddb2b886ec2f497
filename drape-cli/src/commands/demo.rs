//! `drape demo`

use std::path::PathBuf;
use std::process::ExitCode;

use mesh_draping::Seams;

use super::transfer;
use crate::args::{MorphArgs, Morphing, PartArgs, SettingsArgs, ViewArgs, WeldArgs};
use crate::demo;
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
    let files = demo::write(&args.output)?;
    let name = |name: &str| args.output.join(name);
    let transfer = transfer::Args {
        profile: ProfileArgs { profile: false },
        source: files.source,
        target: files.target,
        landmarks: Some(files.landmarks),
        output: name("draped.obj"),
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
        "The same as: drape transfer {folder}/source.obj {folder}/target.obj --landmarks {folder}/landmarks.json \
         --truth {folder}/truth.obj -o {folder}/draped.obj --warp {folder}/draped.drape \
         --report {folder}/report.html --render {folder}/draped.png\n\n"
    ))?;
    transfer::run(&transfer)
}
