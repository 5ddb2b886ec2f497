//! What can go wrong before draping starts.

use mesh_core::TopologyError;
use mesh_operators::SolveError;

/// Why there is no initial deformation.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InitError {
    /// The positions do not belong to the mesh.
    #[error("the mesh has {n_vertices} vertices and {n_positions} positions were given")]
    PositionCount {
        /// How many vertices the mesh has.
        n_vertices: usize,
        /// How many positions came with it.
        n_positions: usize,
    },
    /// A landmark names a vertex that the mesh does not have.
    #[error(
        "landmark {landmark} names vertex {vertex}; the mesh has {n_vertices} (rows count from 0)"
    )]
    LandmarkOutOfRange {
        /// Row of the landmark.
        landmark: usize,
        /// The vertex it names.
        vertex: usize,
        /// How many vertices the mesh has.
        n_vertices: usize,
    },
    /// A coordinate or weight of a landmark is not a number.
    #[error("landmark {landmark} has a coordinate or weight that is not finite")]
    NonFiniteLandmark {
        /// Row of the landmark.
        landmark: usize,
    },
    /// The source is dense and has no stand-in.
    #[error("the source has no coarse stand-in")]
    StandIn(#[from] TopologyError),
    /// A linear system of the deformation cannot be solved.
    #[error("the deformation cannot be solved for")]
    Solve(#[from] SolveError),
}
