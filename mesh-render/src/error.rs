//! What can go wrong with a picture.

use mesh_core::io::WriteError;
use mesh_core::TopologyError;

/// A picture or page that cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// The picture has no pixel, or more than its format can hold.
    #[error("a picture cannot be encoded: {0}")]
    Encode(String),
    /// The file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A shape that cannot be drawn.
    #[error(transparent)]
    Topology(#[from] TopologyError),
}
