//! All settings of a run in one type: presets by name, and as TOML.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use neural_drape::DrapeConfig;
use serde::de::DeserializeOwned;
use toml::{Table, Value};

use crate::{plain_words, InitialMethod};

/// How a source is draped: the initial deformation and the drape itself.
///
/// ```
/// use mesh_draping::Preset;
/// let preset = Preset::from_toml("preset = \"standard\"\nseed = 7\n")?;
/// assert_eq!((preset.name.as_str(), preset.drape.seed), ("standard", 7));
/// assert_eq!(Preset::from_toml(&preset.to_toml())?, preset);
/// # Ok::<(), mesh_draping::preset::PresetError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Preset {
    /// The name of the preset that the settings come from.
    pub name: String,
    /// How the source is brought to its landmarks first.
    pub initial: InitialMethod,
    /// The drape.
    pub drape: DrapeConfig,
}

/// A name, and what it stands for.
type Named = (&'static str, fn() -> Preset);

const PRESETS: [Named; 5] = [
    ("standard", Preset::standard),
    ("quick", Preset::quick),
    ("network", Preset::network),
    ("paper", Preset::paper),
    ("authors", Preset::authors),
];

impl Preset {
    /// The default: preconditioned vertices, from coarse to fine ([`DrapeConfig::standard`]).
    pub fn standard() -> Self {
        Self::of_drape("standard", DrapeConfig::standard())
    }

    /// A fifth of [`Self::standard`], to look at ([`DrapeConfig::quick`]).
    pub fn quick() -> Self {
        Self::of_drape("quick", DrapeConfig::quick())
    }

    /// The paper's network under the losses of [`Self::standard`] ([`DrapeConfig::network`]).
    pub fn network() -> Self {
        Self::of_drape("network", DrapeConfig::network())
    }

    /// The paper as printed ([`DrapeConfig::paper`]), its initial deformation included.
    pub fn paper() -> Self {
        Self {
            initial: InitialMethod::Paper,
            ..Self::of_drape("paper", DrapeConfig::paper())
        }
    }

    /// The authors' program ([`DrapeConfig::authors`]), its initial deformation included.
    pub fn authors() -> Self {
        Self {
            initial: InitialMethod::Paper,
            ..Self::of_drape("authors", DrapeConfig::authors())
        }
    }

    fn of_drape(name: &str, drape: DrapeConfig) -> Self {
        Self {
            name: name.to_owned(),
            initial: InitialMethod::Tried,
            drape,
        }
    }

    /// The names of the presets, the default first.
    pub fn names() -> impl Iterator<Item = &'static str> {
        PRESETS.iter().map(|(name, _)| *name)
    }

    /// The paper's studies, which change one thing each, and the default without the network that leads: presets, too
    /// ([`DrapeConfig::studies`], and another start).
    pub fn studies() -> Vec<Self> {
        let studies = DrapeConfig::studies().into_iter();
        let mut presets: Vec<Self> = studies
            .map(|study| Self::of_drape(study.name, study.config))
            .collect();
        let starts = [
            ("study-biharmonic-start", InitialMethod::Paper),
            ("study-affine-start", InitialMethod::Affine),
        ];
        presets.extend(starts.map(|(name, initial)| Self {
            initial,
            ..Self::of_drape(name, DrapeConfig::study())
        }));
        presets.push(Self::by_vertices("study-vertices", 1.0));
        presets.push(Self::by_vertices("study-vertices-longer", 1.5));
        presets
    }

    /// The default without the network that leads, with `times` the iterations.
    fn by_vertices(name: &str, times: f64) -> Self {
        let mut drape = DrapeConfig::standard();
        for stage in &mut drape.stages {
            stage.n_iterations = (stage.n_iterations as f64 * times) as usize;
        }
        Self {
            initial: InitialMethod::TriedByVertices,
            ..Self::of_drape(name, drape)
        }
    }

    /// The preset or study of this name.
    ///
    /// # Errors
    /// There is none.
    pub fn named(name: &str) -> Result<Self, PresetError> {
        if let Some((_, preset)) = PRESETS.iter().find(|(known, _)| *known == name) {
            return Ok(preset());
        }
        let mut studies = Self::studies().into_iter();
        let unknown = || PresetProblem::Unknown {
            name: name.to_owned(),
        };
        Ok(studies
            .find(|study| study.name == name)
            .ok_or_else(unknown)?)
    }

    /// The settings in the text of a TOML file, over those of the preset that its key `preset` names, else the default.
    /// `initial` says how the source is brought to its landmarks; all other keys are fields of [`DrapeConfig`].
    ///
    /// # Errors
    /// A line that does not read, or a name that is no setting. Ranges are checked by [`DrapeConfig::check`].
    pub fn from_toml(text: &str) -> Result<Self, PresetError> {
        Ok(over(parse(text)?, None)?)
    }

    /// As [`Self::from_toml`], from a file; `preset` replaces the name of the preset in it.
    ///
    /// # Errors
    /// As [`Self::from_toml`], naming the file; or the file cannot be read.
    pub fn read(path: impl AsRef<Path>, preset: Option<&str>) -> Result<Self, PresetError> {
        let path = path.as_ref();
        let of_file = |problem| PresetError {
            path: Some(path.to_owned()),
            problem,
        };
        let text = fs::read_to_string(path).map_err(|e| of_file(PresetProblem::Io(e)))?;
        let table = parse(&text).map_err(of_file)?;
        over(table, preset).map_err(of_file)
    }

    /// These settings, and the text of a TOML file over them, as in [`Self::from_toml`].
    ///
    /// ```
    /// use mesh_draping::Preset;
    /// let preset = Preset::quick().with_toml("[sampling]\nn_samples = 500\n")?;
    /// assert_eq!((preset.name.as_str(), preset.drape.sampling.n_samples), ("quick", 500));
    /// # Ok::<(), mesh_draping::preset::PresetError>(())
    /// ```
    ///
    /// # Errors
    /// As [`Self::from_toml`].
    pub fn with_toml(self, text: &str) -> Result<Self, PresetError> {
        Ok(over_preset(parse(text)?, self)?)
    }

    /// The settings as a TOML text that [`Self::from_toml`] reads back.
    pub fn to_toml(&self) -> String {
        // Settings are tables of numbers and names, so that this never fails.
        let body = toml::to_string(&self.drape).unwrap_or_default();
        let initial =
            Value::try_from(self.initial).map_or_else(|_| String::new(), |v| v.to_string());
        format!("preset = {:?}\ninitial = {initial}\n{body}", self.name)
    }
}

