//! Where the corners of two triangles that cross belong.

use mesh_core::measure::{area_vector, triangle_normal};
use mesh_core::{Point3, Positions, Triangulation, UnitFrame, Vector3, VertexId};

/// A corner is pushed by at most this share of the edges of its triangle in one turn.
const STEP: f64 = 0.3;
/// A corner is pushed beyond the plane of the other triangle by this share of those edges.
const CLEARANCE: f64 = 0.05;

/// Triangles farther apart at rest than this share of the longest side faced each other: what lies behind a surface is nearer.
const FAR: f64 = 0.08;

/// Whether two triangles belong before or behind each other.
///
/// What faced each other at rest, as two fingers do, belongs before: the sign of `(c_s − c_t)·n_t + (c_t − c_s)·n_s` at
/// rest, with middles c and normals n. What had the other behind it, as the lining of a lip, belongs behind.
fn order(s: &[Point3; 3], t: &[Point3; 3], far: f64) -> f64 {
    let between =
        (s[0].coords + s[1].coords + s[2].coords) - (t[0].coords + t[1].coords + t[2].coords);
    let normal = |t: &[Point3; 3]| triangle_normal(*t).unwrap_or_default();
    if between.norm() > 3.0 * far {
        return 1.0;
    }
    let before = between.dot(&normal(t)) - between.dot(&normal(s));
    if before < 0.0 {
        -1.0
    } else {
        1.0
    }
}

/// Moves the corners of the triangles of each pair towards the side of the other where they belong; those of `free` alone,
/// given in ascending order.
pub(super) fn push_apart(
    triangulation: &Triangulation,
    rest: &Positions,
    pairs: &[[u32; 2]],
    x: &mut Positions,
    free: &[VertexId],
) {
    let far = FAR * UnitFrame::principal(rest.as_slice()).scale;
    let mut moves = vec![(Vector3::zeros(), 0.0f64); free.len()];
    for &[one, two] in pairs {
        let [s, t] = [one, two].map(|row| triangulation.triangles()[row as usize]);
        let [rest_s, rest_t] = [s, t].map(|t| t.map(|v| rest[v]));
        let order = order(&rest_s, &rest_t, far);
        for (moved, fixed) in [(s, t), (t, s)] {
            let plane = fixed.map(|v| x[v]);
            let Some(normal) = triangle_normal(plane) else {
                continue;
            };
            let step = STEP * area_vector(moved.map(|v| x[v])).norm().sqrt();
            for v in moved {
                let Ok(row) = free.binary_search(&v) else {
                    continue;
                };
                let depth = -order * (x[v] - plane[0]).dot(&normal);
                if depth > 0.0 {
                    let by = (0.5 * depth + CLEARANCE / STEP * step).min(step);
                    moves[row].0 += normal * (order * by);
                    moves[row].1 += 1.0;
                }
            }
        }
    }
    for (&v, (sum, n)) in free.iter().zip(&moves) {
        if *n > 0.0 {
            x[v] += sum / *n;
        }
    }
}
