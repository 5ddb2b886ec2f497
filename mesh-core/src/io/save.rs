//! Files written all or nothing.

use std::fs::{self, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use super::error::WriteError;
use super::format::Format;
use super::gzip;
use super::uvs::CornerUvs;
use crate::PolygonSoup;

const KNOWN: &str = ".obj, .ply, .off, .stl, .glb, .gltf or .xyz, each perhaps with .gz";

/// Writes a new file of `soup`, in the format that the extension of `path` names.
///
/// ```
/// use mesh_core::{io, shapes};
/// let path = std::env::temp_dir().join("mesh_core_doc_prism.obj");
/// io::write_soup(&path, &shapes::prism(5))?;
/// assert_eq!(io::read_soup(&path)?, shapes::prism(5));
/// # std::fs::remove_file(&path)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// An unknown extension, a coordinate that is not finite, a face that names a vertex that is not there where faces
/// become triangles, or a file that cannot be written.
pub fn write_soup(path: impl AsRef<Path>, soup: &PolygonSoup) -> Result<(), WriteError> {
    let path = path.as_ref();
    let format = Format::of_extension(path).ok_or_else(|| unknown_format(path))?;
    check_finite(path, &soup.positions)?;
    let bytes = encode(path, format, soup, None)?;
    write_atomic(path, &packed_as_named(path, bytes))
}

/// A new file of `soup`, to be called `path`, with texture coordinates where the format has them.
pub(super) fn encode(
    path: &Path,
    format: Format,
    soup: &PolygonSoup,
    uvs: Option<&CornerUvs>,
) -> Result<Vec<u8>, WriteError> {
    let encoded = (format.codec().write)(soup, uvs);
    encoded.map_err(|unwritable| unwritable.at(path))
}

fn unknown_format(path: &Path) -> WriteError {
    WriteError::UnknownFormat {
        path: path.to_owned(),
        known: KNOWN,
    }
}

/// `bytes`, packed if `path` ends in `.gz`.
pub(super) fn packed_as_named(path: &Path, bytes: Vec<u8>) -> Vec<u8> {
    match gzip::inner_path(path) {
        Some(_) => gzip::pack(&bytes),
        None => bytes,
    }
}

pub(super) fn check_finite(path: &Path, positions: &[crate::Point3]) -> Result<(), WriteError> {
    let is_finite = |p: &crate::Point3| p.coords.iter().all(|c| c.is_finite());
    match positions.iter().position(|p| !is_finite(p)) {
        None => Ok(()),
        Some(vertex) => Err(WriteError::NotFinite {
            path: path.to_owned(),
            vertex,
        }),
    }
}

/// Writes `bytes` as the file `path`, all or nothing: into a new file beside it, which then takes its name.
///
/// What is there already and is no plain file (a pipe, a terminal) is written to directly.
///
/// # Errors
/// A file that cannot be written; then nothing is left behind, and a file of that name is as it was.
pub fn write_atomic(path: impl AsRef<Path>, bytes: &[u8]) -> Result<(), WriteError> {
    let path = path.as_ref();
    let written = match fs::metadata(path) {
        Ok(there) if !there.is_file() && !there.is_dir() => fs::write(path, bytes),
        _ => replace(path, bytes),
    };
    written.map_err(|source| WriteError::Io {
        path: path.to_owned(),
        source,
    })
}

fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let beside = name_beside(path)?;
    let mut file = OpenOptions::new()
        .write(true)
        .create_new(true)
        .open(&beside)?;
    let written = file
        .write_all(bytes)
        .and_then(|()| file.sync_all())
        .and_then(|()| fs::rename(&beside, path));
    if written.is_err() {
        // The first error is the one to report.
        let _ = fs::remove_file(&beside);
    }
    written
}

/// A name in the folder of `path` that no other writer has.
fn name_beside(path: &Path) -> io::Result<PathBuf> {
    static N_WRITES: AtomicU32 = AtomicU32::new(0);
    let name = path
        .file_name()
        .ok_or_else(|| io::Error::new(io::ErrorKind::InvalidInput, "not the name of a file"))?;
    let count = N_WRITES.fetch_add(1, Ordering::Relaxed);
    let name = format!(
        ".{}.{}-{count}.part",
        name.to_string_lossy(),
        std::process::id()
    );
    Ok(path.with_file_name(name))
}
