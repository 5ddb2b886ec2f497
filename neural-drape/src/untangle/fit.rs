//! How far from the target a patch comes.

use mesh_core::{Point3, Positions, TriangleBvh, VertexId};

use super::crossing::Ground;
use crate::repair::Fit;

/// How far the median and the farthest of the attracted vertices are from the target.
pub(super) fn distances(fit: Fit<'_>, x: &Positions) -> [f64; 2] {
    let attracted = x.ids().filter(|&v| fit.attraction[v] > 0.0);
    let places: Vec<Point3> = attracted.map(|v| x[v]).collect();
    let hits = fit.target.closest_points(&places);
    let mut squares: Vec<f64> = hits.iter().map(|hit| hit.distance_squared).collect();
    squares.sort_by(f64::total_cmp);
    let at = |rank: usize| squares.get(rank).map_or(0.0, |square| square.sqrt());
    [at(squares.len() / 2), at(squares.len().saturating_sub(1))]
}

/// How far the attracted ones of the triangles `rows` and the target are from each other at `y`, at most, where they were
/// nearer at `x`: corners and middles from the target, and what of the target was next to them from the triangles. Zero where
/// nothing is farther than it was.
pub(super) fn excess(
    fit: Fit<'_>,
    ground: Ground<'_>,
    rows: &[u32],
    [x, y]: [&Positions; 2],
) -> f64 {
    let is_attracted = |row: &&u32| {
        let corners = &ground.triangulation.triangles()[**row as usize];
        corners.iter().all(|&v| fit.attraction[v] > 0.0)
    };
    let surface = TriangleBvh::new(corners(ground, rows, y));
    let rows: Vec<u32> = rows.iter().filter(is_attracted).copied().collect();
    let places = places(ground, &rows, x).zip(places(ground, &rows, y));
    let mut excess = 0.0f64;
    for (old, new) in places.filter(|(old, new)| old != new) {
        let was = fit.target.closest_point(&old);
        let there = fit.target.closest_point(&new).distance_squared;
        let back = surface.closest_point(&was.point);
        let back = back.map_or(0.0, |hit| hit.distance_squared);
        let is_farther = |d: &f64| *d > was.distance_squared;
        excess = [there, back]
            .into_iter()
            .filter(is_farther)
            .fold(excess, f64::max);
    }
    excess.sqrt()
}

fn corners(ground: Ground<'_>, rows: &[u32], x: &Positions) -> Vec<[Point3; 3]> {
    let triangles = ground.triangulation.triangles();
    let rows = rows.iter();
    rows.map(|&row| triangles[row as usize].map(|v: VertexId| x[v]))
        .collect()
}

/// Corners and middles of triangles.
fn places(ground: Ground<'_>, rows: &[u32], x: &Positions) -> impl Iterator<Item = Point3> {
    let of = |[a, b, c]: [Point3; 3]| {
        let middle = (a.coords + b.coords + c.coords) / 3.0;
        [a, b, c, middle.into()]
    };
    corners(ground, rows, x).into_iter().flat_map(of)
}
