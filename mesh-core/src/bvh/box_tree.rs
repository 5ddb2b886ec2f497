//! Boxes around items in a tree of four children a node, in f32, rounded outwards.
//!
//! The tree works in the unit frame of its items, so that f32 resolves them wherever they lie.

use glam::Vec4;

use super::box32::Box32;
use super::stack::{sort_down, Entry, Stack};
use super::topology::{Topology, ABSENT, ITEM};
use crate::{Aabb, Point3, UnitFrame, Vector3};

/// Covers the rounding of a squared f32 box distance (relative; 4e-7 at most).
const ROUNDING: f64 = 1e-6;
/// Covers the rounding of a number to f32 (relative; half a unit in the last place, 2⁻²⁴, at most).
const TO_SINGLE: f64 = 1.2e-7;
/// Covers the rounding of squared f64 distances between items of the unit frame (absolute).
const NEARNESS: f64 = 1e-20;
/// Covers the rounding of coordinates of the unit frame, which are at most 1, to f32.
const MARGIN: f64 = 6e-8;
/// Four child boxes, one per lane: `min[axis][lane]`.
#[derive(Clone, Copy, Debug)]
struct Node {
    min: [Vec4; 3],
    max: [Vec4; 3],
    children: [u32; 4],
}

/// A tree of boxes. Items have a row (as given) and a slot (their place in the tree).
#[derive(Clone, Debug)]
pub(crate) struct BoxTree {
    frame: UnitFrame,
    /// Parents before children; the root first.
    nodes: Vec<Node>,
    /// The row of each slot.
    rows: Vec<u32>,
    /// The slot of each row.
    slots: Vec<u32>,
}

impl BoxTree {
    /// The tree of `n` items with boxes `of_row`, all within `bounds`.
    pub(crate) fn new(bounds: Aabb, n: usize, of_row: impl Fn(usize) -> Aabb) -> Self {
        assert!(n < ITEM as usize, "a box tree holds at most 2³¹ items");
        let frame = UnitFrame::of(bounds);
        let Topology { children, rows } = Topology::new(n, |row| outer_box(&frame, &of_row(row)));
        let mut slots = vec![0; n];
        for (slot, &row) in rows.iter().enumerate() {
            slots[row as usize] = slot as u32;
        }
        let nodes = children
            .into_iter()
            .map(|children| Node::new(&[Box32::EMPTY; 4], children));
        let mut tree = Self {
            frame,
            nodes: nodes.collect(),
            rows: Vec::new(),
            slots,
        };
        tree.refit(bounds, |slot| of_row(rows[slot] as usize));
        Self { rows, ..tree }
    }

    /// The row of each slot.
    pub(crate) fn rows(&self) -> &[u32] {
        &self.rows
    }

    /// The slot of the item in row `row`.
    pub(crate) fn slot(&self, row: u32) -> u32 {
        self.slots[row as usize]
    }

    /// Recomputes all boxes from those of the items.
    pub(crate) fn refit(&mut self, bounds: Aabb, of_slot: impl Fn(usize) -> Aabb) {
        self.frame = UnitFrame::of(bounds);
        for k in (0..self.nodes.len()).rev() {
            let children = self.nodes[k].children;
            let mut lanes = [Box32::EMPTY; 4];
            for (lane, &child) in lanes.iter_mut().zip(&children) {
                *lane = match child {
                    ABSENT => Box32::EMPTY,
                    item if item & ITEM != 0 => {
                        outer_box(&self.frame, &of_slot((item ^ ITEM) as usize))
                    }
                    inner => self.nodes[inner as usize].bounds(),
                };
            }
            self.nodes[k] = Node::new(&lanes, children);
        }
    }

    /// Visits the items that can be at most as far from `query` as the best known, roughly nearest first.
    ///
    /// `visit` measures the item in a slot and returns the squared distance of the best so far; `best` is that
    /// distance at the start. Items at exactly the best distance are visited, too, so that ties can be broken.
    pub(crate) fn nearest(&self, query: &Point3, best: f64, mut visit: impl FnMut(u32) -> f64) {
        let point = QueryPoint::new(&self.frame.to_unit(query));
        let to_unit = 1.0 / (self.frame.scale * self.frame.scale);
        let limit = |best: f64| {
            let reach = best * to_unit * (1.0 + ROUNDING) + NEARNESS;
            (reach as f32).min(f32::MAX)
        };

        let mut reach = limit(best);
        let mut stack = Stack::new();
        let mut next = (!self.nodes.is_empty()).then_some(0);
        while let Some(child) = next {
            if child & ITEM != 0 {
                reach = limit(visit(child ^ ITEM));
            } else {
                let near_last = self.nodes[child as usize].near_last(&point);
                stack.push_within(near_last, reach);
            }
            next = stack.pop_within(reach);
        }
    }

    /// Visits the items whose box the ray from `origin` meets within the best known distance, roughly nearest first.
    ///
    /// `visit` tests the item in a slot and returns the distance of the first hit so far, in lengths of `direction`.
    pub(crate) fn along(
        &self,
        origin: &Point3,
        direction: &Vector3,
        mut visit: impl FnMut(u32) -> f64,
    ) {
        let origin = self.frame.to_unit(origin);
        let inverse = (direction / self.frame.scale).map(|d| 1.0 / d);
        let mut reach = f64::INFINITY;
        let mut stack = vec![(0.0, 0)];
        if self.nodes.is_empty() {
            stack.clear();
        }
        while let Some((entry, child)) = stack.pop() {
            if entry > reach {
                continue;
            }
            if child & ITEM != 0 {
                reach = visit(child ^ ITEM);
                continue;
            }
            let node = &self.nodes[child as usize];
            let from = stack.len();
            for lane in (0..4).filter(|&lane| node.children[lane] != ABSENT) {
                if let Some(entry) = node.entry(lane, &origin, &inverse) {
                    stack.push((entry, node.children[lane]));
                }
            }
            stack[from..].sort_by(|a, b| b.0.total_cmp(&a.0));
        }
    }

