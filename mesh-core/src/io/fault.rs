//! What is wrong, as readers and writers of one format tell it: they do not know the file's name.

use std::path::Path;

use super::error::{Place, ReadError, ReadProblem, WriteError};
use super::printable::printable;
use crate::{Aabb, Point3, TopologyError};

/// Why a soup cannot be written in a format.
#[derive(Debug)]
pub(super) enum Unwritable {
    /// A vertex whose position the format cannot hold.
    Vertex(usize),
    Faces(TopologyError),
}

impl From<TopologyError> for Unwritable {
    fn from(error: TopologyError) -> Self {
        Self::Faces(error)
    }
}

impl Unwritable {
    /// The error with the name of the file that was to be written.
    pub(super) fn at(self, path: &Path) -> WriteError {
        let path = path.to_owned();
        match self {
            Self::Vertex(vertex) => WriteError::NotFinite { path, vertex },
            Self::Faces(source) => WriteError::Faces { path, source },
        }
    }
}

/// Where in a file, and what is wrong there.
#[derive(Debug)]
pub(super) struct Fault {
    pub(super) place: Place,
    pub(super) problem: ReadProblem,
}

impl Fault {
    /// A fault of the file as a whole.
    pub(super) fn whole(problem: ReadProblem) -> Self {
        Self {
            place: Place::File,
            problem,
        }
    }

    /// Something correct that is not read here.
    pub(super) fn unsupported(feature: String, advice: &'static str) -> Self {
        Self::whole(ReadProblem::Unsupported { feature, advice })
    }

    /// A fault at byte `at` of the text `bytes`.
    pub(super) fn in_text(bytes: &[u8], at: usize, problem: ReadProblem) -> Self {
        Self {
            place: Place::in_text(bytes, at),
            problem,
        }
    }

    /// The fault with the name of the file it is in.
    pub(super) fn of(self, path: &Path) -> ReadError {
        ReadError {
            path: path.to_owned(),
            place: self.place,
            problem: self.problem,
        }
    }
}

/// The largest coordinate that is read: areas squared, fourth powers of lengths, must stay finite numbers.
const LARGEST: f64 = 1e75;
/// The smallest size of a mesh, for the same reason.
const SMALLEST: f64 = 1e-75;

/// Refuses vertices that are different and yet too near each other to measure with.
pub(super) fn check_size(positions: &[Point3]) -> Result<(), Fault> {
    let size = Aabb::of(positions).longest_side();
    if size > 0.0 && size < SMALLEST {
        return Err(Fault::whole(ReadProblem::TooSmall { size }));
    }
    Ok(())
}

/// `x` as a coordinate that can be measured with; what is wrong with it where it cannot. `text` is how the file has it.
pub(super) fn checked_coordinate(
    x: f64,
    text: impl FnOnce() -> String,
) -> Result<f64, ReadProblem> {
    if !x.is_finite() {
        return Err(ReadProblem::NotFinite { text: text() });
    }
    if x.abs() > LARGEST {
        let (text, most) = (text(), LARGEST);
        return Err(ReadProblem::TooLarge { text, most });
    }
    Ok(x)
}

/// What a user may see of bytes that should have been something else: short and printable.
pub(super) fn excerpt(text: &[u8]) -> String {
    const SHOWN: usize = 40;
    let shown = String::from_utf8_lossy(&text[..text.len().min(SHOWN)]);
    let mut shown = printable(&shown).into_owned();
    if text.len() > SHOWN {
        shown.push('…');
    }
    shown
}