/// Settings that cannot be read.
#[derive(Debug, thiserror::Error)]
#[error("{}{problem}", path.as_ref().map_or_else(String::new, |path| format!("{}: ", path.display())))]
pub struct PresetError {
    /// The file; none for text in memory.
    pub path: Option<PathBuf>,
    /// What is wrong.
    pub problem: PresetProblem,
}

/// What is wrong with settings.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PresetProblem {
    /// The operating system refused.
    #[error("cannot be read: {0}")]
    Io(io::Error),
    /// No preset has this name.
    #[error("there is no preset '{name}'; there are {}", Preset::names().collect::<Vec<_>>().join(", "))]
    Unknown {
        /// What was asked for.
        name: String,
    },
    /// Not TOML.
    #[error("line {line}: {message}")]
    Syntax {
        /// The line, counted from 1.
        line: usize,
        /// What is wrong there.
        message: String,
    },
    /// A key with a value that it cannot have.
    #[error("{key}: {message}")]
    Value {
        /// The key.
        key: &'static str,
        /// What is wrong with it.
        message: String,
    },
    /// A name that is no setting, or a value that it cannot have.
    #[error("{0}")]
    Setting(String),
}

impl From<PresetProblem> for PresetError {
    fn from(problem: PresetProblem) -> Self {
        Self {
            path: None,
            problem,
        }
    }
}

