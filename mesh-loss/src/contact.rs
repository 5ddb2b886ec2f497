//! Parts of the surface that are near in space and far along it keep a gap.

use mesh_core::bvh::closest_point_on_triangle;
use mesh_core::{
    Aabb, Point3, Positions, TriangleBvh, Triangulation, Vector3, VertexData, VertexId,
};
use rayon::prelude::*;

use crate::Loss;

/// A distance below this share of the gap counts as this: the barrier and its slope stay finite.
const LEAST: f64 = 1e-3;

/// A barrier between vertices and triangles that are nearer than a gap, and not so at rest.
///
/// `1/N Σ b(d)/d̂²` over pairs, `b(d) = −(d − d̂)² ln(d/d̂)` for `d < d̂` and 0 beyond, with the distance d of a vertex from
/// a triangle and the gap d̂
///
/// Units: none; ≥ 0, and 0 where all pairs are at least d̂ apart; invariant to rigid motion. At d = 0, where the barrier is
/// infinite, its value is that at d̂/1000 and its gradient 0: which way to part is not told by the distance.
/// Source: Li et al. 2020, "Incremental Potential Contact", Eq. 6. Departures: distances instead of their squares; a mean
/// over vertices, without the stiffness that adapts; vertices and triangles only, no pairs of edges; pairs that are found
/// once and held until they are sought again. Beyond the paper.
#[derive(Clone, Debug)]
pub struct Contact {
    pairs: Vec<ContactPair>,
    gap: f64,
    near_at_rest: Vec<VertexId>,
}

/// A vertex and a triangle that are near in space and far along the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ContactPair {
    /// The vertex.
    pub vertex: VertexId,
    /// The corners of the triangle.
    pub triangle: [VertexId; 3],
}

/// A surface at rest and now.
#[derive(Clone, Copy)]
pub struct ContactInput<'a> {
    /// The surface.
    pub triangulation: &'a Triangulation,
    /// Where its vertices are at rest, in the size that it has now: distances of both are compared.
    pub rest: &'a Positions,
    /// Where they are.
    pub x: &'a Positions,
}

impl ContactPair {
    /// The distance at `x` and the weights of the corners at the closest point.
    fn measure(&self, x: &Positions) -> (f64, [f64; 3], Vector3) {
        let corners = self.triangle.map(|v| x[v]);
        let at = closest_point_on_triangle(&x[self.vertex], &corners);
        let offset = x[self.vertex] - at.point(&corners);
        (at.distance_squared.sqrt(), at.barycentric, offset)
    }
}

impl Contact {
    /// The pairs that are nearer than `reach` at `x`, which is to be at least `gap`: what may come nearer than the gap before
    /// pairs are sought again.
    ///
    /// Left out are triangles at a vertex or at its neighbours, and pairs nearer than the gap at rest.
    pub fn near(input: ContactInput<'_>, gap: f64, reach: f64) -> Self {
        let ContactInput {
            triangulation,
            rest,
            x,
        } = input;
        let bvh = TriangleBvh::new(triangulation.corners(x).collect());
        let of_vertex = |v: VertexId| -> (Vec<ContactPair>, bool) {
            let mut rows = Vec::new();
            bvh.for_each_overlapping(&around(&x[v], reach), |row| rows.push(row));
            rows.sort_unstable();
            let pair = |row: u32| ContactPair {
                vertex: v,
                triangle: triangulation.triangles()[row as usize],
            };
            let is_apart = |pair: &ContactPair| {
                let near = triangulation.vertex_neighbours(v);
                let is_near = |w: &VertexId| *w == v || near.binary_search(w).is_ok();
                !pair.triangle.iter().any(is_near) && pair.measure(x).0 < reach
            };
            let pairs = rows.into_iter().map(pair).filter(is_apart);
            let (kept, left_out): (Vec<_>, Vec<_>) =
                pairs.partition(|pair| pair.measure(rest).0 >= gap);
            (kept, !left_out.is_empty())
        };
        let vertices: Vec<VertexId> = triangulation.used_vertices().collect();
        let found: Vec<_> = vertices.par_iter().map(|&v| of_vertex(v)).collect();
        let near_at_rest = vertices.iter().zip(&found);
        let near_at_rest = near_at_rest.filter(|(_, (_, is_near))| *is_near);
        Self {
            near_at_rest: near_at_rest.map(|(&v, _)| v).collect(),
            pairs: found.into_iter().flat_map(|(pairs, _)| pairs).collect(),
            gap,
        }
    }

    /// The pairs, by their vertices and then by the rows of their triangles.
    pub fn pairs(&self) -> &[ContactPair] {
        &self.pairs
    }

