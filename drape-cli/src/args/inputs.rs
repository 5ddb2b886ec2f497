//! What is draped over what, and how the source's file is read.

use std::path::{Path, PathBuf};

use anyhow::Context as _;
use mesh_core::io::{Format, MeshFile, Morphs};
use mesh_core::Positions;
use mesh_draping::{landmarks, Pair, Population, Seams, Source, Target};

use super::PipeArgs;
use crate::output::{left_beside, warn};

/// Which vertices of the source are one.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(crate) struct WeldArgs {
    /// Vertices of the source no farther apart than this, in its coordinates, move as one: 0 for equal places only,
    /// as glTF splits them along seams; off for none
    #[arg(long, value_name = "EPS", default_value = "0")]
    pub(crate) weld: Seams,
}

/// How morph targets follow.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(crate) struct MorphArgs {
    /// Morph targets of a glTF file: carry takes each to the new shape, keep leaves them, drop removes them
    #[arg(long, value_name = "HOW", default_value = "keep")]
    pub(crate) morphs: Morphing,
}

/// [`Morphs`] by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Morphing {
    /// Through the map's Jacobian
    Carry,
    /// As they are
    Keep,
    /// Without them
    Drop,
}

impl From<Morphing> for Morphs {
    fn from(morphing: Morphing) -> Self {
        match morphing {
            Morphing::Carry => Self::Carry,
            Morphing::Keep => Self::Keep,
            Morphing::Drop => Self::Drop,
        }
    }
}

impl std::fmt::Display for Morphing {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Carry => "carry",
            Self::Keep => "keep",
            Self::Drop => "drop",
        })
    }
}

impl MorphArgs {
    /// Refuses an output that a file cannot be written to; what is not as in the source there, in words.
    pub(crate) fn check_output(
        &self,
        file: &MeshFile,
        output: &Path,
    ) -> anyhow::Result<Vec<String>> {
        file.check_writable(output)?;
        let notes = [
            self.left_behind(file, output),
            file.lost_in(output),
            left_beside(file, output),
        ];
        Ok(notes.into_iter().flatten().collect())
    }

    /// That morph targets stay as they were, where they do, in words.
    fn left_behind(&self, file: &MeshFile, output: &Path) -> Option<String> {
        let n = file.contents().n_morph_targets;
        let is_kept = n > 0 && self.morphs == Morphing::Keep && file.keeps_format(output);
        is_kept.then(|| {
            let targets = if n == 1 {
                "1 morph target is"
            } else {
                &format!("{n} morph targets are")
            };
            format!(
                "{targets} kept as made for the source; --morphs carry takes them to the new shape"
            )
        })
    }
}

/// The files of a pair.
pub(crate) struct Inputs<'a> {
    pub(crate) source: &'a Path,
    pub(crate) target: &'a Path,
    pub(crate) landmarks: Option<&'a Path>,
    pub(crate) seams: Seams,
    /// Where the command writes, if it does.
    pub(crate) output: Option<&'a Path>,
    pub(crate) pipe: PipeArgs,
}

impl Inputs<'_> {
    pub(crate) fn read(&self) -> anyhow::Result<Pair> {
        let read = |path| self.pipe.read(path, self.output);
        let source = Source::of_file(read(self.source)?, self.seams)?;
        let target = Target::of_file(read(self.target)?)?;
        let landmarks = match self.landmarks {
            Some(path) => landmarks::read(path, &source, &target)?,
            None => Vec::new(),
        };
        Ok(Pair {
            source,
            target,
            landmarks,
        })
    }
}

/// The population of all results in a folder, in the order of their names.
pub(crate) fn read_population(folder: &Path, source: &Source) -> anyhow::Result<Population> {
    let entries = std::fs::read_dir(folder).with_context(|| format!("{}", folder.display()))?;
    let paths = entries.map(|entry| Ok(entry?.path()));
    let mut paths = paths.collect::<std::io::Result<Vec<PathBuf>>>()?;
    paths.retain(|path| path.is_file() && Format::of_extension(path).is_some());
    paths.sort();
    let shapes = paths.iter().map(|path| read_truth(path, source));
    Population::of(&shapes.collect::<anyhow::Result<Vec<_>>>()?)
        .with_context(|| format!("{}: holds no mesh", folder.display()))
}

/// Share of the longest side from which vertices that should be one are apart: text may be rounded.
const TORN: f64 = 1e-5;

/// The positions of a file that must have the vertices of the source. Warns where vertices that are one lie apart.
pub(crate) fn read_truth(path: &Path, source: &Source) -> anyhow::Result<Positions> {
    let gathered = source.read_positions(path)?;
    if gathered.widest_gap > TORN {
        warn(&[format!(
            "{}: vertices that are one in the source lie up to {:.2} % of its longest side apart; the first of them counts",
            path.display(),
            100.0 * gathered.widest_gap
        )]);
    }
    Ok(gathered.positions)
}
