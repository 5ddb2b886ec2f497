//! What can be wrong with parts of a source.

use std::fmt;
use std::io;

/// Parts that cannot be treated as asked for.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PartError {
    /// A part is not found.
    #[error("{list} {name}: {problem}")]
    Part {
        /// The list of [`Parts`](super::Parts) that names it.
        list: PartList,
        /// Its name there.
        name: String,
        /// What is wrong.
        problem: PartProblem,
    },
    /// Nothing is left to drape.
    #[error("the free parts are the whole source: nothing is left to drape")]
    AllFree,
}

/// A list of [`Parts`](super::Parts).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PartList {
    /// Parts that attract nothing.
    Free,
    /// Parts whose pieces are bodies.
    Rigid,
    /// Inner parts that are draped like the rest.
    Draped,
    /// How strongly vertices are attracted.
    Weights,
}

impl fmt::Display for PartList {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Free => "free part",
            Self::Rigid => "rigid part",
            Self::Draped => "draped part",
            Self::Weights => "weights",
        })
    }
}

/// Why a part is not found.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PartProblem {
    /// No name and no file.
    #[error("is neither a name in the source nor a file; there are {known}")]
    Unknown {
        /// The names in the source, in words.
        known: String,
    },
    /// Inner surfaces count from 1 to their number.
    #[error("there is no inner surface '{number}': the source has {n}, counted from 1")]
    NoInnerSurface {
        /// What was asked for.
        number: String,
        /// How many there are.
        n: usize,
    },
    /// The file of the source has no such scalar.
    #[error("the source has no scalar vertex property '{name}' (PLY files have)")]
    NoProperty {
        /// What was asked for.
        name: String,
    },
    /// A list of vertices cannot be read.
    #[error("cannot be read: {0}")]
    Io(io::Error),
    /// A line of a list of vertices.
    #[error("line {line}: {problem}")]
    Line {
        /// The line, counted from 1.
        line: usize,
        /// What is wrong with it.
        problem: LineProblem,
    },
    /// A part of a source in memory with a vertex that is not there.
    #[error("vertex {row} does not exist: the source has {n}, counted from 0")]
    NoVertex {
        /// Its row.
        row: usize,
        /// How many there are.
        n: usize,
    },
    /// A weight beyond its range.
    #[error("vertex {row} has the weight {weight}; weights go from 0 to 1")]
    Weight {
        /// Row of the vertex in the file.
        row: usize,
        /// Its weight.
        weight: f64,
    },
    /// A name without a vertex.
    #[error("selects no vertex of the source")]
    Empty,
}

/// What is wrong with a line of a list of vertices.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum LineProblem {
    /// A word where a row should be.
    #[error("'{0}' is no vertex number")]
    NotVertex(String),
    /// A vertex that is not there.
    #[error("vertex {row} does not exist: the source has {n}, counted from 0")]
    NoVertex {
        /// Its row.
        row: usize,
        /// How many there are.
        n: usize,
    },
    /// Not a vertex and a weight.
    #[error("needs a vertex and a weight")]
    NotPair,
    /// A word where a weight should be.
    #[error("'{0}' is no number")]
    NotNumber(String),
}
