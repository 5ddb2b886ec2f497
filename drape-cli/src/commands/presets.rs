//! `drape presets`

use std::process::ExitCode;

use neural_drape::DrapeConfig;

use crate::initial::STUDY_OF_START;
use crate::output::say;
use crate::settings::{to_toml, SettingsArgs};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Preset whose settings to print
    name: Option<String>,
}

pub(super) fn run(args: &Args) -> anyhow::Result<ExitCode> {
    match &args.name {
        None => {
            let studies = DrapeConfig::studies();
            let names = DrapeConfig::PRESETS
                .into_iter()
                .chain(studies.iter().map(|s| s.name))
                .chain([STUDY_OF_START]);
            say(&names.map(|name| format!("{name}\n")).collect::<String>())?;
        }
        Some(name) => {
            let settings = SettingsArgs {
                preset: Some(name.clone()),
                config: None,
                initial: None,
                seed: None,
                overlap: None,
            };
            say(&to_toml(&settings.settings()?)?)?;
        }
    }
    Ok(ExitCode::SUCCESS)
}
