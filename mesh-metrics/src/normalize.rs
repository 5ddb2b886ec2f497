//! The frames that make figures of different pairs comparable.

use mesh_core::measure::triangle_areas;
use mesh_core::{Aabb, Positions, TargetSurface, Triangulation, UnitFrame};

/// The frame in which every length of a report is given: the target centred, the longest side of its box 1.
///
/// Source: Mesh Draping, "Evaluation Metrics" ("all 3D models are normalized to the unit cube"). Departures: the
/// draped mesh takes the target's transform, not one of its own, which would hide a misfit.
pub fn common_frame(target: &dyn TargetSurface) -> UnitFrame {
    UnitFrame::of(target.bounds())
}

/// The frame of a shape by itself: the vertices in use centred, the longest side of their box 1.
pub fn own_frame(triangulation: &Triangulation, x: &Positions) -> UnitFrame {
    let corners = triangulation.triangles().iter().flatten();
    UnitFrame::of(Aabb::of(corners.map(|&v| &x[v])))
}

/// Total area of a triangulation at `x`, in squared units of `x`.
pub fn total_area(triangulation: &Triangulation, x: &Positions) -> f64 {
    triangle_areas(triangulation, x).iter().sum()
}
