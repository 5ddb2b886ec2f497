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
/// At rest, the way between them says which side they belong on where its cosine with their normals is at least this.
const CLEAR: f64 = 0.3;
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
        self.bvh
            .for_each_overlapping(&around(&now.x[v], now.reach), |row| {
                let Some((distance, pair)) = self.pair(v, row, now) else {
                    return;
                };
                let best = &mut nearest[usize::from(pair.side < 0.0)];
                // Equally near ones are told apart by their rows, whatever order they come in.
                let is_nearer = best.is_none_or(|(least, at, _)| (distance, row) < (least, at));
                if is_nearer {
                    *best = Some((distance, row, pair));
                }
            });
        nearest.map(|best| best.map(|(_, _, pair)| pair))
    }

    /// The pair of a vertex and a triangle, and how far apart they are; none where they are neighbours, too far or do not
    /// face each other.
    fn pair(&self, v: VertexId, row: u32, now: &Now<'_>) -> Option<(f64, ContactPair)> {
        let triangle = self.triangulation.triangles()[row as usize];
        let around = self.triangulation.vertex_neighbours(v);
        let is_neighbour = |w: &VertexId| *w == v || around.binary_search(w).is_ok();
        if triangle.iter().any(is_neighbour) {
            return None;
        }
        let corners = triangle.map(|w| now.x[w]);
        let normal = triangle_normal(corners)?;
        let agreement = normal.dot(&now.normals[v]);
        if agreement > FACING_OF_FAR {
            return None;
        }
        let at = closest_point_on_triangle(&now.x[v], &corners);
        let distance = at.distance_squared.sqrt();
        let height = (now.x[v] - at.point(&corners)).dot(&normal);
        if distance > now.reach || height.abs() < STRAIGHT * distance {
            return None;
        }
        let apart = self.apart_at_rest(v, &triangle);
        if apart <= self.far && agreement > FACING {
            return None;
        }
        let side = self.side(v, &triangle, (apart, height), now);
        let pair = ContactPair {
            vertex: v,
            triangle,
            side,
            gap: now.gap.min(OF_REST * apart * now.scale),
            share: 0.0,
        };
        Some((distance, pair))
    }

    fn apart_at_rest(&self, v: VertexId, triangle: &[VertexId; 3]) -> f64 {
        let corners = triangle.map(|w| self.rest[w]);
        let at = closest_point_on_triangle(&self.rest[v], &corners);
        at.distance_squared.sqrt()
    }

    /// 1 where the vertex belongs before the triangle, −1 where it belongs behind it, `apart` at rest and `height` before
    /// its plane now.
    fn side(
        &self,
        v: VertexId,
        triangle: &[VertexId; 3],
        (apart, height): (f64, f64),
        now: &Now<'_>,
    ) -> f64 {
        if apart > self.far {
            return 1.0;
        }
        if let Some(side) = self.side_of_fold(v, triangle, now) {
            return side;
        }
        let corners = triangle.map(|w| self.rest[w]);
        let between = self.rest[v] - middle(corners);
        let turn = triangle_normal(corners).unwrap_or_default() - self.rest_normals[v];
        let before = between.dot(&turn);
        if before.abs() >= CLEAR * 2.0 * between.norm() {
            before.signum()
        } else {
            height.signum()
        }
    }

    /// Which way a fold over common neighbours is bent: walls of a valley belong before each other, those of a ridge behind.
    fn side_of_fold(&self, v: VertexId, triangle: &[VertexId; 3], now: &Now<'_>) -> Option<f64> {
        let around = self.triangulation.vertex_neighbours(v);
        let is_between = |w: &&VertexId| {
            let beyond = self.triangulation.vertex_neighbours(**w);
            triangle.iter().any(|c| beyond.binary_search(c).is_ok())
        };
        let walls = nalgebra::center(&now.x[v], &middle(triangle.map(|w| now.x[w])));
        let bottoms = around.iter().filter(is_between);
        let rise: Vec<f64> = bottoms
            .map(|&w| (walls - now.x[w]).dot(&now.normals[w]))
            .collect();
        let rise = if rise.is_empty() { return None } else { rise.iter().sum::<f64>() };
        Some(if rise < 0.0 { -1.0 } else { 1.0 })
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
