//! What can go wrong with a baked map.

use std::path::PathBuf;

use mesh_core::io::ReadError;
use mesh_core::TopologyError;

use crate::RenderError;

/// A map that cannot be baked.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BakeError {
    /// A source without texture coordinates.
    #[error("the source has no texture coordinates, by which a picture could be laid out")]
    NoUvs,
    /// Texture coordinates that cover no texel.
    #[error("the texture coordinates of the source cover no texel: all its faces are flat in the picture")]
    NoTexel,
    /// A face whose texture coordinates reach over very many squares.
    #[error("face {face} (counted from 0) reaches over {squares:.0} squares of texture coordinates; at most {most:.0} are baked")]
    TooWide {
        /// Row of the face.
        face: usize,
        /// How many unit squares it reaches over, along one axis.
        squares: f64,
        /// How many it may.
        most: f64,
    },
    /// A side that no picture can have.
    #[error("a texture of {size} texels along its side cannot be baked; use {least} to {most}")]
    Size {
        /// The side, in texels.
        size: usize,
        /// The least.
        least: usize,
        /// The most.
        most: usize,
    },
    /// A target that has nothing to paint with.
    #[error("{}: has neither colours of vertices nor a picture that is there to be read", path.display())]
    NoColors {
        /// The file of the target.
        path: PathBuf,
    },
    /// A picture of the target that is not understood.
    #[error("{}: {problem}", path.display())]
    Picture {
        /// The file of the target.
        path: PathBuf,
        /// What is wrong with its picture.
        problem: PictureError,
    },
    /// Colours of another shape than the one that was draped over.
    #[error("{}: is another shape than the target: {found} vertices instead of {expected}", path.display())]
    AnotherShape {
        /// The file.
        path: PathBuf,
        /// How many vertices it has.
        found: usize,
        /// How many the target has.
        expected: usize,
    },
    /// A file cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The target cannot be asked for its closest points.
    #[error(transparent)]
    Topology(#[from] TopologyError),
    /// A picture cannot be written.
    #[error(transparent)]
    Render(#[from] RenderError),
}

/// A picture that is not understood.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
    /// Neither PNG nor JPEG.
    #[error("its picture is neither PNG nor JPEG; convert it")]
    UnknownFormat,
    /// The decoder refused it.
    #[error("its picture cannot be read: {0}")]
    Broken(String),
    /// No pixel.
    #[error("its picture has no pixel")]
    Empty,
}
