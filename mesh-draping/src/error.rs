//! What can go wrong, and where.

use std::path::{Path, PathBuf};

use mesh_core::io::{ReadError, WriteError};
use mesh_core::{Point3, PolygonSoup, TopologyError};
use mesh_init::InitError;
use mesh_metrics::EvaluateError;
use neural_drape::{DrapeError, WarpError};

use crate::landmarks::{LandmarkError, MirrorError};
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
    /// A source that shall come out symmetric is not.
    #[error(transparent)]
    NotSymmetric(#[from] MirrorError),
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
    /// A shape that is a single point.
    #[error("all its points are at one place; a shape has an extent")]
    NoExtent,
    /// A face that is there too often to be worked with.
    #[error(
        "face {face} (counted from 0) is there {n_copies} times, all at the same corners; remove the copies"
    )]
    Copies {
        /// Row of the first of them.
        face: usize,
        /// How many there are.
        n_copies: usize,
    },
    /// A source without a surface.
    #[error("no face has three different corners")]
    NoTriangle,
}

/// Refuses points that are all one.
pub(crate) fn check_extent<'p>(points: impl IntoIterator<Item = &'p Point3>) -> Result<(), Error> {
    let mut points = points.into_iter();
    let is_one = points
        .next()
        .is_some_and(|first| points.all(|p| p == first));
    match is_one {
        true => Err(MeshProblem::NoExtent.into()),
        false => Ok(()),
    }
}

/// A source may have a face this many times: what is measured between its faces grows with the square.
const MOST_COPIES: usize = 100;

/// Refuses faces of which one is there more often than [`MOST_COPIES`]; they name vertices that are there.
pub(crate) fn check_copies(soup: &PolygonSoup) -> Result<(), Error> {
    let faces = &soup.faces;
    let mut n_faces_at = vec![0usize; soup.positions.len()];
    for &v in faces.iter().flatten() {
        n_faces_at[v as usize] += 1;
    }
    // Only where very many faces meet at every corner can one be there very many times.
    let is_crowded = |face: &Vec<u32>| face.iter().all(|&v| n_faces_at[v as usize] > MOST_COPIES);
    let crowded = faces
        .iter()
        .enumerate()
        .filter(|(_, face)| is_crowded(face));
    let mut corners: Vec<(Vec<u32>, usize)> = crowded
        .map(|(row, face)| {
            let mut corners = face.clone();
            corners.sort_unstable();
            (corners, row)
        })
        .collect();
    corners.sort_unstable();
    let copies = corners
        .chunk_by(|a, b| a.0 == b.0)
        .filter(|same| same.len() > MOST_COPIES);
    let first = copies.min_by_key(|same| same[0].1);
    match first {
        Some(same) => Err(MeshProblem::Copies {
            face: same[0].1,
            n_copies: same.len(),
        }
        .into()),
        None => Ok(()),
    }
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
