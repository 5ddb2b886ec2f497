//! A pair as files, like any user's.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Context as _;
use mesh_core::io::write_atomic;
use mesh_creatures::CreaturePair;

/// Where the files of a pair are.
#[derive(Clone, Debug)]
pub(crate) struct PairFiles {
    pub(crate) source: PathBuf,
    pub(crate) target: PathBuf,
    /// None without landmarks.
    pub(crate) landmarks: Option<PathBuf>,
    pub(crate) truth: PathBuf,
    /// The closed surface of the target, where the target is none.
    pub(crate) surface: Option<PathBuf>,
}

/// Writes a pair into `folder`, which is made if it is not there. A file that is there already with the same content is
/// left as it is, so that what came from it stays newer.
pub(crate) fn write(folder: &Path, pair: &CreaturePair) -> anyhow::Result<PairFiles> {
    fs::create_dir_all(folder)
        .with_context(|| format!("{}: the folder cannot be made", folder.display()))?;
    let put = |name: &str, text: String| -> anyhow::Result<PathBuf> {
        let path = folder.join(name);
        let is_there = fs::read(&path).is_ok_and(|bytes| bytes == text.as_bytes());
        if !is_there {
            write_atomic(&path, text.as_bytes())?;
        }
        Ok(path)
    };
    let is_whole = pair.target == pair.surface;
    let landmarks = (!pair.landmarks.is_empty()).then(|| pair.landmarks_json());
    Ok(PairFiles {
        source: put("source.obj", pair.source.to_obj())?,
        target: if is_whole {
            put("target.obj", pair.surface_obj())?
        } else {
            put("target.ply", pair.target_ply())?
        },
        landmarks: landmarks
            .map(|text| put("landmarks.json", text))
            .transpose()?,
        truth: put("truth.ply", pair.truth_ply())?,
        surface: (!is_whole)
            .then(|| put("surface.obj", pair.surface_obj()))
            .transpose()?,
    })
}
