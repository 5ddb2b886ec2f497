//! What can be wrong with a landmark file.

use std::fmt;
use std::io;
use std::path::PathBuf;

use super::Label;
use crate::Shape;

/// A landmark file that cannot be read, or does not belong to a source and a target: where, and why.
#[derive(Debug)]
pub struct LandmarkError {
    /// The file; none for text in memory.
    pub path: Option<PathBuf>,
    /// Where in it.
    pub place: LandmarkPlace,
    /// What is wrong there.
    pub problem: LandmarkProblem,
}

/// Where in a landmark file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LandmarkPlace {
    /// The file as a whole.
    File,
    /// A line, counted from 1.
    Line(usize),
    /// A landmark or a curve.
    Entry(Label),
}

/// What is wrong with a landmark.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LandmarkProblem {
    /// The operating system refused.
    #[error("cannot be read: {0}")]
    Io(io::Error),
    /// Neither lines of numbers nor JSON.
    #[error("is not JSON: {0}")]
    NotJson(String),
    /// JSON of another kind.
    #[error("needs \"landmarks\", or \"source_vertices\" and \"target_points\"")]
    NoLists,
    /// A value that is not what it should be.
    #[error("{key} must be {expected}")]
    Value {
        /// What the value belongs to.
        key: &'static str,
        /// What it should be.
        expected: &'static str,
    },
    /// A key that means nothing here.
    #[error("unknown field `{key}`; there are {known}")]
    UnknownKey {
        /// The key.
        key: String,
        /// All keys.
        known: &'static str,
    },
    /// A place that is none of the forms, or several at once.
    #[error("{shape} needs {forms}")]
    Place {
        /// The shape that it should be on.
        shape: Shape,
        /// What a place can be.
        forms: &'static str,
    },
    /// Lists of different lengths.
    #[error("{n_vertices} source_vertices but {n_points} target_points")]
    ListLengths {
        /// Length of the one.
        n_vertices: usize,
        /// Length of the other.
        n_points: usize,
    },
    /// A line with some other count of numbers.
    #[error(
        "has {n} numbers; give 2 (source vertex, target vertex), 4 (source vertex, target x y z) or 6 (source x y z, \
         target x y z), and then perhaps a name"
    )]
    NumberCount {
        /// How many there are.
        n: usize,
    },
    /// A word where a vertex should be.
    #[error("'{word}' is no vertex: rows count from 0")]
    NotVertex {
        /// The word.
        word: String,
    },
    /// Not one landmark.
    #[error("holds no landmark")]
    Empty,
    /// A vertex that is not there.
    #[error("{shape} vertex {row} does not exist: the {shape} has {n} vertices, counted from 0")]
    NoVertex {
        /// Whose vertex.
        shape: Shape,
        /// Its row.
        row: usize,
        /// How many there are.
        n: usize,
    },
    /// A face that is not there.
    #[error("source face {face} does not exist: the source has {n} faces, counted from 0")]
    NoFace {
        /// Its row.
        face: usize,
        /// How many there are.
        n: usize,
    },
    /// Not one weight per corner.
    #[error(
        "source face {face}: has {n_corners} corners, but {n_weights} barycentric weights are given"
    )]
    WeightCount {
        /// The face.
        face: usize,
        /// How many corners it has.
        n_corners: usize,
        /// How many weights are given.
        n_weights: usize,
    },
    /// Weights of a place outside the face.
    #[error("source face {face}: barycentric weights must be at least 0 and sum to 1")]
    Weights {
        /// The face.
        face: usize,
    },
    /// A face without a place.
    #[error("source face {face}: this face has no area")]
    NoArea {
        /// The face.
        face: usize,
    },
    /// Files of points without names, that do not belong together one by one.
    #[error("{n_source} points on the source but {n_target} on the target")]
    PointCounts {
        /// How many there are of the one.
        n_source: usize,
        /// How many of the other.
        n_target: usize,
    },
    /// A triangle of the fans of a shape that is not there.
    #[error("the {shape} has no triangle {triangle}: its polygons are {n} triangles in fans, counted from 0")]
    NoFanTriangle {
        /// Whose triangle.
        shape: Shape,
        /// Its number.
        triangle: usize,
        /// How many there are.
        n: usize,
    },
    /// A weight that is NaN, or out of range.
    #[error("weight must be a number from 0 to {most}")]
    Weight {
        /// The largest weight.
        most: f64,
    },
    /// A curve of too few places.
    #[error("has {n} places on the {shape}: a curve needs {least}, and one that is closed, which ends where it began, 4")]
    FewPlaces {
        /// On which shape.
        shape: Shape,
        /// How many there are.
        n: usize,
        /// How many it takes.
        least: usize,
    },
    /// A curve of one place.
    #[error("has no length on the {shape}")]
    NoLength {
        /// On which shape.
        shape: Shape,
    },
    /// A curve that is closed on one of the shapes only.
    #[error("is closed on the {closed} but has two ends on the {open}")]
    ClosedOnOne {
        /// Where it ends where it began.
        closed: Shape,
        /// Where it does not.
        open: Shape,
    },
    /// Two places of a curve that no triangles of the source join.
    #[error("no way along the source joins its places {first} and {}, counted from 0", first + 1)]
    NoWay {
        /// The first of them.
        first: usize,
    },
    /// A coordinate that is NaN, infinite, or too large to be squared.
    #[error("{shape} point is not finite, or farther from the origin than 1e150")]
    NotFinite {
        /// Which point.
        shape: Shape,
    },
}

impl fmt::Display for LandmarkError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(path) = &self.path {
            write!(f, "{}: ", path.display())?;
        }
        match &self.place {
            LandmarkPlace::File => {}
            LandmarkPlace::Line(line) => write!(f, "line {line}: ")?,
            LandmarkPlace::Entry(label) => write!(f, "{label}: ")?,
        }
        write!(f, "{}", self.problem)
    }
}

impl std::error::Error for LandmarkError {}

impl LandmarkProblem {
    /// At a place of a file whose path is not known yet.
    pub(super) fn at(self, place: LandmarkPlace) -> LandmarkError {
        LandmarkError {
            path: None,
            place,
            problem: self,
        }
    }
}
