//! Which triangles meet at a place, and the normal there.

use crate::measure::corner_angle;
use crate::{Point3, Rows, Vector3, VertexId};

/// A barycentric weight up to this counts as zero: the place is on a side.
pub const ON_SIDE: f64 = 1e-9;

/// The triangles around every vertex.
///
/// At an edge or a corner, which of the triangles a closest point belongs to is up to rounding; what is computed there
/// should see all of them.
#[derive(Clone, Debug, PartialEq)]
pub struct TriangleFans {
    triangles: Vec<[VertexId; 3]>,
    at_vertex: Rows<u32>,
}

impl TriangleFans {
    /// The fans of triangles over `n_vertices` vertices.
    ///
    /// # Panics
    /// If a triangle names a vertex that is not there.
    pub fn new(n_vertices: usize, triangles: Vec<[VertexId; 3]>) -> Self {
        let corners = (0u32..).zip(&triangles);
        let corners = corners.flat_map(|(row, t)| t.map(|v| (v.index(), row)));
        Self {
            at_vertex: Rows::from_pairs(n_vertices, corners),
            triangles,
        }
    }

    /// The triangles, in order.
    pub fn triangles(&self) -> &[[VertexId; 3]] {
        &self.triangles
    }

    /// The rows of the triangles at a vertex, ascending.
    pub fn at_vertex(&self, v: VertexId) -> &[u32] {
        &self.at_vertex[v.index()]
    }

    /// Unit normal at a place of triangle `row`: its own inside it, the mean over all triangles that meet where the place
    /// is on an edge, weighted by their angles where it is on a corner.
    ///
    /// `corners` and `normal` are asked for triangles by row. Where only the lines of normals mean something
    /// (`is_oriented` false), they are turned to the side of the triangle's own. None where normals cancel, or no
    /// triangle has one. Source: Bærentzen and Aanæs 2005, "Signed distance computation using the angle weighted
    /// pseudonormal".
    pub fn normal(
        &self,
        row: u32,
        barycentric: &[f64; 3],
        is_oriented: bool,
        corners: impl Fn(u32) -> [Point3; 3],
        normal: impl Fn(u32) -> Option<Vector3>,
    ) -> Option<Vector3> {
        let own = normal(row);
        let Some(at) = Crease::of(self.triangles[row as usize], barycentric) else {
            return own;
        };
        let mut sum = Vector3::zeros();
        for &other in self.at_vertex(at.corner) {
            let vertices = &self.triangles[other as usize];
            let Some((k, mut n)) = at.corner_in(vertices).zip(normal(other)) else {
                continue;
            };
            if !is_oriented && own.is_some_and(|own| own.dot(&n) < 0.0) {
                n = -n;
            }
            let weight = if at.end.is_some() {
                1.0
            } else {
                let p = corners(other);
                corner_angle(p[k], p[(k + 1) % 3], p[(k + 2) % 3])
            };
            sum += n * weight;
        }
        // Opposite normals cancel up to rounding.
        sum.try_normalize(1e-6)
    }
}

/// Whether a place lies on a side or a corner of its triangle.
pub fn is_on_side(barycentric: &[f64; 3]) -> bool {
    barycentric.iter().any(|&w| w <= ON_SIDE)
}

/// A corner, or the edge from it to `end`.
struct Crease {
    corner: VertexId,
    end: Option<VertexId>,
}

impl Crease {
    /// Where a place lies that is not inside its triangle.
    fn of(triangle: [VertexId; 3], barycentric: &[f64; 3]) -> Option<Self> {
        if !is_on_side(barycentric) {
            return None;
        }
        let mut touched = (0..3).filter(|&k| barycentric[k] > ON_SIDE);
        Some(Self {
            corner: triangle[touched.next()?],
            end: touched.next().map(|k| triangle[k]),
        })
    }

    /// Which corner of a triangle of the fan this starts at; none where the triangle does not touch it.
    fn corner_in(&self, triangle: &[VertexId; 3]) -> Option<usize> {
        let touches = self.end.is_none_or(|end| triangle.contains(&end));
        let k = triangle.iter().position(|&v| v == self.corner)?;
        touches.then_some(k)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A roof over the x axis, its sides at right angles, and a third wall below the ridge.
    const CORNERS: [[f64; 3]; 5] = [
        [0., 0., 0.],
        [1., 0., 0.],
        [0., 1., -1.],
        [0., -1., -1.],
        [0., 0., -1.],
    ];

    fn normal(triangles: &[[u32; 3]], row: u32, w: [f64; 3], oriented: bool) -> Option<Vector3> {
        let corners = |t: u32| triangles[t as usize].map(|v| Point3::from(CORNERS[v as usize]));
        let of_ids = triangles
            .iter()
            .map(|t| t.map(|v| VertexId::new(v as usize)));
        TriangleFans::new(CORNERS.len(), of_ids.collect()).normal(row, &w, oriented, corners, |t| {
            crate::measure::triangle_normal(corners(t))
        })
    }

    #[test]
    fn the_ridge_of_a_roof_points_up_from_either_side() {
        let roof = [[0, 1, 2], [1, 0, 3]];
        for (row, ends) in [(0, [0.3, 0.7, 0.0]), (1, [0.7, 0.3, 0.0])] {
            let n = normal(&roof, row, ends, true).unwrap();
            assert!((n - Vector3::z()).norm() < 1e-12, "{n}");
        }
        let inside = normal(&roof, 0, [0.3, 0.3, 0.4], true).unwrap();
        assert!((inside - Vector3::new(0.0, 0.5f64.sqrt(), 0.5f64.sqrt())).norm() < 1e-12);
        let corner = normal(&roof, 0, [1.0, 0.0, 0.0], true).unwrap();
        assert!((corner - Vector3::z()).norm() < 1e-12);
    }

    #[test]
    fn sides_that_are_turned_at_random_agree_first() {
        let roof = [[0, 1, 2], [0, 1, 3]];
        let n = normal(&roof, 0, [0.5, 0.5, 0.0], false).unwrap();
        assert!(
            (n.dot(&Vector3::z()).abs() - 1.0).abs() < 1e-12 || n.dot(&Vector3::y()).abs() > 0.9
        );
        assert_eq!(
            normal(&[[0, 1, 2], [1, 0, 2]], 0, [0.5, 0.5, 0.0], true),
            None
        );
        assert!(normal(&[[0, 1, 2], [1, 0, 2]], 0, [0.5, 0.5, 0.0], false).is_some());
    }

    #[test]
    fn three_walls_at_an_edge_all_count() {
        let walls = [[0, 1, 2], [1, 0, 3], [0, 1, 4]];
        let [a, b, c] = [[0.5, 0.5, 0.0]; 3];
        let normals =
            [(0, a), (1, b), (2, c)].map(|(row, w)| normal(&walls, row, w, true).unwrap());
        assert!((normals[0] - normals[1]).norm() < 1e-12);
        assert!((normals[0] - normals[2]).norm() < 1e-12);
    }
}
