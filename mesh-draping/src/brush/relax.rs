//! The local shape at rest, brought back.

use mesh_core::{nearest_rotation, Point3, Positions, VertexData, VertexId};
use nalgebra::Matrix3;
use rayon::prelude::*;

use super::ball::Ball;
use crate::Pair;

/// How often each dab goes over its vertices.
const N_SWEEPS: usize = 8;
/// A vertex goes this share of the way to its aim at once, so that neighbours do not swing past each other.
const DAMPING: f64 = 0.5;

/// Moves each vertex towards where its neighbours want it:
///
/// `aᵥ = meanⱼ (xⱼ + s ½(Rᵥ + Rⱼ)(rᵥ − rⱼ))`, `x'ᵥ = xᵥ + ½ wᵥ (aᵥ − xᵥ)`, again and again
///
/// with the places r at rest, the rotation R that turns the edges of a vertex at rest into those it has, and s, by how much
/// the edges under the brush are longer than at rest (their median). A turned, moved and enlarged rest shape stays as it is.
/// A vertex without edges stays. Source: the local step of Sorkine and Alexa 2007, with a scale.
pub(super) fn relax(pair: &Pair, ball: &Ball, x: &mut Positions) {
    for _ in 0..N_SWEEPS {
        let scale = scale(pair, ball, x);
        let turns = turns(pair, ball, x);
        let aims = ball.0.par_iter().with_min_len(64).map(|&(v, weight)| {
            let aim = aim(pair, x, &turns, v, scale);
            aim.map_or(x[v], |aim| x[v] + (aim - x[v]) * (DAMPING * weight))
        });
        let aims: Vec<Point3> = aims.collect();
        ball.put(x, aims);
    }
}

/// The median of how much longer the edges of some vertices are than at rest; 1 where none has a length.
fn scale(pair: &Pair, ball: &Ball, x: &Positions) -> f64 {
    let (t, rest) = (pair.source.triangulation(), pair.source.rest());
    let edges = ball.0.iter().flat_map(|&(v, _)| {
        let ends = t.vertex_neighbours(v).iter();
        ends.map(move |&w| ((x[w] - x[v]).norm(), (rest[w] - rest[v]).norm()))
    });
    let mut ratios: Vec<f64> = edges
        .filter(|(_, at_rest)| *at_rest > 0.0)
        .map(|(now, at_rest)| now / at_rest)
        .collect();
    let middle = ratios.len() / 2;
    if ratios.is_empty() {
        return 1.0;
    }
    *ratios.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// How the surroundings of the vertices of a ball, and of their neighbours, are turned; others have no entry of use.
fn turns(pair: &Pair, ball: &Ball, x: &Positions) -> VertexData<Matrix3<f64>> {
    let t = pair.source.triangulation();
    let around = |&(v, _): &(VertexId, f64)| t.vertex_neighbours(v).iter().copied().chain([v]);
    let mut needed: Vec<VertexId> = ball.0.iter().flat_map(around).collect();
    needed.sort_unstable();
    needed.dedup();
    let found = needed.par_iter().with_min_len(64);
    let found: Vec<Matrix3<f64>> = found.map(|&v| turn(pair, x, v)).collect();
    let mut turns = VertexData::new(x.len(), Matrix3::identity());
    for (v, turn) in needed.into_iter().zip(found) {
        turns[v] = turn;
    }
    turns
}

/// The rotation nearest to `Σⱼ (xⱼ − xᵥ)(rⱼ − rᵥ)ᵀ`.
fn turn(pair: &Pair, x: &Positions, v: VertexId) -> Matrix3<f64> {
    let rest = pair.source.rest();
    let ends = pair.source.triangulation().vertex_neighbours(v).iter();
    let sum: Matrix3<f64> = ends
        .map(|&w| (x[w] - x[v]) * (rest[w] - rest[v]).transpose())
        .sum();
    nearest_rotation(&sum)
}

fn aim(
    pair: &Pair,
    x: &Positions,
    turns: &VertexData<Matrix3<f64>>,
    v: VertexId,
    scale: f64,
) -> Option<Point3> {
    let rest = pair.source.rest();
    let ends = pair.source.triangulation().vertex_neighbours(v);
    let wanted = ends.iter().map(|&w| {
        let turn = (turns[v] + turns[w]) * 0.5;
        x[w].coords + turn * (rest[v] - rest[w]) * scale
    });
    let sum: mesh_core::Vector3 = wanted.sum();
    (!ends.is_empty()).then(|| Point3::from(sum / ends.len() as f64))
}
