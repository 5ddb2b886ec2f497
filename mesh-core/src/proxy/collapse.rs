//! Fewer vertices: edges of triangles collapse onto one of their ends, the least harmful first.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use nalgebra::{Matrix4, Vector4};

use crate::measure::{area_vector, triangle_quality};
use crate::Point3;

/// Weight of an edge's squared length beside the squared distance from the planes that it leaves: the higher, the more
/// even the triangles.
const EVENNESS: f64 = 0.05;
/// A collapse must not turn the normal of a triangle farther than this cosine.
const MIN_TURN: f64 = 0.3;
/// Nor leave a triangle of a quality (Eq. 4) below this, unless it was as bad before.
const MIN_QUALITY: f64 = 0.15;

/// Triangles of which vertices are taken away one by one; those that stay do not move.
pub(super) struct Collapse<'a> {
    points: &'a [Point3],
    triangles: Vec<[u32; 3]>,
    is_alive: Vec<bool>,
    /// The living triangles at each vertex.
    around: Vec<Vec<u32>>,
    quadrics: Vec<Matrix4<f64>>,
    is_kept: Vec<bool>,
    /// How many came to each vertex, so that its candidates from before are known as such.
    changes: Vec<u32>,
    /// The vertex onto which each went; itself where it stayed.
    went_to: Vec<u32>,
    queue: BinaryHeap<Reverse<Candidate>>,
}

/// A vertex and the neighbour onto which it could go. Sorted by cost; costs are not negative, so their bits sort as they
/// do.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Candidate {
    cost: u64,
    from: u32,
    to: u32,
    changes: u32,
}

impl<'a> Collapse<'a> {
    pub(super) fn new(points: &'a [Point3], triangles: &[[u32; 3]], is_kept: Vec<bool>) -> Self {
        let mut around = vec![Vec::new(); points.len()];
        let mut quadrics = vec![Matrix4::zeros(); points.len()];
        for (t, corners) in triangles.iter().enumerate() {
            let quadric = plane_quadric(corners.map(|v| points[v as usize]));
            for &v in corners {
                around[v as usize].push(t as u32);
                quadrics[v as usize] += quadric;
            }
        }
        let mut collapse = Self {
            points,
            is_alive: vec![true; triangles.len()],
            triangles: triangles.to_vec(),
            around,
            quadrics,
            is_kept,
            changes: vec![0; points.len()],
            went_to: (0..points.len() as u32).collect(),
            queue: BinaryHeap::new(),
        };
        for v in 0..points.len() as u32 {
            collapse.offer(v);
        }
        collapse
    }

    /// Collapses until `n` of the vertices that triangles use are left, or none can go.
    pub(super) fn run(&mut self, n: usize) {
        let mut left = self.around.iter().filter(|a| !a.is_empty()).count();
        while left > n {
            let Some(Reverse(next)) = self.queue.pop() else {
                break;
            };
            let is_current = next.changes == self.changes[next.from as usize]
                && !self.around[next.from as usize].is_empty();
            if is_current && self.is_allowed(next.from, next.to) {
                self.collapse(next.from, next.to);
                left -= 1;
            }
        }
    }

    /// The triangles that are left.
    pub(super) fn triangles(&self) -> Vec<[u32; 3]> {
        let alive = self.triangles.iter().zip(&self.is_alive);
        alive.filter(|(_, &a)| a).map(|(&t, _)| t).collect()
    }

    /// The vertex that each came to in the end.
    pub(super) fn ends(mut self) -> Vec<u32> {
        for v in 0..self.went_to.len() {
            let mut end = v as u32;
            while self.went_to[end as usize] != end {
                end = self.went_to[end as usize];
            }
            self.went_to[v] = end;
        }
        self.went_to
    }

    fn neighbours(&self, v: u32) -> Vec<u32> {
        let around = self.around[v as usize].iter();
        let mut all: Vec<u32> = around.flat_map(|&t| self.triangles[t as usize]).collect();
        all.retain(|&w| w != v);
        all.sort_unstable();
        all.dedup();
        all
    }

