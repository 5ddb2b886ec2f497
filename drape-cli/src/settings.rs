//! Settings of a run: a preset, a TOML file over it, and the command line over both.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{anyhow, Context as _};
use neural_drape::{DrapeConfig, OverlapMode};
use toml::{Table, Value};

use crate::initial::{Start, STUDY_OF_START};

/// Which settings to run with.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct SettingsArgs {
    /// Named settings to start from; `drape presets` lists them
    #[arg(long, value_name = "NAME")]
    pub(crate) preset: Option<String>,
    /// TOML file whose settings replace those of the preset; `drape presets NAME` prints one to start from
    #[arg(long, value_name = "FILE")]
    pub(crate) config: Option<PathBuf>,
    /// How the source is brought to its landmarks first; the preset's own way where not given
    #[arg(long, value_name = "NAME")]
    pub(crate) initial: Option<Start>,
    /// Seed of every random draw: same seed, same result
    #[arg(long, value_name = "N")]
    pub(crate) seed: Option<u64>,
    /// Which shape is only a part of the other: the rest of the other is left out
    #[arg(long, value_name = "WHICH")]
    pub(crate) overlap: Option<OverlapArg>,
}

/// [`OverlapMode`] on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum OverlapArg {
    /// Found out from the initial deformation
    Auto,
    /// Both shapes are whole
    Full,
    /// The source covers only a part of the target, as a mask does
    SourcePartial,
    /// The target covers only a part of the source, as a scan from one side does
    TargetPartial,
    /// Each has parts that the other lacks
    Both,
}

impl From<OverlapArg> for OverlapMode {
    fn from(arg: OverlapArg) -> Self {
        match arg {
            OverlapArg::Auto => Self::Auto,
            OverlapArg::Full => Self::Full,
            OverlapArg::SourcePartial => Self::SourcePartial,
            OverlapArg::TargetPartial => Self::TargetPartial,
            OverlapArg::Both => Self::BothPartial,
        }
    }
}

/// Settings and the name of the preset that they come from.
#[derive(Clone, Debug)]
pub(crate) struct Settings {
    pub(crate) preset: String,
    pub(crate) start: Start,
    pub(crate) config: DrapeConfig,
}

impl SettingsArgs {
    /// Whether the command line says anything about settings.
    pub(crate) fn is_given(&self) -> bool {
        self.preset.is_some()
            || self.config.is_some()
            || self.initial.is_some()
            || self.seed.is_some()
            || self.overlap.is_some()
    }

    pub(crate) fn settings(&self) -> anyhow::Result<Settings> {
        let mut settings = match &self.config {
            Some(path) => read(path, self.preset.as_deref())?,
            None => over_preset(Table::new(), self.preset.as_deref())?,
        };
        settings.start = self.initial.unwrap_or(settings.start);
        if let Some(seed) = self.seed {
            settings.config.seed = seed;
        }
        if let Some(overlap) = self.overlap {
            settings.config.overlap = overlap.into();
        }
        Ok(settings)
    }
}

/// The settings as a TOML file that [`SettingsArgs`] reads back.
pub(crate) fn to_toml(settings: &Settings) -> anyhow::Result<String> {
    let body =
        toml::to_string(&settings.config).context("the settings cannot be written as TOML")?;
    let start =
        toml::Value::try_from(settings.start).context("the settings cannot be written as TOML")?;
    Ok(format!(
        "preset = {:?}\ninitial = {start}\n{body}",
        settings.preset
    ))
}

fn read(path: &Path, preset: Option<&str>) -> anyhow::Result<Settings> {
    let text =
        fs::read_to_string(path).with_context(|| format!("{}: cannot be read", path.display()))?;
    let table = parse(&text).with_context(|| path.display().to_string())?;
    over_preset(table, preset).with_context(|| path.display().to_string())
}

/// The settings in the text of a file.
pub(crate) fn from_text(text: &str) -> anyhow::Result<Settings> {
    over_preset(parse(text)?, None)
}

fn parse(text: &str) -> anyhow::Result<Table> {
    text.parse().map_err(|error: toml::de::Error| {
        let before = error
            .span()
            .map_or("", |span| text.get(..span.start).unwrap_or(text));
        let message = error.message().replace('\n', ", ");
        anyhow!("line {}: {message}", before.lines().count().max(1))
    })
}

