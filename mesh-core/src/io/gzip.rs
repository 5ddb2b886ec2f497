//! Gzip around any format.

use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use flate2::read::MultiGzDecoder;
use flate2::write::GzEncoder;
use flate2::Compression;

use super::error::ReadProblem;
use super::fault::Fault;

/// Meshes pack to a tenth or so; what unpacks to more than this many times its size is no mesh.
const MAX_RATIO: usize = 100;
/// A small file may unpack to this many bytes whatever its ratio.
const ALWAYS_ALLOWED: usize = 1 << 20;

/// Whether this is a gzip file.
pub(super) fn is_packed(bytes: &[u8]) -> bool {
    bytes.starts_with(&[0x1F, 0x8B])
}

/// The bytes inside.
pub(super) fn unpack(packed: &[u8]) -> Result<Vec<u8>, Fault> {
    let limit = packed.len().saturating_mul(MAX_RATIO).max(ALWAYS_ALLOWED);
    let mut bytes = Vec::new();
    let mut decoder = MultiGzDecoder::new(packed).take(limit as u64 + 1);
    decoder
        .read_to_end(&mut bytes)
        .map_err(|e| Fault::whole(ReadProblem::Packed(e)))?;
    if bytes.len() > limit {
        return Err(Fault::whole(ReadProblem::Oversized {
            element: "unpacked bytes".to_owned(),
            count: bytes.len() as u64,
            bytes: packed.len(),
        }));
    }
    Ok(bytes)
}

/// `bytes` as a gzip file.
pub(super) fn pack(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::with_capacity(bytes.len() / 2), Compression::default());
    encoder
        .write_all(bytes)
        .and_then(|()| encoder.finish())
        .expect("a vector takes all bytes")
}

/// `path` without its `.gz`, if it has one.
pub(super) fn inner_path(path: &Path) -> Option<PathBuf> {
    let is_gz = path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("gz"));
    is_gz.then(|| path.with_extension(""))
}