    /// Puts the ways in which `v` could go into the queue.
    fn offer(&mut self, v: u32) {
        for w in self.neighbours(v) {
            self.offer_one(v, w);
        }
    }

    fn offer_one(&mut self, from: u32, to: u32) {
        if self.is_kept[from as usize] {
            return;
        }
        let p = self.points[to as usize];
        let quadric = &self.quadrics[from as usize];
        let h = Vector4::new(p.x, p.y, p.z, 1.0);
        let length = (p - self.points[from as usize]).norm_squared();
        // The quadrics weigh by area: so does the length.
        let cost = (h.dot(&(quadric * h))).max(0.0) + EVENNESS * length * weight(quadric);
        self.queue.push(Reverse(Candidate {
            cost: cost.to_bits(),
            from,
            to,
            changes: self.changes[from as usize],
        }));
    }

    /// The surface stays a surface of the same kind, and no triangle turns over or gets thin.
    fn is_allowed(&self, from: u32, to: u32) -> bool {
        let (mine, theirs) = (self.neighbours(from), self.neighbours(to));
        let n_shared = mine
            .iter()
            .filter(|v| theirs.binary_search(v).is_ok())
            .count();
        let n_at_edge = self.n_between(from, to);
        let is_open = mine.iter().any(|&w| self.n_between(from, w) != 2);
        if n_shared != n_at_edge || n_at_edge == 0 || n_at_edge > 2 || is_open && n_at_edge != 1 {
            return false;
        }
        let stays = |t: &&u32| !self.triangles[**t as usize].contains(&to);
        let around = self.around[from as usize].iter().filter(stays);
        let mut moved = around.map(|&t| {
            let before = self.triangles[t as usize];
            let after = before.map(|v| if v == from { to } else { v });
            [before, after].map(|t| t.map(|v| self.points[v as usize]))
        });
        moved.all(|[before, after]| is_sound(before, after))
    }

    /// How many triangles have both vertices.
    fn n_between(&self, v: u32, w: u32) -> usize {
        let around = self.around[v as usize].iter();
        around
            .filter(|&&t| self.triangles[t as usize].contains(&w))
            .count()
    }

    fn collapse(&mut self, from: u32, to: u32) {
        let touched = self.neighbours(from);
        for t in std::mem::take(&mut self.around[from as usize]) {
            let corners = self.triangles[t as usize];
            if corners.contains(&to) {
                self.is_alive[t as usize] = false;
                for v in corners {
                    self.around[v as usize].retain(|&other| other != t);
                }
            } else {
                self.triangles[t as usize] = corners.map(|v| if v == from { to } else { v });
                self.around[to as usize].push(t);
            }
        }
        self.went_to[from as usize] = to;
        let quadric = self.quadrics[from as usize];
        self.quadrics[to as usize] += quadric;
        self.changes[to as usize] += 1;
        self.offer(to);
        for v in touched.into_iter().filter(|&v| v != to) {
            self.offer_one(v, to);
        }
    }
}

/// `A p pᵀ` with the plane p = (n, −n·a) of a triangle of area A: its value at a point is A times the squared distance.
fn plane_quadric([a, b, c]: [Point3; 3]) -> Matrix4<f64> {
    let doubled = area_vector([a, b, c]);
    let length = doubled.norm();
    if length <= f64::MIN_POSITIVE {
        return Matrix4::zeros();
    }
    let n = doubled / length;
    let p = Vector4::new(n.x, n.y, n.z, -n.dot(&a.coords));
    p * p.transpose() * (0.5 * length)
}

/// The area that a quadric stands for.
fn weight(quadric: &Matrix4<f64>) -> f64 {
    quadric[(0, 0)] + quadric[(1, 1)] + quadric[(2, 2)]
}

fn is_sound(before: [Point3; 3], after: [Point3; 3]) -> bool {
    let (n, m) = (area_vector(before), area_vector(after));
    let turns_little = n.dot(&m) > MIN_TURN * n.norm() * m.norm();
    let quality = triangle_quality(after);
    turns_little && (quality >= MIN_QUALITY || quality >= triangle_quality(before))
}
