//! Distances between a draped mesh and its target, both ways, in the common frame.

use mesh_core::{Location, Positions, SurfacePoint, TargetSurface, Triangulation, VertexData};

use crate::config::EvaluationConfig;
use crate::counterparts::Counterparts;
use crate::normalize::common_frame;

/// What the target is, and so what a distance to it means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize),
    serde(rename_all = "snake_case")
)]
pub enum TargetKind {
    /// Triangles: distances both ways are exact, from point to surface.
    Surface,
    /// Points: exact from cloud to draped surface; the other way to the nearest point, so never below the spacing of
    /// the cloud.
    Cloud,
}

impl TargetKind {
    /// The kind of `target`.
    pub fn of(target: &dyn TargetSurface) -> Self {
        match target.closest_point(&target.bounds().center()).location {
            Location::Triangle { .. } => Self::Surface,
            Location::Point { .. } => Self::Cloud,
        }
    }
}

/// Distances from points of one shape to another shape, in longest sides of the target's box.
#[derive(Clone, Debug, PartialEq)]
pub struct DirectedDistances {
    /// From random points, uniform by area; from every point of a cloud.
    pub of_samples: Vec<f64>,
    /// From the vertices in use, which random points miss; none for a cloud, whose points are all among the samples.
    pub of_vertices: Vec<f64>,
}

impl DirectedDistances {
    /// From every point asked, samples first.
    pub fn all(&self) -> impl Iterator<Item = f64> + '_ {
        self.of_samples.iter().chain(&self.of_vertices).copied()
    }
}

/// Distances between a draped mesh and its target, both ways.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceDistances {
    /// From the draped mesh to the target.
    pub to_target: DirectedDistances,
    /// From the target to the draped mesh.
    pub to_draped: DirectedDistances,
}

impl SurfaceDistances {
    /// Measures from `config.n_samples` points per surface and from every vertex in use.
    ///
    /// Degenerate input: no distance at all where `triangulation` is empty.
    pub fn measure(
        triangulation: &Triangulation,
        draped: &Positions,
        target: &dyn TargetSurface,
        config: &EvaluationConfig,
    ) -> Self {
        let all = Counterparts::all(draped.len());
        all.distances(triangulation, draped, target, config)
            .distances
    }
}

/// Distance from every vertex to the target, in the common frame: what a heat map shows.
pub fn vertex_distances(draped: &Positions, target: &dyn TargetSurface) -> VertexData<f64> {
    let unit = 1.0 / common_frame(target).scale;
    VertexData::from(lengths(&target.closest_points(draped.as_slice()), unit))
}

fn lengths(closest: &[SurfacePoint], unit: f64) -> Vec<f64> {
    closest
        .iter()
        .map(|c| c.distance_squared.sqrt() * unit)
        .collect()
}
