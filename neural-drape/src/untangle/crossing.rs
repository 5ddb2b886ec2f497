//! Pairs of triangles that run through each other and did not at rest.

use mesh_core::{Aabb, Point3, Positions, TriangleBvh, Triangulation, VertexId};
use rayon::prelude::*;
use robust::{orient3d, Coord3D};

/// So many triangles are one piece of parallel work.
const CHUNK: usize = 128;

/// Finds crossings among some triangles, wherever they move.
pub(super) struct Detector<'a> {
    triangulation: &'a Triangulation,
    rest: &'a Positions,
    /// The triangles that are looked at, ascending.
    rows: Vec<u32>,
    bvh: TriangleBvh,
}

impl<'a> Detector<'a> {
    /// Looks at all triangles.
    pub(super) fn new(triangulation: &'a Triangulation, rest: &'a Positions, x: &Positions) -> Self {
        Self {
            triangulation,
            rest,
            rows: (0..triangulation.len() as u32).collect(),
            bvh: TriangleBvh::new(triangulation.corners(x).collect()),
        }
    }

    /// Looks at those triangles only that meet a box at `x`.
    pub(super) fn within(&self, bounds: &Aabb, x: &Positions) -> Self {
        let is_near = |&row: &u32| meets(bounds, &Aabb::of(&self.corners(row, x)));
        let rows = self.rows.iter().copied().filter(is_near);
        let rows: Vec<u32> = rows.collect();
        let corners = rows.iter().map(|&row| self.corners(row, x)).collect();
        Self {
            triangulation: self.triangulation,
            rest: self.rest,
            bvh: TriangleBvh::new(corners),
            rows,
        }
    }

    /// All pairs that cross at `x` and did not at rest.
    pub(super) fn all_crossings(&mut self, x: &Positions) -> Vec<[u32; 2]> {
        let rows = self.rows.clone();
        self.crossings(x, &rows)
    }

    /// The pairs that cross at `x` and did not at rest, of which one at least is in `asked`, ascending: rows of triangles,
    /// the lower first, in order.
    pub(super) fn crossings(&mut self, x: &Positions, asked: &[u32]) -> Vec<[u32; 2]> {
        let (triangulation, rest, rows) = (self.triangulation, self.rest, &self.rows);
        let corners_of = |row: u32, x: &Positions| triangulation.triangles()[row as usize].map(|v| x[v]);
        self.bvh.refit(rows.iter().map(|&row| corners_of(row, x)));
        let bvh = &self.bvh;
        let of = |&one: &u32| {
            let corners = corners_of(one, x);
            let mut pairs = Vec::new();
            bvh.for_each_overlapping(&Aabb::of(&corners), |other| {
                let other = rows[other as usize];
                let is_new = other != one
                    && is_crossing(&corners, &corners_of(other, x))
                    && !is_crossing(&corners_of(one, rest), &corners_of(other, rest));
                if is_new {
                    pairs.push([one.min(other), one.max(other)]);
                }
            });
            pairs
        };
        let pairs: Vec<Vec<[u32; 2]>> = asked.par_iter().with_min_len(CHUNK).map(of).collect();
        let mut pairs = pairs.concat();
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    }

    fn corners(&self, row: u32, x: &Positions) -> [Point3; 3] {
        self.triangulation.triangles()[row as usize].map(|v| x[v])
    }
}

/// The triangles at these vertices, ascending.
pub(super) fn triangles_at(triangulation: &Triangulation, vertices: &[VertexId]) -> Vec<u32> {
    let at = |&v: &VertexId| triangulation.vertex_triangles(v);
    let mut rows: Vec<u32> = vertices.iter().flat_map(at).copied().collect();
    rows.sort_unstable();
    rows.dedup();
    rows
}

fn meets(a: &Aabb, b: &Aabb) -> bool {
    (0..3).all(|k| a.min[k] <= b.max[k] && b.min[k] <= a.max[k])
}

/// Whether an edge of one runs through the inside of the other; touching does not count. The signs are exact.
pub(super) fn is_crossing(s: &[Point3; 3], t: &[Point3; 3]) -> bool {
    let (of_s, of_t) = (s.map(|p| side(t, p)), t.map(|p| side(s, p)));
    let straddles = |sides: &[i8; 3]| sides.contains(&1) && sides.contains(&-1);
    straddles(&of_s) && straddles(&of_t) && (pierces(s, &of_s, t) || pierces(t, &of_t, s))
}

/// Whether an edge of `s`, whose corners lie on these sides of `t`, runs through the inside of `t`.
fn pierces(s: &[Point3; 3], sides: &[i8; 3], &[a, b, c]: &[Point3; 3]) -> bool {
    (0..3).any(|k| {
        let next = (k + 1) % 3;
        sides[k] * sides[next] == -1 && {
            let turn = |from, to| side(&[s[k], s[next], from], to);
            let first = turn(a, b);
            first != 0 && turn(b, c) == first && turn(c, a) == first
        }
    })
}

/// The side of the plane of a triangle that a point is on, exactly: −1, 0 or 1.
fn side(&[a, b, c]: &[Point3; 3], d: Point3) -> i8 {
    if d == a || d == b || d == c {
        return 0;
    }
    let [a, b, c, d] = [a, b, c, d].map(|p| Coord3D {
        x: p.x,
        y: p.y,
        z: p.z,
    });
    let volume = orient3d(a, b, c, d);
    i8::from(volume > 0.0) - i8::from(volume < 0.0)
}
