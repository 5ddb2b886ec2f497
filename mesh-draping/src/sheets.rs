//! Sheets: parts of a draped shape that hang in the air or inside the target, between parts that are where they belong.

use mesh_core::measure::triangle_area;
use mesh_core::{Aabb, Positions, Triangulation, UnitFrame, VertexData, VertexId};
use mesh_init::{fit_affine, ArapSolver, FramePair, PointPair, SimilarityPrior};

use crate::Pair;

/// A triangle hangs where its middle is farther than this from the target, in longest sides.
const HANGING: f64 = 0.012;
/// Rings of vertices around what hangs that are shaped anew with it, one more in each further round.
const N_RINGS: usize = 4;
/// Where more than this share of the area would be shaped anew, the whole is in a wrong place: shaping parts is no help.
const LARGEST_SHARE: f64 = 0.2;

/// The shape `x` with what hangs, and what lies around it, as rigid as possible between the rest of the shape. None where
/// nothing hangs, or too much.
///
/// A sheet is held by what it was drawn to on its way, not by what it belongs to: between its surroundings the shape at rest
/// falls where it belongs. `off` is the distance of each triangle from the target, none where it does not count.
pub(crate) fn shaped_anew(
    pair: &Pair,
    x: &Positions,
    off: &[Option<f64>],
    round: usize,
) -> Option<Positions> {
    let (triangulation, rest) = (pair.source.triangulation(), pair.source.rest());
    let limit = HANGING * pair.target.judged().bounds().longest_side();
    let mut is_anew = VertexData::new(x.len(), false);
    let triangles = triangulation.triangles().iter().zip(off);
    let hanging = triangles.filter(|(_, off)| off.is_some_and(|d| d > limit));
    hanging.for_each(|(t, _)| t.iter().for_each(|&v| is_anew[v] = true));
    for _ in 0..N_RINGS + round {
        grow(triangulation, &mut is_anew);
    }
    let marked = pair.landmarks.iter().flat_map(|l| l.source.vertices);
    marked.for_each(|v| is_anew[v] = false);
    let share = share_of_area(triangulation, rest, &is_anew);
    if share == 0.0 || share > LARGEST_SHARE {
        return None;
    }
    let held: Vec<VertexId> = x.ids().filter(|&v| !is_anew[v]).collect();
    let places: Vec<_> = held.iter().map(|&v| x[v]).collect();
    let mut guess = x.clone();
    for part in parts(triangulation, &is_anew) {
        place_as_its_rim(rest, &part, &mut guess);
    }
    let solver = ArapSolver::new(triangulation, rest, &held).ok()?;
    Some(solver.solve(&places, &guess))
}

/// Adds the neighbours of what is in.
fn grow(triangulation: &Triangulation, is_in: &mut VertexData<bool>) {
    let before = is_in.clone();
    for v in triangulation.vertices().filter(|&v| before[v]) {
        let neighbours = triangulation.vertex_neighbours(v);
        neighbours.iter().for_each(|&w| is_in[w] = true);
    }
}

/// Share of the area at rest in triangles with a corner that is in.
fn share_of_area(triangulation: &Triangulation, rest: &Positions, is_in: &VertexData<bool>) -> f64 {
    let (mut inside, mut total) = (0.0, 0.0);
    for t in triangulation.triangles() {
        let area = triangle_area(t.map(|v| rest[v]));
        total += area;
        if t.iter().any(|&v| is_in[v]) {
            inside += area;
        }
    }
    if total > 0.0 {
        inside / total
    } else {
        0.0
    }
}

/// Vertices that hang together, and those around them.
struct Part {
    vertices: Vec<VertexId>,
    rim: Vec<VertexId>,
}

/// The connected parts of what is in.
fn parts(triangulation: &Triangulation, is_in: &VertexData<bool>) -> Vec<Part> {
    let mut is_seen = VertexData::new(is_in.len(), false);
    let mut parts = Vec::new();
    for first in triangulation.vertices().filter(|&v| is_in[v]) {
        if std::mem::replace(&mut is_seen[first], true) {
            continue;
        }
        let mut part = Part {
            vertices: vec![first],
            rim: Vec::new(),
        };
        let mut next = 0;
        while let Some(&v) = part.vertices.get(next) {
            next += 1;
            for &w in triangulation.vertex_neighbours(v) {
                if std::mem::replace(&mut is_seen[w], is_in[w]) {
                    continue;
                }
                if is_in[w] {
                    part.vertices.push(w);
                } else {
                    part.rim.push(w);
                }
            }
        }
        part.rim.sort_unstable();
        part.rim.dedup();
        parts.push(part);
    }
    parts
}

/// Turns, moves and scales a part at rest to where its rim is in `x`.
fn place_as_its_rim(rest: &Positions, part: &Part, x: &mut Positions) {
    let pair = |&v: &VertexId| PointPair {
        source: rest[v],
        target: x[v],
    };
    let pairs: Vec<PointPair> = part.rim.iter().map(pair).collect();
    if pairs.is_empty() {
        return;
    }
    let frames = FramePair {
        source: UnitFrame::of(Aabb::of(pairs.iter().map(|p| &p.source))),
        target: UnitFrame::of(Aabb::of(pairs.iter().map(|p| &p.target))),
    };
    let map = fit_affine(&pairs, frames, SimilarityPrior::Full);
    part.vertices
        .iter()
        .for_each(|&v| x[v] = map.apply(&rest[v]));
}
