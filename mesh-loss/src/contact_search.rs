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
const CLEAR: f64 = 1.2;
/// A fold is looked for over so many edges.
const RINGS: usize = 5;
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
    reach: f64,
}

/// A vertex and a triangle whose side is not known yet.
struct Candidate {
    vertex: VertexId,
    triangle: [VertexId; 3],
    /// How far apart at rest, in its lengths.
    apart: f64,
    /// How far apart now.
    distance: f64,
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

fn knob(name: &str, value: f64) -> f64 {
    use std::collections::BTreeMap;
    use std::sync::OnceLock;
    static ALL: OnceLock<BTreeMap<String, f64>> = OnceLock::new();
    let all = ALL.get_or_init(|| std::env::vars().filter_map(|(k, v)| Some((k.strip_prefix("K_")?.to_owned(), v.parse().ok()?))).collect());
    all.get(name).copied().unwrap_or(value)
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

    /// For every vertex the nearest triangle within `reach` that it is to stay before, and the nearest that it is to stay
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
            reach,
        };
        let share = |v: VertexId| {
            let around = triangulation.vertex_triangles(v).iter();
            around.map(|&t| areas[t as usize]).sum::<f64>() / (3.0 * total)
        };
        let vertices: Vec<VertexId> = triangulation.used_vertices().collect();
        let found: Vec<[Option<ContactPair>; 2]> = vertices
            .par_iter()
            .with_min_len(CHUNK)
            .map(|&v| self.near_vertex(v, &now))
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

    fn near_vertex(&self, v: VertexId, now: &Now<'_>) -> [Option<ContactPair>; 2] {
        let mut nearest: [Option<(f64, u32, ContactPair)>; 2] = [None, None];
        let mut tree = None;
        let bounds = around(&now.x[v], now.reach);
        self.bvh.for_each_overlapping(&bounds, |row| {
            let Some(candidate) = self.candidate(v, row, now) else {
                return;
            };
            let Some(side) = self.side(&candidate, now, &mut tree) else {
                return;
            };
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
        if triangle.contains(&vertex) {
            return None;
        }
        if knob("RING", 0.0) > 0.0 && triangle.iter().any(|w| self.triangulation.vertex_neighbours(vertex).binary_search(w).is_ok()) {
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
        if distance > now.reach || height.abs() < STRAIGHT * distance {
            return None;
        }
        let apart = self.apart_at_rest(vertex, &triangle);
        (apart > self.far || agreement <= knob("FACING", FACING)).then_some(Candidate {
            vertex,
            triangle,
            apart,
            distance,
        })
    }

    fn apart_at_rest(&self, v: VertexId, triangle: &[VertexId; 3]) -> f64 {
        let corners = triangle.map(|w| self.rest[w]);
        let at = closest_point_on_triangle(&self.rest[v], &corners);
        at.distance_squared.sqrt()
    }

    /// 1 where the vertex belongs before the triangle, −1 where it belongs behind it; none where nothing tells it.
    fn side(&self, pair: &Candidate, now: &Now<'_>, tree: &mut Option<Tree>) -> Option<f64> {
        if pair.apart > self.far {
            return Some(1.0);
        }
        let corners = pair.triangle.map(|w| self.rest[w]);
        let between = self.rest[pair.vertex] - middle(corners);
        let turn = triangle_normal(corners).unwrap_or_default() - self.rest_normals[pair.vertex];
        let before = between.dot(&turn);
        if before.abs() >= knob("CLEAR", CLEAR) * between.norm() {
            return Some(before.signum());
        }
        let tree = tree.get_or_insert_with(|| Tree::new(&self.triangulation, pair.vertex));
        let walls = nalgebra::center(
            &now.x[pair.vertex],
            &middle(pair.triangle.map(|w| now.x[w])),
        );
        let way = tree.way_to(pair.triangle)?;
        let rise: f64 = way.map(|w| (walls - now.x[w]).dot(&now.normals[w])).sum();
        (rise != 0.0).then_some(rise.signum())
    }
}

/// Vertices within a few edges of one, each with the row of the one before it on the way; the first is its own.
struct Tree(Vec<(VertexId, usize)>);

impl Tree {
    fn new(triangulation: &Triangulation, root: VertexId) -> Self {
        let mut reached = vec![(root, 0)];
        let mut from = 0;
        for _ in 0..RINGS {
            let to = reached.len();
            for row in from..to {
                for &w in triangulation.vertex_neighbours(reached[row].0) {
                    if reached.iter().all(|(v, _)| *v != w) {
                        reached.push((w, row));
                    }
                }
            }
            from = to;
        }
        Self(reached)
    }

    /// The vertices on the way to the nearest corner of a triangle, without the ends unless they are all; none where it is
    /// out of reach.
    fn way_to(&self, triangle: [VertexId; 3]) -> Option<impl Iterator<Item = VertexId> + '_> {
        let mut row = self.0.iter().position(|(v, _)| triangle.contains(v))?;
        let mut way = Vec::new();
        while row != 0 {
            way.push(self.0[row].0);
            row = self.0[row].1;
        }
        let first = usize::from(way.len() > 1);
        Some(way.into_iter().skip(first))
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
