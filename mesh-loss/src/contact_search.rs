//! Finds what has come near in space and is far along the surface, and which side of each other it belongs on.

use std::sync::Arc;

use mesh_core::bvh::closest_point_on_triangle;
use mesh_core::measure::{triangle_areas, triangle_normal, vertex_normals};
use mesh_core::{
    Aabb, Point3, Positions, TriangleBvh, Triangulation, UnitFrame, Vector3, VertexData, VertexId,
};
use rayon::prelude::*;

use crate::{Contact, ContactPair};

/// Vertex and triangle face each other where the cosine between their normals is below this ...
const FACING: f64 = -0.2;
/// ... or this, where they are far apart at rest: a finger touches a thigh at any angle.
const FACING_OF_FAR: f64 = 0.5;
/// What is farther apart at rest than this share of the longest side is before each other: what lies behind a surface is nearer.
const FAR: f64 = 0.08;
/// A triangle whose nearest point is farther than this, as a cosine, from straight before or behind it says nothing.
const STRAIGHT: f64 = 0.5;
/// At rest, the way between them says which side they belong on where the difference of their normals along it is at least this.
const CLEAR: f64 = 0.6;
/// What is farther from a vertex than so many of its edges is not looked at, but for the gap ...
const OF_EDGE: f64 = 3.0;
/// ... with the square of an edge over the area of an equilateral triangle, 4/√3.
const AREA_OF_EDGE: f64 = 2.309;
/// No gap is larger than this share of the distance at rest.
const OF_REST: f64 = 0.5;
/// So many vertices are one piece of parallel work.
const CHUNK: usize = 256;

/// Finds the pairs of [`Contact`] on a surface, wherever it moves.
///
/// Which side of a triangle a vertex belongs on is told by the shape at rest: before it where they are far apart there or
/// look at each other, behind it where material lies between them. Where a fold has brought neighbours together, it is told
/// by the way the fold is bent; and where nothing tells it, they stay on the side where they are.
pub struct ContactSearch {
    triangulation: Arc<Triangulation>,
    rest: Arc<Positions>,
    rest_normals: VertexData<Vector3>,
    rest_area: f64,
    far: f64,
    bvh: TriangleBvh,
}

/// What one search looks at.
struct Now<'a> {
    x: &'a Positions,
    normals: VertexData<Vector3>,
    /// Lengths now over lengths at rest.
    scale: f64,
    gap: f64,
}

/// A vertex and a triangle whose side is not known yet.
struct Candidate {
    vertex: VertexId,
    triangle: [VertexId; 3],
    /// How far apart at rest, in its lengths.
    apart: f64,
    /// How far apart now, ...
    distance: f64,
    /// ... and how far before the triangle's plane.
    height: f64,
}

impl Candidate {
    fn pair(&self, side: f64, now: &Now<'_>) -> ContactPair {
        ContactPair {
            vertex: self.vertex,
            triangle: self.triangle,
            side,
            gap: now.gap.min(OF_REST * self.apart * now.scale),
            share: 0.0,
        }
    }
}

impl ContactSearch {
    /// A search on a surface with this shape at rest, of any size.
    pub fn new(triangulation: &Arc<Triangulation>, rest: &Arc<Positions>) -> Self {
        Self {
            rest_normals: vertex_normals(triangulation, rest),
            rest_area: triangle_areas(triangulation, rest).iter().sum(),
            far: FAR * UnitFrame::principal(rest.as_slice()).scale,
            bvh: TriangleBvh::new(triangulation.corners(rest).collect()),
            triangulation: Arc::clone(triangulation),
            rest: Arc::clone(rest),
        }
    }

    /// For every vertex the nearest triangle within `reach` and three of its edges that it is to stay before, and the nearest that it is to stay
    /// behind, at least `gap` from them and less where they are nearer at rest. Triangles at a vertex or at its neighbours
    /// do not count.
    pub fn near(&mut self, x: &Positions, gap: f64, reach: f64) -> Contact {
        let triangulation = Arc::clone(&self.triangulation);
        self.bvh.refit(triangulation.corners(x));
        let areas = triangle_areas(&triangulation, x);
        let total = areas.iter().sum::<f64>().max(f64::MIN_POSITIVE);
        let now = Now {
            x,
            normals: vertex_normals(&triangulation, x),
            scale: (total / self.rest_area.max(f64::MIN_POSITIVE)).sqrt(),
            gap,
        };
        let around = |v: VertexId| triangulation.vertex_triangles(v).iter();
        let area = |v: VertexId| around(v).map(|&t| areas[t as usize]).sum::<f64>();
        let share = |v: VertexId| area(v) / (3.0 * total);
        let reach = |v: VertexId| {
            let edge = (AREA_OF_EDGE * area(v) / around(v).len().max(1) as f64).sqrt();
            reach.min((OF_EDGE * edge).max(gap))
        };
        let vertices: Vec<VertexId> = triangulation.used_vertices().collect();
        let found: Vec<[Option<ContactPair>; 2]> = vertices
            .par_iter()
            .with_min_len(CHUNK)
            .map(|&v| self.near_vertex(v, reach(v), &now))
            .collect();
        let pairs = found.into_iter().flatten().flatten();
        let pairs = pairs.map(|pair| ContactPair {
            share: share(pair.vertex),
            ..pair
        });
        Contact {
            pairs: pairs.collect(),
        }
    }