    /// Vertices with a triangle that is near now and was nearer than the gap at rest; ascending. Such pairs are left out.
    pub fn near_at_rest(&self) -> &[VertexId] {
        &self.near_at_rest
    }
}

fn around(p: &Point3, reach: f64) -> Aabb {
    let by = Vector3::repeat(reach);
    Aabb {
        min: p - by,
        max: p + by,
    }
}

impl Loss for Contact {
    fn accumulate(&self, x: &Positions, weight: f64, grad: &mut VertexData<Vector3>) -> f64 {
        let share = 1.0 / x.len().max(1) as f64;
        let mut sum = 0.0;
        for pair in &self.pairs {
            let (distance, barycentric, offset) = pair.measure(x);
            let t = distance / self.gap;
            if t >= 1.0 {
                continue;
            }
            // With t = d/d̂: b/d̂² = −(t − 1)² ln t, and its slope in t.
            let (barrier, slope) = barrier(t.max(LEAST));
            sum += barrier;
            if t > LEAST {
                let g = offset * (weight * share * slope / (self.gap * distance));
                grad[pair.vertex] += g;
                for (&v, w) in pair.triangle.iter().zip(barycentric) {
                    grad[v] -= g * w;
                }
            }
        }
        sum * share
    }
}

/// `−(t − 1)² ln t` and its derivative.
fn barrier(t: f64) -> (f64, f64) {
    let (left, log) = (t - 1.0, t.ln());
    (-left * left * log, -2.0 * left * log - left * left / t)
}

#[cfg(test)]
mod tests {
    use mesh_core::{shapes, PolygonSoup};

    use super::*;

    /// Two sheets at these heights, one above the other.
    fn sheets(heights: [f64; 2]) -> (Triangulation, Positions) {
        let sheet = shapes::open_grid(6, 6);
        let n = sheet.positions.len() as u32;
        let mut both = PolygonSoup::default();
        for (k, height) in (0..).zip(heights) {
            let lifted = sheet.positions.iter();
            let lifted = lifted.map(|p| Point3::new(p.x, p.y, height));
            both.positions.extend(lifted);
            let faces = sheet.faces.iter();
            let moved = |f: &Vec<u32>| f.iter().map(|v| v + k * n).collect::<Vec<_>>();
            both.faces.extend(faces.map(moved));
        }
        let (mesh, x) = both.into_halfedge().unwrap();
        (Triangulation::new(&mesh, &x), x)
    }

    #[test]
    fn sheets_that_came_near_are_pressed_apart() {
        let (triangulation, rest) = sheets([0.0, 1.0]);
        let (_, x) = sheets([0.0, 0.05]);
        let input = ContactInput {
            triangulation: &triangulation,
            rest: &rest,
            x: &x,
        };
        let contact = Contact::near(input, 0.1, 0.15);
        assert!(contact.near_at_rest().is_empty());
        let mut gradient = VertexData::new(x.len(), Vector3::zeros());
        let value = contact.accumulate(&x, 1.0, &mut gradient);
        // Every vertex has pairs at half the gap: −(½ − 1)² ln ½ each.
        let each = 0.25 * 2f64.ln();
        let expected = each * contact.pairs().len() as f64 / x.len() as f64;
        assert!((value - expected).abs() < 1e-12);
        let n = x.len() / 2;
        for (row, g) in gradient.iter().enumerate() {
            assert!(if row < n { g.z > 0.0 } else { g.z < 0.0 }, "{row}: {g}");
        }
        let (_, apart) = sheets([0.0, 0.1]);
        assert_eq!(contact.accumulate(&apart, 1.0, &mut gradient), 0.0);
    }

    #[test]
    fn pairs_that_are_near_at_rest_are_left_out_and_named() {
        let (triangulation, rest) = sheets([0.0, 0.05]);
        let input = ContactInput {
            triangulation: &triangulation,
            rest: &rest,
            x: &rest,
        };
        let contact = Contact::near(input, 0.1, 0.15);
        assert!(contact
            .pairs()
            .iter()
            .all(|pair| pair.measure(&rest).0 >= 0.1));
        assert_eq!(contact.near_at_rest().len(), rest.len());
    }

    #[test]
    fn surfaces_that_touch_stay_finite() {
        let (triangulation, rest) = sheets([0.0, 1.0]);
        let (_, x) = sheets([0.0, 0.0]);
        let input = ContactInput {
            triangulation: &triangulation,
            rest: &rest,
            x: &x,
        };
        let contact = Contact::near(input, 0.1, 0.15);
        let mut gradient = VertexData::new(x.len(), Vector3::zeros());
        assert!(contact.accumulate(&x, 1.0, &mut gradient).is_finite());
        assert!(gradient.iter().all(|g| g.norm().is_finite()));
    }
}