    /// Visits the items whose box, rounded outwards, meets `bounds`, in the order of the tree.
    pub(crate) fn overlapping(&self, bounds: &Aabb, mut visit: impl FnMut(u32)) {
        let query = outer_box(&self.frame, bounds);
        let mut stack = if self.nodes.is_empty() {
            vec![]
        } else {
            vec![0]
        };
        while let Some(child) = stack.pop() {
            if child & ITEM != 0 {
                visit(child ^ ITEM);
                continue;
            }
            let node = &self.nodes[child as usize];
            let lanes = (0..4).filter(|&lane| node.children[lane] != ABSENT);
            stack.extend(
                lanes
                    .filter(|&lane| node.meets(lane, &query))
                    .map(|lane| node.children[lane]),
            );
        }
    }
}

impl Node {
    fn new(lanes: &[Box32; 4], children: [u32; 4]) -> Self {
        Self {
            min: [0, 1, 2].map(|axis| Vec4::from_array(lanes.map(|b| b.min[axis]))),
            max: [0, 1, 2].map(|axis| Vec4::from_array(lanes.map(|b| b.max[axis]))),
            children,
        }
    }

    fn bounds(&self) -> Box32 {
        Box32 {
            min: self.min.map(Vec4::min_element),
            max: self.max.map(Vec4::max_element),
        }
    }

    /// The children with lower bounds of their squared distances, farthest first.
    #[inline(always)]
    fn near_last(&self, query: &QueryPoint) -> [Entry; 4] {
        let mut squared = Vec4::ZERO;
        for axis in 0..3 {
            let below = self.min[axis] - query.above[axis];
            let above = query.below[axis] - self.max[axis];
            let outside = below.max(above).max(Vec4::ZERO);
            squared += outside * outside;
        }
        let [a, b, c, d] = squared.to_array();
        let [i, j, k, l] = self.children;
        sort_down([
            Entry::new(a, i),
            Entry::new(b, j),
            Entry::new(c, k),
            Entry::new(d, l),
        ])
    }

    /// Whether the box of a child overlaps or touches `query`.
    fn meets(&self, lane: usize, query: &Box32) -> bool {
        (0..3).all(|axis| {
            self.min[axis][lane] <= query.max[axis] && query.min[axis] <= self.max[axis][lane]
        })
    }

    /// Where a ray enters the box of a child, in lengths of its direction; none if it misses.
    fn entry(&self, lane: usize, origin: &Point3, inverse: &Vector3) -> Option<f64> {
        let (mut entry, mut exit) = (0f64, f64::INFINITY);
        for axis in 0..3 {
            let (min, max) = (
                f64::from(self.min[axis][lane]),
                f64::from(self.max[axis][lane]),
            );
            let (one, two) = (
                (min - origin[axis]) * inverse[axis],
                (max - origin[axis]) * inverse[axis],
            );
            if one.is_nan() || two.is_nan() {
                continue; // the ray runs within a side of the box
            }
            entry = entry.max(one.min(two));
            exit = exit.min(one.max(two));
        }
        (entry * (1.0 - ROUNDING) <= exit * (1.0 + ROUNDING)).then_some(entry * (1.0 - ROUNDING))
    }
}

/// A query in the unit frame, between two f32 points.
struct QueryPoint {
    below: [Vec4; 3],
    above: [Vec4; 3],
}

impl QueryPoint {
    /// Coordinates are clamped (1e18 sides of the shape away) so that their squares stay finite.
    fn new(p: &Point3) -> Self {
        let p = [p.x, p.y, p.z].map(|c| bounded(c, 1e18));
        Self {
            below: p.map(|c| Vec4::splat(below(c))),
            above: p.map(|c| Vec4::splat(above(c))),
        }
    }
}

/// `c` between `−limit` and `limit`; 0 for NaN.
fn bounded(c: f64, limit: f64) -> f64 {
    if c.is_nan() {
        0.0
    } else {
        c.clamp(-limit, limit)
    }
}

/// At most `x`, by a few units in the last place of an f32.
fn below(x: f64) -> f32 {
    (x - x.abs() * TO_SINGLE) as f32
}

/// At least `x`, likewise.
fn above(x: f64) -> f32 {
    (x + x.abs() * TO_SINGLE) as f32
}

/// An f32 box around `b` in the unit frame, at most [`MARGIN`] larger than it must be.
#[inline(always)]
fn outer_box(frame: &UnitFrame, b: &Aabb) -> Box32 {
    let to_unit = 1.0 / frame.scale;
    let unit = |p: &Point3, axis: usize| (p[axis] - frame.center[axis]) * to_unit;
    Box32 {
        min: [0, 1, 2].map(|axis| (unit(&b.min, axis) - MARGIN) as f32),
        max: [0, 1, 2].map(|axis| (unit(&b.max, axis) + MARGIN) as f32),
    }
}
