//! `drape presets`

use std::process::ExitCode;

use mesh_draping::Preset;

use crate::initial::STUDY_OF_START;
use crate::output::say;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Preset whose settings to print
    name: Option<String>,
}

pub(super) fn run(args: &Args) -> anyhow::Result<ExitCode> {
    match &args.name {
        None => {
            let studies = Preset::studies();
            let names = Preset::names().chain(studies.iter().map(|study| study.name.as_str()));
            say(&names.map(|name| format!("{name}\n")).collect::<String>())?;
        }
        Some(name) => say(&Preset::named(name)?.to_toml())?,
    }
    Ok(ExitCode::SUCCESS)
}
