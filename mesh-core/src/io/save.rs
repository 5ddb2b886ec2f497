//! Files written all or nothing.

use std::fs::{self, File, OpenOptions, Permissions};
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
/// A file that is replaced hands its permissions on, and one that a link leads to is replaced where it lies. What is there
/// already and is no plain file (a pipe, a terminal) is written to directly.
///
/// # Errors
/// A file that cannot be written; then nothing is left behind, and a file of that name is as it was.
pub fn write_atomic(path: impl AsRef<Path>, bytes: &[u8]) -> Result<(), WriteError> {
    let path = path.as_ref();
    let written = match fs::metadata(path) {
        Ok(there) if there.is_file() => replace(path, bytes, Some(there.permissions())),
        Ok(there) if !there.is_dir() => fs::write(path, bytes),
        _ => replace(path, bytes, None),
    };
    written.map_err(|source| refused(path, source))
}

/// Whether [`write_atomic`] could write `path` now: to know before a long run. Nothing is changed.
///
/// # Errors
/// A folder that is not there or takes no new file, a name that is too long, or a file that may not be changed.
pub fn check_writable(path: impl AsRef<Path>) -> Result<(), WriteError> {
    let path = path.as_ref();
    let checked = match fs::metadata(path) {
        Ok(there) if there.is_file() => OpenOptions::new()
            .write(true)
            .open(path)
            .and_then(|_| try_beside(&followed(path))),
        Ok(there) if there.is_dir() => Err(io::ErrorKind::IsADirectory.into()),
        Ok(_) => Ok(()),
        Err(error) if error.kind() == io::ErrorKind::NotFound => try_beside(path),
        Err(error) => Err(error),
    };
    checked.map_err(|source| refused(path, source))
}

fn refused(path: &Path, source: io::Error) -> WriteError {
    WriteError::Io {
        path: path.to_owned(),
        source,
    }
}

/// Replaces or makes the file `path`, with these permissions where it had some.
fn replace(path: &Path, bytes: &[u8], permissions: Option<Permissions>) -> io::Result<()> {
    let path = followed(path);
    let (beside, mut file) = create_beside(&path)?;
    let written = file
        .write_all(bytes)
        .and_then(|()| permissions.map_or(Ok(()), |p| file.set_permissions(p)))
        .and_then(|()| file.sync_all())
        .and_then(|()| fs::rename(&beside, &path));
    if written.is_err() {
        // The first error is the one to report.
        let _ = fs::remove_file(&beside);
    }
    written
}

/// Where `path` leads to, if it is a link to something.
fn followed(path: &Path) -> PathBuf {
    let is_link = fs::symlink_metadata(path).is_ok_and(|there| there.is_symlink());
    let real = is_link.then(|| fs::canonicalize(path).ok()).flatten();
    real.unwrap_or_else(|| path.to_owned())
}

/// Makes a file beside `path` and removes it again.
fn try_beside(path: &Path) -> io::Result<()> {
    let (beside, _) = create_beside(path)?;
    fs::remove_file(beside)
}

/// A new file in the folder of `path`, under a name that no other writer has and that is no longer than names may be.
fn create_beside(path: &Path) -> io::Result<(PathBuf, File)> {
    static N_WRITES: AtomicU32 = AtomicU32::new(0);
    if path.file_name().is_none() {
        let kind = io::ErrorKind::InvalidInput;
        return Err(io::Error::new(kind, "not the name of a file"));
    }
    let count = N_WRITES.fetch_add(1, Ordering::Relaxed);
    let beside = path.with_file_name(format!(".drape-{}-{count}.part", std::process::id()));
    let file = OpenOptions::new()
        .write(true)
        .create_new(true)
        .open(&beside)?;
    Ok((beside, file))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_name_there_can_be_is_written_and_a_longer_one_refused() {
        let folder = tempfile::tempdir().unwrap();
        let longest = folder.path().join("n".repeat(255));
        check_writable(&longest).unwrap();
        write_atomic(&longest, b"x").unwrap();
        let longer = folder.path().join("n".repeat(256));
        assert!(check_writable(&longer).is_err() && write_atomic(&longer, b"x").is_err());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_folder_or_what_lies_in_none_cannot_be_written() {
        let folder = tempfile::tempdir().unwrap();
        assert!(check_writable(folder.path()).is_err());
        assert!(check_writable(folder.path().join("no/a.obj")).is_err());
        assert!(check_writable(Path::new("..")).is_err());
    }

    #[cfg(unix)]
    #[test]
    fn a_file_that_is_replaced_hands_its_permissions_on() {
        use std::os::unix::fs::{symlink, PermissionsExt as _};
        let folder = tempfile::tempdir().unwrap();
        let [file, link] = ["a.obj", "b.obj"].map(|name| folder.path().join(name));
        fs::write(&file, b"old").unwrap();
        fs::set_permissions(&file, Permissions::from_mode(0o640)).unwrap();
        symlink("a.obj", &link).unwrap();
        check_writable(&link).unwrap();
        assert_eq!(fs::read(&file).unwrap(), b"old");
        write_atomic(&link, b"new").unwrap();
        assert_eq!(fs::read(&file).unwrap(), b"new");
        let mode = fs::metadata(&file).unwrap().permissions().mode();
        assert_eq!(mode & 0o777, 0o640);
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    }
}
