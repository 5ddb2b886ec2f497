//! What can go wrong between a file and a mesh, and where.

use std::error::Error;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

use super::printable::printable;
use crate::TopologyError;

/// A file that could not be read: which, where in it, and why.
#[derive(Debug)]
pub struct ReadError {
    /// The file.
    pub path: PathBuf,
    /// Where in the file.
    pub place: Place,
    /// What is wrong there.
    pub problem: ReadProblem,
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}: {}", named(&self.path), self.place, self.problem)
    }
}

impl Error for ReadError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        self.problem.source()
    }
}

/// A place in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// The file as a whole.
    File,
    /// A line of text, counted from 1.
    Line(usize),
    /// An element of a binary file.
    Row {
        /// What the file calls the element.
        element: String,
        /// Its row, counted from 0.
        row: usize,
    },
}

impl Place {
    /// The line of the text `bytes` that byte `at` is on.
    pub(super) fn in_text(bytes: &[u8], at: usize) -> Self {
        let line_feeds = bytes[..at.min(bytes.len())].iter().filter(|&&b| b == b'\n');
        let lone_returns = bytes[..bytes.len().min(at + 1)]
            .windows(2)
            .filter(|pair| pair[0] == b'\r' && pair[1] != b'\n');
        Self::Line(1 + line_feeds.count() + lone_returns.count())
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File => Ok(()),
            Self::Line(line) => write!(f, ":{line}"),
            Self::Row { element, row } => {
                write!(f, ": {} {row} (counted from 0)", printable(element))
            }
        }
    }
}

/// What is wrong at a place of a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadProblem {
    /// The operating system refused.
    #[error("cannot be read")]
    Io(#[source] io::Error),
    /// A terminal, a disk, an endless source of zeros.
    #[error("a device cannot be read; give a file or a pipe")]
    Device,
    /// A pipe that gives more than is read of one.
    #[error("more than {} GiB from what is not a file; save it as a file first", most >> 30)]
    Endless {
        /// How many bytes are read at most.
        most: u64,
    },
    /// Not a whole gzip file.
    #[error("cannot be unpacked; is the file complete")]
    Packed(#[source] io::Error),
    /// Not the JSON document of a glTF file.
    #[error("not a glTF document: {0}")]
    Json(String),
    /// There is not one byte.
    #[error("the file is empty")]
    Empty,
    /// Neither content nor extension tells the format.
    #[error("not a mesh format known here; give an OBJ, PLY, STL, OFF, glTF, GLB or XYZ file with its usual extension")]
    UnknownFormat,
    /// Binary data where text was expected.
    #[error(
        "binary data in what should be text; is this really {} file",
        with_article(format)
    )]
    Binary {
        /// The format that content or extension promised.
        format: &'static str,
    },
    /// There is no vertex.
    #[error("no vertex in it; is this really {} file", with_article(format))]
    NoVertices {
        /// The format that content or extension promised.
        format: &'static str,
    },
    /// Something else where a number was expected.
    #[error("expected a number, found `{text}`")]
    NotANumber {
        /// What the file says.
        text: String,
    },
    /// Something else where a whole number in some range was expected.
    #[error("expected {expected}, found `{text}`")]
    Unexpected {
        /// What would be right.
        expected: &'static str,
        /// What the file says.
        text: String,
    },
    /// A coordinate that is NaN or infinite.
    #[error(
        "the coordinate `{text}` is {}; repair or remove this vertex",
        not_finite(text)
    )]
    NotFinite {
        /// What the file says.
        text: String,
    },
    /// A coordinate whose powers no number can hold, so that no area could be measured.
    #[error("the coordinate `{text}` is too large to measure with (more than {most:e}); scale the mesh down")]
    TooLarge {
        /// What the file says.
        text: String,
        /// The largest coordinate that is read.
        most: f64,
    },
    /// Vertices so near each other that no number can hold their areas.
    #[error("all vertices lie within {size:e} of each other, too small to measure with; scale the mesh up")]
    TooSmall {
        /// The longest side of their box.
        size: f64,
    },
    /// Text in an encoding that it does not keep to.
    #[error("the text is not whole in its encoding (UTF-16); save it as UTF-8")]
    Encoding,
    /// The line or file ends too early.
    #[error("ends where {expected} was expected")]
    EndsEarly {
        /// What would be right.
        expected: &'static str,
    },
    /// A face names a vertex that is not there.
    #[error(
        "a face names vertex {index}, but there are {n_vertices} vertices (counted from {first})"
    )]
    IndexOutOfRange {
        /// The vertex it names, as the file counts.
        index: i64,
        /// How many vertices there are.
        n_vertices: usize,
        /// What the file calls the first vertex.
        first: i64,
    },
    /// A header that promises more than the file can hold.
    #[error(
        "{count} {} are promised, more than the {bytes} bytes left in the file can hold",
        printable(element)
    )]
    Oversized {
        /// What is promised.
        element: String,
        /// How many of it.
        count: u64,
        /// How many bytes there are for them.
        bytes: usize,
    },
    /// More elements than a 32-bit index can name.
    #[error("more vertices or faces than a 32-bit index can name; split the file")]
    TooMany,
    /// A correct file with something in it that is not read here.
    #[error("{} cannot be read; {advice}", printable(feature))]
    Unsupported {
        /// What the file uses.
        feature: String,
        /// What to do about it.
        advice: &'static str,
    },
}