/// The settings of `overrides` over those of the preset: `preset` if given, else the one the table names, else the
/// default.
fn over_preset(mut overrides: Table, preset: Option<&str>) -> anyhow::Result<Settings> {
    let named: Option<String> = take(&mut overrides, "preset")?;
    let start: Option<Start> = take(&mut overrides, "initial")?;
    let preset = preset
        .map(str::to_owned)
        .or(named)
        .unwrap_or_else(|| DrapeConfig::PRESETS[0].to_owned());
    let mut merged =
        Value::try_from(preset_config(&preset)?).context("the preset cannot be read")?;
    merge(&mut merged, Value::Table(overrides));
    let config = merged
        .try_into()
        .map_err(|error: toml::de::Error| anyhow!(error.to_string().trim().replace('\n', " ")))?;
    Ok(Settings {
        start: start.unwrap_or(Start::of_preset(&preset)),
        preset,
        config,
    })
}

/// The settings of a preset; the study of another start differs in its start alone.
pub(crate) fn preset_config(preset: &str) -> anyhow::Result<DrapeConfig> {
    match preset {
        STUDY_OF_START => Ok(DrapeConfig::study()),
        other => Ok(DrapeConfig::named(other)?),
    }
}

/// A key that is no setting of the drape itself.
fn take<T: serde::de::DeserializeOwned>(table: &mut Table, key: &str) -> anyhow::Result<Option<T>> {
    let Some(value) = table.remove(key) else {
        return Ok(None);
    };
    let value = value
        .try_into()
        .map_err(|error: toml::de::Error| anyhow!("{key}: {}", error.message()))?;
    Ok(Some(value))
}

/// Tables merge key by key; entry `k` of a list of tables starts from entry `k` of the list below it, or its last;
/// everything else is replaced. A table of one other key is another choice and replaces the first.
fn merge(below: &mut Value, above: Value) {
    match (below, above) {
        (Value::Table(below), Value::Table(above)) if !is_other_choice(below, &above) => {
            for (key, value) in above {
                match below.get_mut(&key) {
                    Some(known) => merge(known, value),
                    None => drop(below.insert(key, value)),
                }
            }
        }
        (Value::Array(below), Value::Array(above))
            if below.iter().all(Value::is_table) && !below.is_empty() =>
        {
            *below = above
                .into_iter()
                .enumerate()
                .map(|(k, value)| {
                    let mut entry = below[k.min(below.len() - 1)].clone();
                    merge(&mut entry, value);
                    entry
                })
                .collect();
        }
        (below, above) => *below = above,
    }
}

/// An enum with data is a table of one key, its variant.
fn is_other_choice(below: &Table, above: &Table) -> bool {
    below.len() == 1 && above.len() == 1 && below.keys().ne(above.keys())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_changes_what_it_names_and_nothing_else() {
        let settings =
            from_text("seed = 9\n[sampling]\nn_samples = 77\n[[stages]]\nn_iterations = 5\n")
                .unwrap();
        let mut expected = DrapeConfig::named(DrapeConfig::PRESETS[0]).unwrap();
        expected.seed = 9;
        expected.sampling.n_samples = 77;
        expected.stages.truncate(1);
        expected.stages[0].n_iterations = 5;
        assert_eq!(settings.config, expected);
    }

    #[test]
    fn every_preset_survives_its_own_file() {
        for preset in DrapeConfig::PRESETS {
            let before = over_preset(Table::new(), Some(preset)).unwrap();
            let after = from_text(&to_toml(&before).unwrap()).unwrap();
            assert_eq!(
                (after.preset, after.start, after.config),
                (before.preset, before.start, before.config)
            );
        }
    }

    #[test]
    fn mistakes_are_named() {
        let error = |text: &str| format!("{:#}", from_text(text).unwrap_err());
        assert!(error("sed = 1").contains("unknown field `sed`"));
        assert!(error("[sampling]\nsamples = 1").contains("unknown field `samples`"));
        assert!(error("seed = 1\nseed 2").contains("line 2"));
        assert!(error("preset = \"best\"").contains("no preset 'best'"));
        assert!(!error("seed = \"x\"").contains('\n'));
        assert!(error("initial = \"best\"").contains("initial: unknown variant `best`"));
    }
}
