//! What can go wrong in a drape.

/// A drape that cannot start or go on.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DrapeError {
    /// Two inputs that must have one entry per vertex differ in length.
    #[error("{what} has {found} entries, the mesh {expected} vertices")]
    LengthMismatch {
        /// Which input.
        what: &'static str,
        /// How many entries it has.
        found: usize,
        /// How many vertices there are.
        expected: usize,
    },
    /// The triangles are not those of the shapes.
    #[error("the triangulation is that of a mesh of {n_triangulated} vertices, the source has {n_vertices}")]
    ForeignTriangulation {
        /// How many vertices the mesh of the triangulation has.
        n_triangulated: usize,
        /// How many the source has.
        n_vertices: usize,
    },
    /// A shape or displacement has an entry that is not finite.
    #[error("vertex {vertex} of {what} is not a finite number")]
    VertexNotFinite {
        /// Which shape.
        what: &'static str,
        /// Which vertex.
        vertex: usize,
    },
    /// The place or the target of a landmark is not finite.
    #[error("landmark {landmark} has a coordinate or weight that is not a finite number")]
    LandmarkNotFinite {
        /// Row of the landmark.
        landmark: usize,
    },
    /// The mesh has no triangle with an area.
    #[error("the source mesh has no face with an area to drape")]
    NoArea,
    /// A setting is out of its range.
    #[error("setting {name} is {value}; it must be {expected}")]
    Setting {
        /// The setting.
        name: String,
        /// Its value.
        value: f64,
        /// What is allowed.
        expected: &'static str,
    },
    /// A setting asks for more memory than a drape may take.
    #[error("setting {name} is {value}, which takes about {gib:.0} GiB of memory; at most {limit_gib} are allowed, lower it")]
    Memory {
        /// The setting.
        name: &'static str,
        /// Its value.
        value: usize,
        /// What it takes, in GiB.
        gib: f64,
        /// What is allowed, in GiB.
        limit_gib: f64,
    },
    /// No preset has this name.
    #[error("there is no preset '{name}'; there are {known}")]
    UnknownPreset {
        /// What was asked for.
        name: String,
        /// All names.
        known: String,
    },
    /// The optimisation left the finite numbers.
    #[error("iteration {iteration} produced a position that is not a finite number; lower the learning rate")]
    Diverged {
        /// Which iteration.
        iteration: usize,
    },
    /// A landmark names a vertex that is not there.
    #[error("landmark {landmark} names vertex {vertex}, but there are {n_vertices}")]
    LandmarkOutOfRange {
        /// Row of the landmark.
        landmark: usize,
        /// The vertex.
        vertex: usize,
        /// How many vertices there are.
        n_vertices: usize,
    },
    /// A state does not belong to a drape of these inputs and settings.
    #[error("the saved state does not belong to these inputs and settings, or is damaged; start the drape anew")]
    ForeignState,
    /// The preconditioner could not be factored.
    #[error("the smoothing operator of the mesh could not be factored")]
    Preconditioner(#[from] mesh_operators::SolveError),
    /// The settings move a network, which this build cannot.
    #[error("the settings move a network, and neural-drape was built without its feature `network`; choose the preset standard or quick")]
    NetworkFeatureOff,
    /// A parametrization of the caller's own could not start or go on.
    #[error("the parametrization cannot go on")]
    Parametrization(#[source] Box<dyn std::error::Error + Send + Sync>),
    /// The network's tensors could not be made.
    #[error("no memory for the network's tensors; choose a narrower network")]
    OutOfMemory,
}
