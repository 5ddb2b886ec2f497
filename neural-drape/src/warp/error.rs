//! What can go wrong with a warp.

use std::path::PathBuf;

use mesh_core::io::WriteError;
use mesh_operators::SolveError;

/// Why a warp could not be made, saved or loaded.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WarpError {
    /// Two shapes of one mesh differ in how many vertices they have.
    #[error("the {what} shape has {found} vertices, the rest shape {expected}")]
    LengthMismatch {
        /// Which shape.
        what: &'static str,
        /// How many vertices it has.
        found: usize,
        /// How many the rest shape has.
        expected: usize,
    },
    /// The displacement cannot be extended into space.
    #[error("the displacement of the surface cannot be extended into space")]
    Extension(#[from] SolveError),
    /// The file cannot be read.
    #[error("cannot read the warp file '{}'", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        #[source]
        source: std::io::Error,
    },
    /// The file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The file is something else.
    #[error("'{}' is not a warp file: it does not begin with \"DRAPEWRP\"", path.display())]
    NotAWarp {
        /// The file.
        path: PathBuf,
    },
    /// The file is from another version.
    #[error("'{}' is a warp file of version {found}; this program reads version {supported}, save it anew", path.display())]
    Version {
        /// The file.
        path: PathBuf,
        /// Its version.
        found: u32,
        /// The version that can be read.
        supported: u32,
    },
    /// The file is cut off or changed.
    #[error("the warp file '{}' is damaged at byte {offset}: {reason}; save it anew", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Where, in bytes from its start.
        offset: usize,
        /// What is wrong.
        reason: &'static str,
    },
}
