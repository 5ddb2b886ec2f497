//! What can be wrong with a mesh.

/// A polygon soup that cannot become a mesh.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TopologyError {
    /// A face names a vertex that is not there.
    #[error(
        "face {face} names vertex {vertex}, but there are {n_vertices} vertices (counted from 0)"
    )]
    VertexOutOfRange {
        /// Row of the face.
        face: usize,
        /// The vertex it names.
        vertex: u32,
        /// How many vertices there are.
        n_vertices: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} (counted from 0) has a coordinate that is not a finite number")]
    NonFiniteCoordinate {
        /// Row of the vertex.
        vertex: usize,
    },
    /// There is no face.
    #[error("the mesh has no faces")]
    NoFaces,
    /// There is neither a face nor a point.
    #[error("there are no points")]
    NoPoints,
    /// A point cloud with some other number of normals than points.
    #[error(
        "{n_normals} normals for {n_points} points: give one normal per point, or none at all"
    )]
    NormalCount {
        /// How many normals there are.
        n_normals: usize,
        /// How many points there are.
        n_points: usize,
    },
    /// More elements than a 32-bit index can name.
    #[error("{count} {element} are more than the {max} that fit a 32-bit index")]
    TooMany {
        /// Which element.
        element: &'static str,
        /// How many there are.
        count: usize,
        /// How many are allowed.
        max: usize,
    },
}
