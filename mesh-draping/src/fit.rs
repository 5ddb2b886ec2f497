//! How far a drape is off, as it sees its shapes: over what it does not leave out.

use mesh_core::sampling::SeededRng;
use mesh_core::{Point3, Positions, SurfacePoint, TriangleBvh};
use neural_drape::Drape;

use crate::Pair;

/// Places on the target that tell how much of it is reached.
const N_SAMPLES: usize = 4000;

/// Distances of the middles of the triangles from the target; none where they are left out.
pub(crate) fn to_target(pair: &Pair, drape: &Drape, x: &Positions) -> Vec<Option<f64>> {
    let target = pair.target.draped_over();
    let triangulation = pair.source.triangulation();
    let middles: Vec<Point3> = triangulation
        .corners(x)
        .map(|[a, b, c]| Point3::from((a.coords + b.coords + c.coords) / 3.0))
        .collect();
    let attraction = drape.attraction();
    let exceeds = drape.overlap().mesh_exceeds;
    let is_left_out = |row: usize, hit: &SurfacePoint| {
        let corners = &triangulation.triangles()[row];
        corners.iter().all(|&v| attraction[v] == 0.0)
            || exceeds && target.is_on_boundary(&hit.location)
    };
    distances(&target.closest_points(&middles), is_left_out)
}

/// Distances of places of the target from the mesh; none where they are left out.
pub(crate) fn to_mesh(pair: &Pair, drape: &Drape, x: &Positions) -> Vec<Option<f64>> {
    let target = pair.target.draped_over();
    let triangulation = pair.source.triangulation();
    let samples = target.sample(N_SAMPLES, &mut SeededRng::new(0));
    let points: Vec<Point3> = samples.iter().map(|s| s.point).collect();
    let bvh = TriangleBvh::new(triangulation.corners(x).collect());
    let exceeds = drape.overlap().target_exceeds;
    let is_left_out = |_, hit: &SurfacePoint| {
        let corners = &triangulation.triangles()[hit.location.row() as usize];
        exceeds && corners.iter().any(|&v| triangulation.is_boundary_vertex(v))
    };
    distances(&bvh.closest_points(&points), is_left_out)
}

/// The distance of each place that is not left out.
fn distances(
    hits: &[SurfacePoint],
    is_left_out: impl Fn(usize, &SurfacePoint) -> bool,
) -> Vec<Option<f64>> {
    let distance = |(row, hit): (usize, &SurfacePoint)| {
        (!is_left_out(row, hit)).then(|| hit.distance_squared.sqrt())
    };
    hits.iter().enumerate().map(distance).collect()
}