    fn near_vertex(&self, v: VertexId, reach: f64, now: &Now<'_>) -> [Option<ContactPair>; 2] {
        let mut nearest: [Option<(f64, u32, ContactPair)>; 2] = [None, None];
        let bounds = around(&now.x[v], reach);
        self.bvh.for_each_overlapping(&bounds, |row| {
            let Some(candidate) = self.candidate(v, row, now).filter(|c| c.distance <= reach)
            else {
                return;
            };
            let side = self.side(&candidate, now);
            let best = &mut nearest[usize::from(side < 0.0)];
            // Equally near ones are told apart by their rows, whatever order they come in.
            let (distance, pair) = (candidate.distance, candidate.pair(side, now));
            if best.is_none_or(|(least, at, _)| (distance, row) < (least, at)) {
                *best = Some((distance, row, pair));
            }
        });
        nearest.map(|best| best.map(|(_, _, pair)| pair))
    }

    /// A vertex and a triangle that face each other; none where it is a corner, too far or turned away.
    fn candidate(&self, vertex: VertexId, row: u32, now: &Now<'_>) -> Option<Candidate> {
        let triangle = self.triangulation.triangles()[row as usize];
        let around = self.triangulation.vertex_neighbours(vertex);
        let is_neighbour = |w: &VertexId| *w == vertex || around.binary_search(w).is_ok();
        if triangle.iter().any(is_neighbour) {
            return None;
        }
        let corners = triangle.map(|w| now.x[w]);
        let normal = triangle_normal(corners)?;
        let agreement = normal.dot(&now.normals[vertex]);
        if agreement > FACING_OF_FAR {
            return None;
        }
        let at = closest_point_on_triangle(&now.x[vertex], &corners);
        let distance = at.distance_squared.sqrt();
        let height = (now.x[vertex] - at.point(&corners)).dot(&normal);
        if height.abs() < STRAIGHT * distance {
            return None;
        }
        let apart = self.apart_at_rest(vertex, &triangle);
        (apart > self.far || agreement <= FACING).then_some(Candidate {
            vertex,
            triangle,
            apart,
            distance,
            height,
        })
    }

    fn apart_at_rest(&self, v: VertexId, triangle: &[VertexId; 3]) -> f64 {
        let corners = triangle.map(|w| self.rest[w]);
        let at = closest_point_on_triangle(&self.rest[v], &corners);
        at.distance_squared.sqrt()
    }

    /// 1 where the vertex belongs before the triangle, −1 where it belongs behind it.
    fn side(&self, pair: &Candidate, now: &Now<'_>) -> f64 {
        if pair.apart > self.far {
            return 1.0;
        }
        if let Some(rise) = self.rise_of_fold(pair, now) {
            return sign(rise);
        }
        let corners = pair.triangle.map(|w| self.rest[w]);
        let between = self.rest[pair.vertex] - middle(corners);
        let turn = triangle_normal(corners).unwrap_or_default() - self.rest_normals[pair.vertex];
        let before = between.dot(&turn);
        let is_clear = before.abs() >= CLEAR * between.norm();
        sign(if is_clear { before } else { pair.height })
    }

    /// How far the walls of a fold rise over the neighbours that both have in common: a valley's more than 0, a ridge's less.
    fn rise_of_fold(&self, pair: &Candidate, now: &Now<'_>) -> Option<f64> {
        let neighbours = |v: VertexId| self.triangulation.vertex_neighbours(v);
        let is_common = |w: &&VertexId| {
            let beyond = neighbours(**w);
            pair.triangle
                .iter()
                .any(|c| beyond.binary_search(c).is_ok())
        };
        let wall = middle(pair.triangle.map(|w| now.x[w]));
        let walls = nalgebra::center(&now.x[pair.vertex], &wall);
        let common = neighbours(pair.vertex).iter().filter(is_common);
        let rises = common.map(|&w| (walls - now.x[w]).dot(&now.normals[w]));
        rises.reduce(|sum, rise| sum + rise)
    }
}

