//! Distances along a surface.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use mesh_core::{Point3, Positions, Triangulation, VertexData, VertexId};

/// Distance along the surface from the nearest of `sources` to each vertex, by unfolding triangles.
///
/// Dijkstra's order; besides the edges, each triangle is unfolded into the plane, where two of its vertices with
/// known distances place the source, and the third is that far from it if the straight line passes between them.
///
/// One entry per vertex of `x`, in its units; infinite where no path of triangles leads. Exact on a flat piece that
/// is convex; elsewhere a good approximation, never above the distance along edges. Source: Novotni and
/// Klein 2002. Departures: none.
///
/// # Panics
/// If a source is not a row of `x`, or `x` has not one position for each vertex of the mesh.
pub fn geodesic_distance_unfolded(
    triangulation: &Triangulation,
    x: &Positions,
    sources: &[VertexId],
) -> VertexData<f64> {
    let mut distance = VertexData::new(x.len(), f64::INFINITY);
    // Distances are ≥ 0, and the bits of such numbers are ordered as the numbers are.
    let mut queue = BinaryHeap::new();
    for &v in sources {
        distance[v] = 0.0;
        queue.push(Reverse((0.0f64.to_bits(), v)));
    }
    while let Some(Reverse((bits, v))) = queue.pop() {
        if bits != distance[v].to_bits() {
            continue;
        }
        for &t in triangulation.vertex_triangles(v) {
            let corners = triangulation.triangles()[t as usize];
            for k in 0..3 {
                let (c, a, b) = (corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]);
                if c == v {
                    continue;
                }
                let across = distance_across([x[a], x[b], x[c]], [distance[a], distance[b]]);
                if across < distance[c] {
                    distance[c] = across;
                    queue.push(Reverse((across.to_bits(), c)));
                }
            }
        }
    }
    distance
}

/// Distance of `c` when those of `a` and `b` are known: straight through the triangle where the unfolded line
/// crosses the side `ab`, otherwise along the nearer edge.
fn distance_across([a, b, c]: [Point3; 3], [da, db]: [f64; 2]) -> f64 {
    let along_edges = (da + (c - a).norm()).min(db + (c - b).norm());
    let side = (b - a).norm();
    if side == 0.0 || !da.is_finite() || !db.is_finite() {
        return along_edges;
    }
    // Plane with a at the origin and b at (side, 0); the source below the axis, c above it.
    let foot = |to_a2: f64, to_b2: f64| (to_a2 - to_b2 + side * side) / (2.0 * side);
    let below = |to_a2: f64, along: f64| to_a2 - along * along;
    let (ca2, cb2) = ((c - a).norm_squared(), (c - b).norm_squared());
    let (sx, cx) = (foot(da * da, db * db), foot(ca2, cb2));
    let (sy2, cy2) = (below(da * da, sx), below(ca2, cx));
    if sy2 < 0.0 || cy2 <= 0.0 {
        return along_edges;
    }
    let (sy, cy) = (sy2.sqrt(), cy2.sqrt());
    let crossing = sx + (cx - sx) * sy / (sy + cy);
    if (0.0..=side).contains(&crossing) {
        (cx - sx).hypot(cy + sy).min(along_edges)
    } else {
        along_edges
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unfolds_through_a_side_and_falls_back_to_edges() {
        let [a, b] = [Point3::new(0., 0., 0.), Point3::new(2., 0., 0.)];
        let root2 = 2f64.sqrt();
        let through = distance_across([a, b, Point3::new(1., 1., 0.)], [root2, root2]);
        assert!((through - 2.0).abs() < 1e-15);
        let around = distance_across([a, b, Point3::new(-1., 1., 0.)], [0.0, 2.0]);
        assert!((around - root2).abs() < 1e-15);
        assert_eq!(distance_across([a, b, a], [f64::INFINITY, 1.0]), 3.0);
    }
}
