//! The bytes of a file, or of a pipe up to a limit.

use std::fs::{self, File, FileType};
use std::io::Read;
use std::path::Path;

use super::error::ReadProblem;
use super::fault::Fault;

/// What is read of a pipe at most, in bytes: a file's size is known before, that of a pipe is not.
const MOST_OF_A_PIPE: u64 = 4 << 30;

/// All bytes that `from` gives, up to the limit of a pipe.
pub(super) fn read_stream(from: impl Read) -> Result<Vec<u8>, Fault> {
    at_most(from, MOST_OF_A_PIPE)
}

/// All bytes of the file or pipe called `path`.
pub(super) fn read(path: &Path) -> Result<Vec<u8>, Fault> {
    let failed = |e| Fault::whole(ReadProblem::Io(e));
    let kind = fs::metadata(path).map_err(failed)?.file_type();
    if kind.is_file() || kind.is_dir() {
        return fs::read(path).map_err(failed);
    }
    if is_device(kind) {
        return Err(Fault::whole(ReadProblem::Device));
    }
    read_stream(File::open(path).map_err(failed)?)
}

fn at_most(from: impl Read, most: u64) -> Result<Vec<u8>, Fault> {
    let mut bytes = Vec::new();
    let n_read = from.take(most + 1).read_to_end(&mut bytes);
    let n_read = n_read.map_err(|e| Fault::whole(ReadProblem::Io(e)))?;
    if n_read as u64 > most {
        return Err(Fault::whole(ReadProblem::Endless { most }));
    }
    Ok(bytes)
}

#[cfg(unix)]
fn is_device(kind: FileType) -> bool {
    use std::os::unix::fs::FileTypeExt;
    kind.is_char_device() || kind.is_block_device()
}

#[cfg(not(unix))]
fn is_device(_: FileType) -> bool {
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_than_the_limit_is_refused_and_the_limit_itself_is_read() {
        assert_eq!(at_most(&[7; 5][..], 5).unwrap(), [7; 5]);
        let fault = at_most(std::io::repeat(0), 1 << 20).unwrap_err();
        assert!(matches!(fault.problem, ReadProblem::Endless { .. }));
    }

    #[cfg(unix)]
    #[test]
    fn a_device_is_refused_at_once() {
        let fault = read(Path::new("/dev/zero")).unwrap_err();
        assert!(matches!(fault.problem, ReadProblem::Device));
    }
}
