//! The paper's studies: which settings are compared on which pairs, and what is said of them.

mod curve;
mod pairs;
mod report;
mod spread;
mod tables;

use std::path::Path;

use mesh_core::io::write_atomic;

use crate::suite::{Method, RunList, INITIAL};

pub(crate) use report::Report;

/// A study of `drape evaluate --study`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Study {
    /// The paper's tables: encoding, structural terms, λ and start, one thing changed at a time
    Paper,
    /// What progressive encoding buys, by the angle of limbs and the number of landmarks, in short runs
    Encoding,
    /// Vertices, the network, and the network that leads vertices, on creatures in hard poses
    Network,
    /// The default and the initial deformation on creatures over the whole dial, one thing turned at a time
    Dial,
}

/// Settings that are compared.
struct Theme {
    title: &'static str,
    /// Each with the name of its preset, the study's own settings first.
    variants: &'static [(&'static str, &'static str)],
}

const ENCODING: Theme = Theme {
    title: "Encoding",
    variants: &[
        ("progressive", "study"),
        ("static", "study-static-encoding"),
        ("none", "study-no-encoding"),
    ],
};
const STRUCTURE: Theme = Theme {
    title: "Structural terms",
    variants: &[
        ("angles and areas", "study"),
        ("angles", "study-angles-only"),
        ("areas", "study-areas-only"),
    ],
};
const LAMBDA: Theme = Theme {
    title: "λ",
    variants: &[
        ("1, then 0.2", "study"),
        ("1", "study-lambda-1"),
        ("0.2", "study-lambda-0.2"),
    ],
};
const START: Theme = Theme {
    title: "Start",
    variants: &[
        ("tried", "study"),
        ("the paper's, biharmonic", "study-biharmonic-start"),
        ("affine", "study-affine-start"),
    ],
};

const NETWORK: Theme = Theme {
    title: "Vertices, network, both",
    variants: &[
        ("vertices", "study-vertices"),
        (
            "vertices, half as many iterations more",
            "study-vertices-longer",
        ),
        ("network", "network"),
        ("network, then vertices", "standard"),
    ],
};

/// Settings over those of a preset for runs so short that budget decides.
const SHORT: &str = "initial = \"standard\"\n[sampling]\nn_samples = 1000\nmax_samples = 1000\n\
    [[stages]]\nn_iterations = 100\n[[stages]]\nn_iterations = 50\n";

impl Study {
    /// Its name on the command line.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::Encoding => "encoding",
            Self::Network => "network",
            Self::Dial => "dial",
        }
    }

    fn themes(self) -> &'static [Theme] {
        match self {
            Self::Paper => &[ENCODING, STRUCTURE, LAMBDA, START],
            Self::Encoding => &[ENCODING],
            Self::Network => &[NETWORK],
            Self::Dial => &[],
        }
    }

    /// All settings, each once; files of settings go into `folder`.
    fn methods(self, folder: &Path) -> anyhow::Result<Vec<Method>> {
        let variants = self.themes().iter().flat_map(|theme| theme.variants);
        let mut presets: Vec<&str> = variants.map(|(_, preset)| *preset).collect();
        if self == Self::Dial {
            presets = vec![INITIAL, "standard"];
        }
        presets.sort_unstable();
        presets.dedup();
        let method = |preset: &str| match self {
            Self::Paper | Self::Network | Self::Dial => Ok(Method::Preset(preset.to_owned())),
            Self::Encoding => {
                let path = folder.join(format!("{preset}.toml"));
                let text = format!("preset = \"{preset}\"\n{SHORT}");
                let is_there = std::fs::read(&path).is_ok_and(|bytes| bytes == text.as_bytes());
                if !is_there {
                    write_atomic(&path, text.as_bytes())?;
                }
                Ok(Method::Config(path))
            }
        };
        presets.into_iter().map(method).collect()
    }

    /// Its runs with seeds 0 to `n_seeds` − 1: on the pairs of `given`, or where there are none on creatures whose files are
    /// written into `folder`.
    pub(crate) fn list(
        self,
        given: RunList,
        n_seeds: u64,
        folder: &Path,
    ) -> anyhow::Result<RunList> {
        std::fs::create_dir_all(folder)?;
        let mut list = given;
        if list.names().is_empty() && list.absent().is_empty() {
            list.push(pairs::creatures(self, &folder.join("pairs"))?)?;
        }
        let seeds: Vec<u64> = (0..n_seeds).collect();
        Ok(list.with_methods(&self.methods(folder)?, &seeds))
    }
}

#[cfg(test)]
mod tests {
    use mesh_draping::Preset;

    use super::*;

    #[test]
    fn every_variant_is_a_preset_and_no_study_is_left_out() {
        let all = [Study::Paper, Study::Network];
        let variants = || {
            let themes = all.iter().flat_map(|study| study.themes());
            themes.flat_map(|theme| theme.variants)
        };
        for (_, preset) in variants() {
            assert!(Preset::named(preset).is_ok(), "{preset}");
        }
        for study in Preset::studies() {
            assert!(
                variants().any(|(_, preset)| *preset == study.name),
                "{}",
                study.name
            );
        }
        let themes = Study::Paper.themes().iter();
        assert!(themes.clone().all(|theme| theme.variants[0].1 == "study"));
    }

    #[test]
    fn short_settings_are_settings() {
        let preset = Preset::from_toml(&format!("preset = \"study\"\n{SHORT}")).unwrap();
        assert_eq!(preset.drape.n_iterations(), 150);
        assert_eq!(
            preset.drape.stages[1].from,
            Preset::named("study").unwrap().drape.stages[1].from
        );
        assert!(preset.drape.check().is_ok());
    }
}
