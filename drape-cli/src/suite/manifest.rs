//! Manifests: which pairs, presets and seeds to evaluate.
//!
//! ```toml
//! presets = ["standard", "paper", "mine.toml", "initial"]   # names, TOML files, or the initial deformation alone
//! seeds = [0, 1, 2]
//! data = "../shared/data"          # where given, paths of pairs count from here, or from the folder in DRAPE_DATA, and
//!                                  # a pair whose files are not there is left out
//!
//! [[pair]]
//! name = "horse_wolf"              # the name of the target's folder where not given
//! source = "horse_wolf/source.obj" # paths count from the manifest's folder
//! target = "horse_wolf/target.obj"
//! landmarks = "horse_wolf/landmarks.json"
//! truth = "horse_wolf/truth.ply"   # where each vertex belongs, if known
//! judge = "horse_wolf/target.obj"  # target to judge against, where it is another one
//! section = "Whole shapes"         # where it stands on a page of results
//! partial = false                  # whether one shape has parts that the other lacks: Q says little then
//! ```

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{anyhow, ensure, Context as _};
use mesh_core::io::Format;
use mesh_draping::{plain_words, Preset};
use serde::Deserialize;

use super::{Method, Pair, Task, INITIAL};

/// The folder of data in the environment.
const DATA: &str = "DRAPE_DATA";
/// The section of pairs that name none.
const SECTION: &str = "Pairs";

/// A list of runs: every pair with every preset and every seed.
#[derive(Debug)]
pub(crate) struct Manifest {
    methods: Vec<Method>,
    seeds: Vec<u64>,
    pairs: Vec<Listed>,
    /// Names of the pairs that are left out for want of files.
    absent: Vec<String>,
    /// Whether pairs may be absent.
    has_data: bool,
}

/// A pair and what a manifest says about it.
#[derive(Debug)]
struct Listed {
    pair: Pair,
    section: String,
    is_partial: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default)]
    presets: Vec<String>,
    #[serde(default)]
    seeds: Vec<u64>,
    data: Option<PathBuf>,
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
    section: Option<String>,
    #[serde(default)]
    partial: bool,
}

impl Manifest {
    pub(crate) fn read(path: &Path) -> anyhow::Result<Self> {
        let text = fs::read_to_string(path)
            .with_context(|| format!("{}: cannot be read", path.display()))?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut manifest = Self::parse(&text, folder, std::env::var_os(DATA).map(PathBuf::from))
            .with_context(|| path.display().to_string())?;
        manifest.leave_out_absent();
        Ok(manifest)
    }

    /// Every pair once with every preset; files of settings are counted from the current folder; `section` is where they stand
    /// on a page of results.
    ///
    /// # Errors
    /// An unknown preset.
    pub(crate) fn of_pairs(
        presets: &[String],
        section: &str,
        pairs: Vec<Pair>,
    ) -> anyhow::Result<Self> {
        let methods = presets.iter().map(|p| method(p.clone(), Path::new("")));
        Ok(Self {
            methods: methods.collect::<anyhow::Result<_>>()?,
            seeds: vec![0],
            pairs: pairs
                .into_iter()
                .map(|pair| Listed {
                    pair,
                    section: section.to_owned(),
                    is_partial: false,
                })
                .collect(),
            absent: Vec::new(),
            has_data: false,
        })
    }

    /// The same pairs with these settings and seeds.
    pub(super) fn with_methods(self, methods: &[Method], seeds: &[u64]) -> Self {
        Self {
            methods: methods.to_vec(),
            seeds: seeds.to_vec(),
            ..self
        }
    }

