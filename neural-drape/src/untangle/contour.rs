//! Surfaces that cross, moved so that the line in which they cross gets shorter.

use mesh_core::measure::{area_vector, triangle_normal};
use mesh_core::{Point3, Positions, Triangulation, Vector3, VertexId};

use super::crossing::pierced_edges;

/// A corner moves by at most this share of the edges of its triangles in one turn.
const STEP: f64 = 0.25;
/// An edge is taken to meet a triangle at an angle of at least this sine: nearly within its plane the line grows without bound.
const LEAST_SLOPE: f64 = 0.05;

/// A place where an edge of one triangle runs through another: an end of the line in which they cross.
struct End {
    edge: [VertexId; 2],
    triangle: [VertexId; 3],
    /// Where along the edge, 0..=1.
    u: f64,
    point: Point3,
}

/// Moves the corners of each pair against the gradient of the length of the line in which the two cross; those of `free`
/// alone, given in ascending order.
///
/// With the ends p, q of the line, `g = (p − q)/|p − q|`; where p lies at u on the edge (a, b) with direction e and at
/// barycentric β on the triangle c with normal n, `k = n (g·e)/(n·e)`: `∂L/∂a = (1 − u)(g − k)`, `∂L/∂b = u (g − k)`,
/// `∂L/∂c_i = β_i k`. Source: Volino and Magnenat-Thalmann 2006, contour minimisation.
pub(super) fn shorten(
    triangulation: &Triangulation,
    pairs: &[[u32; 2]],
    x: &mut Positions,
    free: &[VertexId],
) {
    let mut moves = vec![(Vector3::zeros(), 0.0f64); free.len()];
    for &[one, two] in pairs {
        let [s, t] = [one, two].map(|row| triangulation.triangles()[row as usize]);
        let size = |t: [VertexId; 3]| area_vector(t.map(|v| x[v])).norm().sqrt();
        let step = STEP * size(s).min(size(t));
        let mut ends = ends(s, t, x);
        ends.extend(self::ends(t, s, x));
        let [one, other] = &ends[..] else { continue };
        let along = one.point - other.point;
        let length = along.norm();
        if length <= f64::MIN_POSITIVE {
            continue;
        }
        for (end, g) in [(one, along / length), (other, -along / length)] {
            for (v, gradient) in gradient(end, g, x) {
                if let Ok(row) = free.binary_search(&v) {
                    moves[row].0 -= gradient * step;
                    moves[row].1 = moves[row].1.max(step);
                }
            }
        }
    }
    for (&v, (by, most)) in free.iter().zip(&moves) {
        let length = by.norm();
        if length > 0.0 && length.is_finite() {
            x[v] += by * (most / length.max(*most));
        }
    }
}

fn gradient(end: &End, g: Vector3, x: &Positions) -> [(VertexId, Vector3); 5] {
    let [a, b] = end.edge;
    let e = x[b] - x[a];
    let corners = end.triangle.map(|v| x[v]);
    let n = triangle_normal(corners).unwrap_or_default();
    let slope = n.dot(&e);
    let least = LEAST_SLOPE * e.norm();
    let slope = if slope.abs() < least {
        least.copysign(slope)
    } else {
        slope
    };
    let k = n * (g.dot(&e) / slope);
    let beta = barycentric(corners, end.point);
    let [c0, c1, c2] = end.triangle;
    [
        (a, (g - k) * (1.0 - end.u)),
        (b, (g - k) * end.u),
        (c0, k * beta[0]),
        (c1, k * beta[1]),
        (c2, k * beta[2]),
    ]
}

/// Where edges of `s` run through `t`.
fn ends(s: [VertexId; 3], t: [VertexId; 3], x: &Positions) -> Vec<End> {
    let corners = t.map(|v| x[v]);
    let edges = pierced_edges(&s.map(|v| x[v]), &corners);
    let of = |k: usize| {
        let edge = [s[k], s[(k + 1) % 3]];
        let [a, b] = edge.map(|v| x[v]);
        let n = triangle_normal(corners)?;
        let (from, to) = ((a - corners[0]).dot(&n), (b - corners[0]).dot(&n));
        let u = (from / (from - to)).clamp(0.0, 1.0);
        u.is_finite().then(|| End {
            edge,
            triangle: t,
            u,
            point: a + (b - a) * u,
        })
    };
    edges.into_iter().filter_map(of).collect()
}

/// Barycentric coordinates of a point in the plane of a triangle.
fn barycentric([a, b, c]: [Point3; 3], p: Point3) -> [f64; 3] {
    let n = area_vector([a, b, c]);
    let whole = n.norm_squared().max(f64::MIN_POSITIVE);
    let part = |q: Point3, r: Point3| (area_vector([p, q, r]).dot(&n) / whole).clamp(0.0, 1.0);
    [part(b, c), part(c, a), part(a, b)]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::untangle::crossing::is_crossing;

    /// The length of the line in which two triangles cross.
    fn length(s: [VertexId; 3], t: [VertexId; 3], x: &Positions) -> f64 {
        let mut ends = ends(s, t, x);
        ends.extend(super::ends(t, s, x));
        let [one, other] = &ends[..] else { return 0.0 };
        (one.point - other.point).norm()
    }

    /// Whether every edge meets the other triangle at a clear angle, in a line that is not too short.
    fn is_clear(s: [VertexId; 3], t: [VertexId; 3], x: &Positions) -> bool {
        let is_steep = |end: &End| {
            let e = x[end.edge[1]] - x[end.edge[0]];
            let n = triangle_normal(end.triangle.map(|v| x[v])).unwrap_or_default();
            n.dot(&e).abs() > 2.0 * LEAST_SLOPE * e.norm()
        };
        let mut ends = ends(s, t, x);
        ends.extend(super::ends(t, s, x));
        ends.iter().all(is_steep) && length(s, t, x) > 0.02
    }

    /// The gradient of [`length`] at each corner.
    fn gradients(s: [VertexId; 3], t: [VertexId; 3], x: &Positions) -> Vec<Vector3> {
        let mut ends = ends(s, t, x);
        ends.extend(super::ends(t, s, x));
        let mut sum = vec![Vector3::zeros(); 6];
        let [one, other] = &ends[..] else { return sum };
        let along = {
            let d = one.point - other.point;
            d / d.norm()
        };
        for (end, g) in [(one, along), (other, -along)] {
            for (v, gradient) in gradient(end, g, x) {
                sum[v.index()] += gradient;
            }
        }
        sum
    }

    proptest! {
        #[test]
        fn the_gradient_is_that_of_differences(corners in prop::array::uniform18(-1.0..1.0f64)) {
            let point = |k: usize| Point3::new(corners[3 * k], corners[3 * k + 1], corners[3 * k + 2]);
            let x: Positions = (0..6).map(point).collect();
            let [s, t] = [[0, 1, 2], [3, 4, 5]].map(|t| t.map(VertexId::new));
            prop_assume!(is_crossing(&s.map(|v| x[v]), &t.map(|v| x[v])));
            prop_assume!(is_clear(s, t, &x));
            let analytic = gradients(s, t, &x);
            let h = 1e-7;
            for v in x.ids() {
                for k in 0..3 {
                    let at = |by: f64| {
                        let mut moved = x.clone();
                        moved[v][k] += by;
                        length(s, t, &moved)
                    };
                    let slope = (at(h) - at(-h)) / (2.0 * h);
                    let scale = 1.0 + analytic.iter().map(|g| g.norm()).fold(0.0, f64::max);
                    prop_assert!((slope - analytic[v.index()][k]).abs() < 1e-4 * scale);
                }
            }
        }
    }
}
