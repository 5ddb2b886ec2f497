//! Manifests: which pairs, presets and seeds to evaluate.
//!
//! ```toml
//! presets = ["standard", "paper", "mine.toml", "initial"]   # names, TOML files, or the initial deformation alone
//! seeds = [0, 1, 2]
//!
//! [[pair]]
//! name = "horse_wolf"              # the name of the target's folder where not given
//! source = "horse_wolf/source.obj" # paths count from the manifest's folder
//! target = "horse_wolf/target.obj"
//! landmarks = "horse_wolf/landmarks.json"
//! truth = "horse_wolf/truth.ply"   # where each vertex belongs, if known
//! judge = "horse_wolf/target.obj"  # target to judge against, where it is another one
//! ```

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{anyhow, ensure, Context as _};
use mesh_core::io::Format;
use mesh_draping::Preset;
use serde::Deserialize;

use super::{Method, Pair, Task, INITIAL};

/// A list of runs: every pair with every preset and every seed.
#[derive(Debug)]
pub(crate) struct Manifest {
    methods: Vec<Method>,
    seeds: Vec<u64>,
    pairs: Vec<Pair>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default)]
    presets: Vec<String>,
    #[serde(default)]
    seeds: Vec<u64>,
    pair: Vec<FilePair>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FilePair {
    name: Option<String>,
    source: PathBuf,
    target: PathBuf,
    landmarks: Option<PathBuf>,
    truth: Option<PathBuf>,
    judge: Option<PathBuf>,
}

impl Manifest {
    pub(crate) fn read(path: &Path) -> anyhow::Result<Self> {
        let text = fs::read_to_string(path)
            .with_context(|| format!("{}: cannot be read", path.display()))?;
        let folder = path.parent().unwrap_or(Path::new(""));
        Self::parse(&text, folder).with_context(|| path.display().to_string())
    }

    /// Every pair once with every preset; files of settings are counted from the current folder.
    ///
    /// # Errors
    /// An unknown preset.
    pub(crate) fn of_pairs(presets: &[String], pairs: Vec<Pair>) -> anyhow::Result<Self> {
        let methods = presets.iter().map(|p| method(p.clone(), Path::new("")));
        Ok(Self {
            methods: methods.collect::<anyhow::Result<_>>()?,
            seeds: vec![0],
            pairs,
        })
    }

    fn parse(text: &str, folder: &Path) -> anyhow::Result<Self> {
        let file: File = toml::from_str(text).map_err(|error| {
            let before = error
                .span()
                .map_or("", |span| text.get(..span.start).unwrap_or(text));
            anyhow!(
                "line {}: {}",
                before.lines().count().max(1),
                error.message().replace('\n', ", ")
            )
        })?;
        let presets = if file.presets.is_empty() {
            vec![Preset::standard().name]
        } else {
            file.presets
        };
        let manifest = Self {
            methods: presets
                .into_iter()
                .map(|p| method(p, folder))
                .collect::<anyhow::Result<_>>()?,
            seeds: if file.seeds.is_empty() {
                vec![0]
            } else {
                file.seeds
            },
            pairs: file.pair.into_iter().map(|p| p.into_pair(folder)).collect(),
        };
        let names: BTreeSet<&str> = manifest.pairs.iter().map(|p| p.name.as_str()).collect();
        ensure!(
            names.len() == manifest.pairs.len(),
            "two pairs have the same name; give each its own `name`"
        );
        Ok(manifest)
    }

    /// The runs, pair by pair; their files go into a folder for each pair.
    pub(crate) fn tasks(&self, folder: &Path) -> anyhow::Result<Vec<Task>> {
        let mut tasks = Vec::new();
        for pair in &self.pairs {
            let pair_folder = folder.join(&pair.name);
            fs::create_dir_all(&pair_folder)
                .with_context(|| format!("{}: the folder cannot be made", pair_folder.display()))?;
            let extension = extension_like(&pair.source);
            for method in &self.methods {
                // The initial deformation draws nothing at random: one seed tells all.
                let is_initial = *method == Method::Preset(INITIAL.to_owned());
                let seeds = if is_initial {
                    &self.seeds[..1]
                } else {
                    &self.seeds[..]
                };
                for &seed in seeds {
                    let name = pair_folder.join(format!("{}-{seed}", method.label()));
                    tasks.push(Task {
                        pair: pair.clone(),
                        method: method.clone(),
                        options: Vec::new(),
                        seed,
                        output: with_extension(&name, extension),
                        picture: with_extension(&name, "png"),
                    });
                }
            }
        }
        Ok(tasks)
    }
}

/// The source's extension, so that its format is kept; `obj` where that names none.
fn extension_like(source: &Path) -> &str {
    let extension = source.extension().and_then(|e| e.to_str());
    extension
        .filter(|_| Format::of_extension(source).is_some())
        .filter(|e| *e != "gz")
        .unwrap_or("obj")
}

/// Appends, where `Path::with_extension` would cut a name with a dot.
fn with_extension(name: &Path, extension: &str) -> PathBuf {
    let mut name = name.as_os_str().to_owned();
    name.push(format!(".{extension}"));
    name.into()
}

fn method(preset: String, folder: &Path) -> anyhow::Result<Method> {
    if Path::new(&preset).extension().is_some_and(|e| e == "toml") {
        return Ok(Method::Config(folder.join(preset)));
    }
    if preset != INITIAL {
        Preset::named(&preset)?;
    }
    Ok(Method::Preset(preset))
}

impl FilePair {
    fn into_pair(self, folder: &Path) -> Pair {
        let at = |path: PathBuf| folder.join(path);
        let target = at(self.target);
        let folder_name = target
            .parent()
            .and_then(Path::file_name)
            .map(|n| n.to_string_lossy().into_owned());
        Pair {
            name: self
                .name
                .or(folder_name)
                .unwrap_or_else(|| super::stem(&target)),
            source: at(self.source),
            target,
            landmarks: self.landmarks.map(at),
            truth: self.truth.map(at),
            judge: self.judge.map(at),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "presets = ['standard', 'a/mine.toml', 'initial']\nseeds = [3, 4]\n\
        [[pair]]\nsource = 'x/s.obj'\ntarget = 'x/t.ply'\n[[pair]]\nname = 'v1.5'\nsource = 's.obj'\ntarget = 't.obj'\n";

    #[test]
    fn every_pair_meets_every_preset_and_seed_but_the_initial_one_once() {
        let folder = tempfile::tempdir().unwrap();
        let manifest = Manifest::parse(TEXT, Path::new("/data")).unwrap();
        let tasks = manifest.tasks(folder.path()).unwrap();
        assert_eq!(tasks.len(), 2 * (2 + 2 + 1));
        assert_eq!(tasks[0].pair.name, "x");
        assert_eq!(tasks[0].pair.target, Path::new("/data/x/t.ply"));
        assert_eq!(tasks[2].method, Method::Config("/data/a/mine.toml".into()));
        assert_eq!(tasks[9].output, folder.path().join("v1.5/initial-3.obj"));
    }

    #[test]
    fn mistakes_are_named() {
        let error = |text: &str| format!("{:#}", Manifest::parse(text, Path::new("")).unwrap_err());
        assert!(error("presets = ['best']\n[[pair]]\nsource='a'\ntarget='b'").contains("best"));
        assert!(error("seed = [1]\n").contains("unknown field `seed`"));
        assert!(error("[[pair]]\nsource='a'\n").contains("missing field `target`"));
        let twice = "[[pair]]\nname='n'\nsource='a'\ntarget='b'\n".repeat(2);
        assert!(error(&twice).contains("same name"));
    }
}