fn parse(text: &str) -> Result<Table, PresetProblem> {
    text.parse().map_err(|error: toml::de::Error| {
        let before = error
            .span()
            .map_or("", |span| text.get(..span.start).unwrap_or(text));
        PresetProblem::Syntax {
            line: before.lines().count().max(1),
            message: plain_words(&error.message().replace('\n', ", ")),
        }
    })
}

/// The settings of `overrides` over those of the preset: `preset` if given, else the one the table names, else the
/// default.
fn over(mut overrides: Table, preset: Option<&str>) -> Result<Preset, PresetProblem> {
    let named: Option<String> = take(&mut overrides, "preset")?;
    let name = preset.map(str::to_owned).or(named);
    let preset = match name {
        Some(name) => Preset::named(&name).map_err(|error| error.problem)?,
        None => Preset::standard(),
    };
    over_preset(overrides, preset)
}

/// The settings of `overrides` over these.
fn over_preset(mut overrides: Table, preset: Preset) -> Result<Preset, PresetProblem> {
    let initial: Option<InitialMethod> = take(&mut overrides, "initial")?;
    let setting =
        |error: &dyn std::fmt::Display| PresetProblem::Setting(plain_words(&error.to_string()));
    let mut merged = Value::try_from(&preset.drape).map_err(|error| setting(&error))?;
    merge(&mut merged, Value::Table(overrides));
    let drape = merged.try_into();
    Ok(Preset {
        drape: drape.map_err(|error: toml::de::Error| setting(&error))?,
        initial: initial.unwrap_or(preset.initial),
        name: preset.name,
    })
}

/// A key that is no setting of the drape itself.
fn take<T: DeserializeOwned>(
    table: &mut Table,
    key: &'static str,
) -> Result<Option<T>, PresetProblem> {
    let Some(value) = table.remove(key) else {
        return Ok(None);
    };
    let value = value.try_into();
    let wrong = |error: toml::de::Error| PresetProblem::Value {
        key,
        message: plain_words(error.message()),
    };
    value.map(Some).map_err(wrong)
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
        let text = "seed = 9\n[sampling]\nn_samples = 77\n[[stages]]\nn_iterations = 5\n";
        let mut expected = DrapeConfig::standard();
        expected.seed = 9;
        expected.sampling.n_samples = 77;
        expected.stages.truncate(1);
        expected.stages[0].n_iterations = 5;
        assert_eq!(Preset::from_toml(text).unwrap().drape, expected);
    }

    #[test]
    fn every_preset_survives_its_own_file() {
        let presets = Preset::names().map(|name| Preset::named(name).unwrap());
        for preset in presets.chain(Preset::studies()) {
            assert_eq!(Preset::named(&preset.name).unwrap(), preset);
            assert_eq!(Preset::from_toml(&preset.to_toml()).unwrap(), preset);
        }
    }

    #[test]
    fn presets_have_their_own_initial_deformation() {
        let initial = |name: &str| Preset::named(name).unwrap().initial;
        assert_eq!(initial("standard"), InitialMethod::Tried);
        assert_eq!(initial("paper"), InitialMethod::Paper);
        assert_eq!(initial("authors"), InitialMethod::Paper);
        assert_eq!(initial("study"), InitialMethod::Tried);
        assert_eq!(initial("study-affine-start"), InitialMethod::Affine);
    }

    #[test]
    fn mistakes_are_named() {
        let error = |text: &str| Preset::from_toml(text).unwrap_err().to_string();
        assert!(error("sed = 1").contains("unknown field `sed`"));
        assert!(error("[sampling]\nsamples = 1").contains("unknown field `samples`"));
        assert!(error("seed = 1\nseed 2").contains("line 2"));
        assert!(error("preset = \"best\"").contains("no preset 'best'"));
        assert!(!error("seed = \"x\"").contains('\n'));
        assert!(error("initial = \"best\"").contains("initial: unknown variant `best`"));
    }
}
