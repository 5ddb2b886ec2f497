//! Boxes around items in a tree of four children a node, in f32, rounded outwards.
//!
//! The tree works in the unit frame of its items, so that f32 resolves them wherever they lie.

use glam::{Vec3A, Vec4};
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::bvh2::Bvh2;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

use crate::{Aabb, Point3, UnitFrame, Vector3};

/// Marks a child that is an item; the other bits are its slot.
const ITEM: u32 = 1 << 31;
/// Marks a child that is not there.
const ABSENT: u32 = u32::MAX;
/// Covers the rounding of a squared f32 box distance (relative; 4e-7 at most).
const ROUNDING: f64 = 1e-6;
/// Covers the rounding of squared f64 distances between items of the unit frame (absolute).
const NEARNESS: f64 = 1e-20;
/// Share of the nodes that the builder tries to place better, per round.
const REINSERTED: f32 = 0.05;
/// Children that a query has put off; more than this go to the heap.
const STACK: usize = 64;

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
        let (nodes, rows) = {
            let boxes: Vec<obvhs::aabb::Aabb> =
                (0..n).map(|row| outer_box(&frame, &of_row(row))).collect();
            four_wide(&binary_tree(&boxes))
        };
        let mut slots = vec![0; n];
        for (slot, &row) in rows.iter().enumerate() {
            slots[row as usize] = slot as u32;
        }
        let mut tree = Self {
            frame,
            nodes,
            rows,
            slots,
        };
        let rows = std::mem::take(&mut tree.rows);
        tree.refit(bounds, |slot| of_row(rows[slot] as usize));
        tree.rows = rows;
        tree
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
            for lane in 0..4 {
                let (min, max) = match self.nodes[k].children[lane] {
                    ABSENT => continue,
                    child if child & ITEM != 0 => {
                        let b = outer_box(&self.frame, &of_slot((child ^ ITEM) as usize));
                        (b.min.to_array(), b.max.to_array())
                    }
                    child => self.nodes[child as usize].bounds(),
                };
                let node = &mut self.nodes[k];
                for axis in 0..3 {
                    node.min[axis][lane] = min[axis];
                    node.max[axis][lane] = max[axis];
                }
            }
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
                let node = &self.nodes[child as usize];
                for entry in node.near_last(&point) {
                    if entry.distance() <= reach {
                        stack.push(entry);
                    }
                }
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
    const EMPTY: Self = Self {
        min: [Vec4::MAX; 3],
        max: [Vec4::MIN; 3],
        children: [ABSENT; 4],
    };

    fn bounds(&self) -> ([f32; 3], [f32; 3]) {
        (
            self.min.map(Vec4::min_element),
            self.max.map(Vec4::max_element),
        )
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
    fn meets(&self, lane: usize, query: &obvhs::aabb::Aabb) -> bool {
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

/// A child and a lower bound of its squared distance, in one word that sorts by distance.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Entry(u64);

impl Entry {
    #[inline(always)]
    fn new(distance: f32, child: u32) -> Self {
        Self((u64::from(distance.to_bits()) << 32) | u64::from(child))
    }

    #[inline(always)]
    fn distance(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }

    #[inline(always)]
    fn child(self) -> u32 {
        self.0 as u32
    }
}

#[inline(always)]
fn sort_down([a, b, c, d]: [Entry; 4]) -> [Entry; 4] {
    let (a, b) = (a.max(b), a.min(b));
    let (c, d) = (c.max(d), c.min(d));
    let (a, c) = (a.max(c), a.min(c));
    let (b, d) = (b.max(d), b.min(d));
    let (b, c) = (b.max(c), b.min(c));
    [a, b, c, d]
}

/// Children put off, on the machine's stack as long as they fit.
struct Stack {
    entries: [Entry; STACK],
    len: usize,
    overflow: Vec<Entry>,
}

impl Stack {
    #[inline(always)]
    fn new() -> Self {
        Self {
            entries: [Entry(0); STACK],
            len: 0,
            overflow: Vec::new(),
        }
    }

    #[inline(always)]
    fn push(&mut self, entry: Entry) {
        if self.len < STACK {
            self.entries[self.len] = entry;
            self.len += 1;
        } else {
            self.overflow.push(entry);
        }
    }

    /// The last child put off that is within `reach`; those before it that are not are dropped.
    #[inline(always)]
    fn pop_within(&mut self, reach: f32) -> Option<u32> {
        while let Some(entry) = self.overflow.pop() {
            if entry.distance() <= reach {
                return Some(entry.child());
            }
        }
        while self.len > 0 {
            self.len -= 1;
            let entry = self.entries[self.len];
            if entry.distance() <= reach {
                return Some(entry.child());
            }
        }
        None
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
            below: p.map(|c| Vec4::splat(round_down(c))),
            above: p.map(|c| Vec4::splat(round_up(c))),
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

fn round_down(x: f64) -> f32 {
    let near = x as f32;
    if f64::from(near) > x {
        near.next_down()
    } else {
        near
    }
}

fn round_up(x: f64) -> f32 {
    let near = x as f32;
    if f64::from(near) < x {
        near.next_up()
    } else {
        near
    }
}

/// The smallest f32 box around `b` in the unit frame; bounded whatever the coordinates.
fn outer_box(frame: &UnitFrame, b: &Aabb) -> obvhs::aabb::Aabb {
    let [min, max] = [&b.min, &b.max].map(|p| {
        let p = frame.to_unit(p);
        [p.x, p.y, p.z].map(|c| bounded(c, 2.0))
    });
    obvhs::aabb::Aabb::new(
        Vec3A::from_array(min.map(round_down)),
        Vec3A::from_array(max.map(round_up)),
    )
}

/// Source: Meister & Bittner 2018 (clustering) and 2018 (reinsertion), as in the crate `obvhs`.
fn binary_tree(boxes: &[obvhs::aabb::Aabb]) -> Bvh2 {
    let rows = (0..boxes.len() as u32).collect();
    let mut tree =
        PlocBuilder::new().build(PlocSearchDistance::Low, boxes, rows, SortPrecision::U64, 2);
    ReinsertionOptimizer::default().run(&mut tree, REINSERTED, None);
    tree
}

/// Pulls grandchildren up, the largest first, until nodes have four children; parents come before children.
fn four_wide(binary: &Bvh2) -> (Vec<Node>, Vec<u32>) {
    let mut nodes: Vec<Node> = Vec::with_capacity(binary.nodes.len() / 4);
    let mut rows = Vec::with_capacity(binary.primitive_indices.len());
    let mut todo = Vec::new();
    if !binary.nodes.is_empty() {
        todo.push((0, None));
    }
    while let Some((root, parent)) = todo.pop() {
        let new = nodes.len();
        nodes.push(Node::EMPTY);
        if let Some((node, lane)) = parent {
            let node: &mut Node = &mut nodes[node];
            node.children[lane] = new as u32;
        }
        for (lane, child) in descendants(binary, root).into_iter().enumerate() {
            let node = &binary.nodes[child];
            if node.is_leaf() {
                nodes[new].children[lane] = ITEM | rows.len() as u32;
                rows.push(binary.primitive_indices[node.first_index as usize]);
            } else {
                todo.push((child, Some((new, lane))));
            }
        }
    }
    (nodes, rows)
}

/// Up to four descendants of `root` that cover it.
fn descendants(binary: &Bvh2, root: usize) -> Vec<usize> {
    let mut found = vec![root];
    while found.len() < 4 {
        let area = |&k: &usize| binary.nodes[found[k]].aabb().half_area();
        let inner = (0..found.len()).filter(|&k| !binary.nodes[found[k]].is_leaf());
        let Some(largest) = inner.max_by(|a, b| area(a).total_cmp(&area(b))) else {
            break;
        };
        let left = binary.nodes[found[largest]].first_index as usize;
        found[largest] = left;
        found.insert(largest + 1, left + 1);
    }
    found
}