fn sign(value: f64) -> f64 {
    if value < 0.0 {
        -1.0
    } else {
        1.0
    }
}

fn middle([a, b, c]: [Point3; 3]) -> Point3 {
    Point3::from((a.coords + b.coords + c.coords) / 3.0)
}

fn around(p: &Point3, reach: f64) -> Aabb {
    let by = Vector3::repeat(reach);
    Aabb {
        min: p - by,
        max: p + by,
    }
}

#[cfg(test)]
mod tests {
    use mesh_core::{shapes, PolygonSoup};

    use super::*;
    use crate::Loss;

    /// Two sheets of the unit square at these heights; the second is turned over if it looks down.
    fn sheets(heights: [f64; 2], looks_down: [bool; 2]) -> (Arc<Triangulation>, Arc<Positions>) {
        let sheet = shapes::open_grid(12, 12);
        let n = sheet.positions.len() as u32;
        let bounds = Aabb::of(&sheet.positions);
        let size = bounds.longest_side();
        let mut both = PolygonSoup::default();
        for (k, (height, looks_down)) in (0..).zip(heights.into_iter().zip(looks_down)) {
            let at = |p: &Point3| Point3::new(p.x / size, p.y / size, height);
            both.positions.extend(sheet.positions.iter().map(at));
            for f in &sheet.faces {
                let mut face: Vec<u32> = f.iter().map(|v| v + k * n).collect();
                if looks_down {
                    face.reverse();
                }
                both.faces.push(face);
            }
        }
        let (mesh, x) = both.into_halfedge().unwrap();
        (Arc::new(Triangulation::new(&mesh, &x)), Arc::new(x))
    }

    /// Heights, over that of the lower sheet, by which the upper is pushed: the sum of −dL/dz.
    fn push(rest: f64, now: f64, looks_down: [bool; 2]) -> (f64, usize) {
        let (triangulation, rest) = sheets([0.0, rest], looks_down);
        let (_, x) = sheets([0.0, now], looks_down);
        let contact = ContactSearch::new(&triangulation, &rest).near(&x, 0.02, 0.1);
        let mut gradient = VertexData::new(x.len(), Vector3::zeros());
        contact.accumulate(&x, 1.0, &mut gradient);
        let half = x.len() / 2;
        let upper = gradient.iter().skip(half);
        (upper.map(|g| -g.z).sum(), contact.pairs.len())
    }

    #[test]
    fn what_faced_each_other_is_parted_whether_it_came_near_or_passed() {
        for now in [0.01, 0.0025, -0.01] {
            let (up, n) = push(0.5, now, [false, true]);
            assert!(up > 0.1 && n > 0, "{now}: {up}");
        }
        assert_eq!(push(0.5, 0.03, [false, true]).0, 0.0);
    }

    #[test]
    fn walls_with_material_between_them_stay_in_their_order() {
        // The upper looks up, the lower down: a plate of thickness 0.06.
        for now in [0.01, -0.01] {
            let (up, _) = push(0.06, now, [true, false]);
            assert!(up > 0.1, "{now}: {up}");
        }
    }

    #[test]
    fn a_gap_is_no_wider_than_half_of_that_at_rest() {
        let (triangulation, rest) = sheets([0.0, 0.01], [false, true]);
        let mut search = ContactSearch::new(&triangulation, &rest);
        let contact = search.near(&rest, 0.02, 0.1);
        assert!(!contact.pairs.is_empty());
        assert!(contact.pairs.iter().all(|p| (p.gap - 0.005).abs() < 1e-9));
        let mut gradient = VertexData::new(rest.len(), Vector3::zeros());
        assert_eq!(contact.accumulate(&rest, 1.0, &mut gradient), 0.0);
    }

    #[test]
    fn a_smooth_surface_has_no_pairs() {
        let (mesh, rest) = shapes::quad_sphere(12).into_halfedge().unwrap();
        let triangulation = Arc::new(Triangulation::new(&mesh, &rest));
        let rest = Arc::new(rest);
        let contact = ContactSearch::new(&triangulation, &rest).near(&rest, 0.1, 0.3);
        assert_eq!(contact.pairs, []);
    }
}
