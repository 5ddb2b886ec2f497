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
            let names = Preset::names().chain(Preset::studies());
            say(&names.map(|name| format!("{name}\n")).collect::<String>())?;
        }
        Some(name) => say(&Preset::named(name)?.to_toml())?,
    }
    Ok(ExitCode::SUCCESS)
}
