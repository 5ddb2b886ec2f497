//! Edges of a closed triangle mesh flipped until it is Delaunay.

use std::collections::{BTreeMap, VecDeque};

use mesh_core::measure::{corner_angle, triangle_normal};
use mesh_core::Point3;

/// Two triangles that an edge lies between must face one way by at least this cosine to be cut the other way.
const FLAT_COSINE: f64 = 0.95;

/// An edge is flipped when the angles across it sum to more than this.
const LARGEST_SUM: f64 = std::f64::consts::PI + 1e-9;

/// Flips edges while the angles across one sum to more than 180°, where the surface is nearly flat there and the other
/// diagonal is no edge yet. At most ten flips for each edge.
pub(crate) fn make_delaunay(x: &[Point3], triangles: &mut [[u32; 3]]) {
    let mut triangle_of: BTreeMap<[u32; 2], usize> = BTreeMap::new();
    for (t, corners) in triangles.iter().enumerate() {
        for k in 0..3 {
            triangle_of.insert([corners[k], corners[(k + 1) % 3]], t);
        }
    }
    let mut left: VecDeque<[u32; 2]> = triangle_of.keys().filter(|[a, b]| a < b).copied().collect();
    let mut n_left = 10 * left.len();
    while let Some([a, b]) = left.pop_front() {
        let (Some(&s), Some(&t)) = (triangle_of.get(&[a, b]), triangle_of.get(&[b, a])) else {
            continue;
        };
        let [c, d] = [s, t].map(|row| apex(&triangles[row], a, b));
        let is_edge = triangle_of.contains_key(&[c, d]) || triangle_of.contains_key(&[d, c]);
        if is_edge || n_left == 0 || !is_better_flipped(x, [a, b, c, d]) {
            continue;
        }
        n_left -= 1;
        triangle_of.remove(&[a, b]);
        triangle_of.remove(&[b, a]);
        triangles[s] = [a, d, c];
        triangles[t] = [d, b, c];
        for row in [s, t] {
            let corners = triangles[row];
            (0..3).for_each(|k| {
                triangle_of.insert([corners[k], corners[(k + 1) % 3]], row);
            });
        }
        left.extend([[b, c], [c, a], [a, d], [d, b]]);
    }
}

/// The corner of a triangle that is neither `a` nor `b`.
fn apex(triangle: &[u32; 3], a: u32, b: u32) -> u32 {
    triangle
        .iter()
        .copied()
        .find(|&v| v != a && v != b)
        .unwrap_or(a)
}

/// Whether the edge `ab` between the triangles `abc` and `bad` is to become `cd`.
fn is_better_flipped(x: &[Point3], [a, b, c, d]: [u32; 4]) -> bool {
    let [a, b, c, d] = [a, b, c, d].map(|v| x[v as usize]);
    if corner_angle(c, a, b) + corner_angle(d, a, b) <= LARGEST_SUM {
        return false;
    }
    let normals = [[a, b, c], [b, a, d], [a, d, c], [d, b, c]].map(triangle_normal);
    let [Some(n0), Some(n1), Some(n2), Some(n3)] = normals else {
        return false;
    };
    [n1, n2, n3].iter().all(|n| n0.dot(n) > FLAT_COSINE) && n2.dot(&n3) > FLAT_COSINE
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flat_kite_is_cut_along_its_short_diagonal() {
        let x = [[0., 0., 0.], [4., 0., 0.], [2., 1., 0.], [2., -1., 0.]].map(Point3::from);
        let mut triangles = [[0, 1, 2], [1, 0, 3]];
        make_delaunay(&x, &mut triangles);
        assert_eq!(triangles, [[0, 3, 2], [3, 1, 2]]);
    }
}
