//! What can go wrong, and where.

use std::path::{Path, PathBuf};

use mesh_core::io::{ReadError, WriteError};
use mesh_core::TopologyError;
use mesh_init::InitError;
use mesh_metrics::EvaluateError;
use neural_drape::{DrapeError, WarpError};

use crate::landmarks::LandmarkError;
use crate::parts::PartError;
use crate::preset::PresetError;

/// Why a mesh cannot be draped. Every message names the file and the element, and is whole by itself.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// What was read is no mesh to work with.
    #[error("{}: {problem}", path.display())]
    MeshFile {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: MeshProblem,
    },
    /// What was given is no mesh to work with.
    #[error(transparent)]
    Mesh(#[from] MeshProblem),
    /// Positions that belong to another mesh.
    #[error("{}: has {found} vertices, but the source has {expected}", path.display())]
    PositionCount {
        /// The file that they were read from.
        path: PathBuf,
        /// How many there are.
        found: usize,
        /// How many the source has.
        expected: usize,
    },
    /// A landmark file cannot be read, or does not belong to these shapes.
    #[error(transparent)]
    Landmarks(#[from] LandmarkError),
    /// A part of the source cannot be found, or nothing would be left to drape.
    #[error(transparent)]
    Parts(#[from] PartError),
    /// Settings cannot be read.
    #[error(transparent)]
    Preset(#[from] PresetError),
    /// There is no initial deformation.
    #[error(transparent)]
    Init(#[from] InitError),
    /// The drape cannot start or go on.
    #[error(transparent)]
    Drape(#[from] DrapeError),
    /// The result cannot be judged.
    #[error(transparent)]
    Evaluate(#[from] EvaluateError),
    /// The map of a result cannot be made.
    #[error(transparent)]
    Warp(#[from] WarpError),
}

/// A mesh or cloud that cannot be a source or a target.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshProblem {
    /// Its elements do not fit together.
    #[error(transparent)]
    Topology(#[from] TopologyError),
    /// A source without a surface.
    #[error("no face has three different corners")]
    NoTriangle,
}

/// Names the file in what is wrong with a mesh.
pub(crate) fn in_file(path: &Path) -> impl Fn(Error) -> Error + '_ {
    move |error| match error {
        Error::Mesh(problem) => Error::MeshFile {
            path: path.to_owned(),
            problem,
        },
        error => error,
    }
}
