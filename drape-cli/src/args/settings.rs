//! Settings of a run: a preset, a TOML file over it, and the command line over both.

use std::path::PathBuf;

use mesh_draping::{InitialMethod, Preset};
use neural_drape::OverlapMode;

/// Which settings to run with.
#[derive(Clone, Debug, Default, clap::Args)]
pub(crate) struct SettingsArgs {
    /// Named settings to start from; `drape presets` lists them
    #[arg(long, value_name = "NAME")]
    pub(crate) preset: Option<String>,
    /// TOML file whose settings replace those of the preset; `drape presets NAME` prints one to start from
    #[arg(long, value_name = "FILE")]
    pub(crate) config: Option<PathBuf>,
    /// How the source is brought to its landmarks first; the preset's own way where not given
    #[arg(long, value_name = "NAME")]
    pub(crate) initial: Option<InitialArg>,
    /// Seed of every random draw: same seed, same result
    #[arg(long, value_name = "N")]
    pub(crate) seed: Option<u64>,
    /// Which shape is only a part of the other: the rest of the other is left out
    #[arg(long, value_name = "WHICH")]
    pub(crate) overlap: Option<OverlapArg>,
}

/// [`InitialMethod`] on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum InitialArg {
    /// Affine, then rotations and scales spread from the landmarks: least distortion
    Standard,
    /// The paper's: affine, then a biharmonic field
    Paper,
    /// The affine map alone
    Affine,
}

impl From<InitialArg> for InitialMethod {
    fn from(arg: InitialArg) -> Self {
        match arg {
            InitialArg::Standard => Self::Standard,
            InitialArg::Paper => Self::Paper,
            InitialArg::Affine => Self::Affine,
        }
    }
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

impl SettingsArgs {
    /// Whether the command line says anything about settings.
    pub(crate) fn is_given(&self) -> bool {
        self.preset.is_some()
            || self.config.is_some()
            || self.initial.is_some()
            || self.seed.is_some()
            || self.overlap.is_some()
    }

    /// All settings in one.
    pub(crate) fn preset(&self) -> anyhow::Result<Preset> {
        let mut preset = match (&self.config, &self.preset) {
            (Some(path), name) => Preset::read(path, name.as_deref())?,
            (None, Some(name)) => Preset::named(name)?,
            (None, None) => Preset::standard(),
        };
        if let Some(initial) = self.initial {
            preset.initial = initial.into();
        }
        if let Some(seed) = self.seed {
            preset.drape.seed = seed;
        }
        if let Some(overlap) = self.overlap {
            preset.drape.overlap = overlap.into();
        }
        Ok(preset)
    }
}