    pub(super) fn parse(text: &str, folder: &Path, data: Option<PathBuf>) -> anyhow::Result<Self> {
        let file: File = toml::from_str(text).map_err(|error| {
            let before = error
                .span()
                .map_or("", |span| text.get(..span.start).unwrap_or(text));
            anyhow!(
                "line {}: {}",
                before.lines().count().max(1),
                plain_words(&error.message().replace('\n', ", "))
            )
        })?;
        let root = match &file.data {
            Some(beside) => data.unwrap_or_else(|| folder.join(beside)),
            None => folder.to_owned(),
        };
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
            pairs: file
                .pair
                .into_iter()
                .map(|p| p.into_listed(&root))
                .collect(),
            has_data: file.data.is_some(),
            absent: Vec::new(),
        };
        let names: BTreeSet<&str> = manifest.names().collect();
        ensure!(
            names.len() == manifest.pairs.len(),
            "two pairs have the same name; give each its own `name`"
        );
        Ok(manifest)
    }

    /// Pairs of data that is not on this machine are listed apart.
    fn leave_out_absent(&mut self) {
        if !self.has_data {
            return;
        }
        let is_there =
            |listed: &Listed| listed.pair.source.is_file() && listed.pair.target.is_file();
        let (there, absent) = std::mem::take(&mut self.pairs)
            .into_iter()
            .partition(is_there);
        self.pairs = there;
        let absent: Vec<Listed> = absent;
        self.absent = absent.into_iter().map(|listed| listed.pair.name).collect();
    }

    /// The pairs that are left out because their data is not there.
    pub(crate) fn absent(&self) -> &[String] {
        &self.absent
    }

    /// Whether one shape of a pair has parts that the other lacks.
    pub(crate) fn is_partial(&self, name: &str) -> bool {
        self.listed(name).is_some_and(|listed| listed.is_partial)
    }

    /// The section of a pair on a page of results.
    pub(crate) fn section(&self, name: &str) -> Option<&str> {
        self.listed(name).map(|listed| listed.section.as_str())
    }

    /// The names of the pairs that are there.
    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        self.pairs.iter().map(|listed| listed.pair.name.as_str())
    }

    fn listed(&self, name: &str) -> Option<&Listed> {
        self.pairs.iter().find(|listed| listed.pair.name == name)
    }

    /// The runs, pair by pair; their files go into a folder for each pair.
    pub(crate) fn tasks(&self, folder: &Path) -> anyhow::Result<Vec<Task>> {
        let mut tasks = Vec::new();
        for Listed { pair, .. } in &self.pairs {
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
                        frames: None,
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
    fn into_listed(self, folder: &Path) -> Listed {
        let at = |path: PathBuf| folder.join(path);
        let target = at(self.target);
        let folder_name = target
            .parent()
            .and_then(Path::file_name)
            .map(|n| n.to_string_lossy().into_owned());
        let pair = Pair {
            name: self
                .name
                .or(folder_name)
                .unwrap_or_else(|| super::stem(&target)),
            source: at(self.source),
            target,
            landmarks: self.landmarks.map(at),
            truth: self.truth.map(at),
            judge: self.judge.map(at),
        };
        Listed {
            pair,
            section: self.section.unwrap_or_else(|| SECTION.to_owned()),
            is_partial: self.partial,
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
        let manifest = Manifest::parse(TEXT, Path::new("/data"), None).unwrap();
        let tasks = manifest.tasks(folder.path()).unwrap();
        assert_eq!(tasks.len(), 2 * (2 + 2 + 1));
        assert_eq!(tasks[0].pair.name, "x");
        assert_eq!(tasks[0].pair.target, Path::new("/data/x/t.ply"));
        assert_eq!(tasks[2].method, Method::Config("/data/a/mine.toml".into()));
        assert_eq!(tasks[9].output, folder.path().join("v1.5/initial-3.obj"));
    }

    #[test]
    fn pairs_without_data_are_left_out_and_named() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["s.obj", "t.obj"] {
            fs::write(folder.path().join(name), "").unwrap();
        }
        let text = "data = 'nowhere'\n[[pair]]\nname = 'here'\nsource = 's.obj'\ntarget = 't.obj'\nsection = 'Scans'\n\
            partial = true\n[[pair]]\nname = 'gone'\nsource = 's.obj'\ntarget = 'u.obj'\n";
        let read = |data: Option<&Path>| {
            let mut manifest =
                Manifest::parse(text, Path::new("/x"), data.map(Path::to_owned)).unwrap();
            manifest.leave_out_absent();
            manifest
        };
        assert_eq!(read(None).absent(), ["here", "gone"]);
        let manifest = read(Some(folder.path()));
        assert_eq!(manifest.absent(), ["gone"]);
        assert!(manifest.is_partial("here") && manifest.section("here") == Some("Scans"));
    }

    #[test]
    fn mistakes_are_named() {
        let error = |text: &str| {
            format!(
                "{:#}",
                Manifest::parse(text, Path::new(""), None).unwrap_err()
            )
        };
        assert!(error("presets = ['best']\n[[pair]]\nsource='a'\ntarget='b'").contains("best"));
        assert!(error("seed = [1]\n").contains("unknown field `seed`"));
        assert!(error("[[pair]]\nsource='a'\n").contains("missing field `target`"));
        let twice = "[[pair]]\nname='n'\nsource='a'\ntarget='b'\n".repeat(2);
        assert!(error(&twice).contains("same name"));
    }
}
