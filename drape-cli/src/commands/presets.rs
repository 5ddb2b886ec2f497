//! `drape presets`

use std::process::ExitCode;

use mesh_draping::Preset;

use crate::output::say;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Preset whose settings to print
    name: Option<String>,
}

pub(super) fn run(args: &Args) -> anyhow::Result<ExitCode> {
    match &args.name {
        None => {
            let studies = Preset::studies().into_iter().map(|study| study.name);
            let names = Preset::names().map(str::to_owned).chain(studies);
            say(&names.map(|name| name + "\n").collect::<String>())?;
        }
        Some(name) => say(&Preset::named(name)?.to_toml())?,
    }
    Ok(ExitCode::SUCCESS)
}