/// A path as it may be shown.
fn named(path: &Path) -> String {
    printable(&path.to_string_lossy()).into_owned()
}

/// `an OBJ`, `a PLY`: as the name is spoken.
fn with_article(format: &str) -> String {
    let is_spoken_with_vowel = matches!(format, "OBJ" | "OFF" | "STL" | "XYZ");
    let article = if is_spoken_with_vowel { "an" } else { "a" };
    format!("{article} {format}")
}

/// What a number is that is not finite.
fn not_finite(text: &str) -> &'static str {
    let text = text.to_ascii_lowercase();
    if text.contains("nan") {
        "not a number"
    } else if text.contains("inf") {
        "infinite"
    } else {
        "too large for a number"
    }
}

/// A file that could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The operating system refused.
    #[error("{}: cannot be written", named(path))]
    Io {
        /// The file.
        path: PathBuf,
        /// What the operating system says.
        #[source]
        source: io::Error,
    },
    /// The extension names no format that this can be written in.
    #[error(
        "{}: cannot be written in the format of this extension; use one of {known}",
        named(path)
    )]
    UnknownFormat {
        /// The file.
        path: PathBuf,
        /// The extensions that can.
        known: &'static str,
    },
    /// The source holds something that cannot take new positions.
    #[error("{}: {feature} cannot take new positions; {advice}", named(path))]
    Unsupported {
        /// The source file.
        path: PathBuf,
        /// What it holds.
        feature: &'static str,
        /// What to do about it.
        advice: &'static str,
    },
    /// Not one position per vertex of the file.
    #[error(
        "{}: {found} positions for the {expected} vertices of the source",
        named(path)
    )]
    WrongCount {
        /// The file.
        path: PathBuf,
        /// How many vertices the source has.
        expected: usize,
        /// How many positions were given.
        found: usize,
    },
    /// A position that the file cannot hold.
    #[error(
        "{}: the position of vertex {vertex} (counted from 0) is not a number this file can hold",
        named(path)
    )]
    NotFinite {
        /// The file.
        path: PathBuf,
        /// Row of the vertex.
        vertex: usize,
    },
    /// A face that names a vertex that is not there.
    #[error("{}: cannot be written", named(path))]
    Faces {
        /// The file.
        path: PathBuf,
        /// Which face.
        #[source]
        source: TopologyError,
    },
    /// The source no longer reads as it did.
    #[error(transparent)]
    Source(#[from] ReadError),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_counted_for_every_line_end() {
        let text = b"a\nb\r\nc\rd";
        let places = [0, 2, 5, 7].map(|at| Place::in_text(text, at));
        assert_eq!(places, [1, 2, 3, 4].map(Place::Line));
    }
}
