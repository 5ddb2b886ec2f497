//! Pairs of triangles that run through each other and did not at rest.

use mesh_core::{Aabb, Point3, Positions, TriangleBvh, Triangulation, VertexId};
use rayon::prelude::*;
use robust::{orient3d, Coord3D};

/// So many triangles are one piece of parallel work.
const CHUNK: usize = 128;

/// A surface that may run through itself only where it does at rest.
#[derive(Clone, Copy)]
pub(crate) struct Ground<'a> {
    pub(crate) triangulation: &'a Triangulation,
    pub(crate) rest: &'a Positions,
}

impl Ground<'_> {
    fn corners(&self, row: u32, x: &Positions) -> [Point3; 3] {
        self.triangulation.triangles()[row as usize].map(|v| x[v])
    }

    /// Whether two triangles cross at `x` and did not at rest.
    fn is_new(&self, one: u32, other: u32, x: &Positions) -> bool {
        let [s, t] = [one, other].map(|row| self.triangulation.triangles()[row as usize]);
        // Triangles over an edge have no room to cross.
        if s.iter().filter(|v| t.contains(v)).count() > 1 {
            return false;
        }
        let is_crossing =
            |x: &Positions| is_crossing(&self.corners(one, x), &self.corners(other, x));
        is_crossing(x) && !is_crossing(self.rest)
    }
}

/// Finds crossings among some triangles, wherever they move.
#[derive(Clone, Debug)]
pub(crate) struct Detector {
    /// The triangles that are looked at, ascending.
    rows: Vec<u32>,
    bvh: TriangleBvh,
}

impl Detector {
    /// Looks at these triangles, ascending.
    pub(crate) fn of(ground: Ground<'_>, x: &Positions, rows: Vec<u32>) -> Self {
        let corners = rows.iter().map(|&row| ground.corners(row, x)).collect();
        Self {
            bvh: TriangleBvh::new(corners),
            rows,
        }
    }

    /// Looks at all triangles.
    pub(crate) fn new(ground: Ground<'_>, x: &Positions) -> Self {
        Self::of(ground, x, (0..ground.triangulation.len() as u32).collect())
    }

    /// Looks at those of its triangles only that meet a box at `x`.
    pub(super) fn within(&self, ground: Ground<'_>, bounds: &Aabb, x: &Positions) -> Self {
        let is_near = |&row: &u32| meets(bounds, &Aabb::of(&ground.corners(row, x)));
        let rows = self.rows.iter().copied().filter(is_near);
        Self::of(ground, x, rows.collect())
    }

    /// All pairs that cross at `x` and did not at rest.
    pub(crate) fn all_crossings(&mut self, ground: Ground<'_>, x: &Positions) -> Vec<[u32; 2]> {
        let rows = self.rows.clone();
        self.crossings(ground, x, &rows)
    }

    /// The pairs that cross at `x` and did not at rest, of which one at least is in `asked`, ascending: rows of triangles,
    /// the lower first, in order.
    pub(super) fn crossings(
        &mut self,
        ground: Ground<'_>,
        x: &Positions,
        asked: &[u32],
    ) -> Vec<[u32; 2]> {
        let rows = &self.rows;
        self.bvh
            .refit(rows.iter().map(|&row| ground.corners(row, x)));
        let bvh = &self.bvh;
        let of = |&one: &u32| {
            let mut pairs = Vec::new();
            bvh.for_each_overlapping(&Aabb::of(&ground.corners(one, x)), |other| {
                let other = rows[other as usize];
                if other != one && ground.is_new(one, other, x) {
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
    let of_s = s.map(|p| side(t, p));
    if !is_straddling(&of_s) {
        return false;
    }
    let of_t = t.map(|p| side(s, p));
    is_straddling(&of_t) && (pierces(s, &of_s, t) || pierces(t, &of_t, s))
}

fn is_straddling(sides: &[i8; 3]) -> bool {
    sides.contains(&1) && sides.contains(&-1)
}

/// The edges of `s` that run through the inside of `t`, each by its first corner.
pub(super) fn pierced_edges(s: &[Point3; 3], t: &[Point3; 3]) -> Vec<usize> {
    let sides = s.map(|p| side(t, p));
    (0..3).filter(|&k| is_piercing(s, &sides, k, t)).collect()
}

/// Whether an edge of `s`, whose corners lie on these sides of `t`, runs through the inside of `t`.
fn pierces(s: &[Point3; 3], sides: &[i8; 3], t: &[Point3; 3]) -> bool {
    (0..3).any(|k| is_piercing(s, sides, k, t))
}

fn is_piercing(s: &[Point3; 3], sides: &[i8; 3], k: usize, &[a, b, c]: &[Point3; 3]) -> bool {
    let next = (k + 1) % 3;
    sides[k] * sides[next] == -1 && {
        let turn = |from, to| side(&[s[k], s[next], from], to);
        let first = turn(a, b);
        first != 0 && turn(b, c) == first && turn(c, a) == first
    }
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
