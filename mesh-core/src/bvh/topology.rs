//! Which boxes are in which: built by the crate `obvhs` as a binary tree, widened to four children a node.

use glam::Vec3A;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::bvh2::Bvh2;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

use super::box32::Box32;

/// Marks a child that is an item; the other bits are its slot.
pub(super) const ITEM: u32 = 1 << 31;
/// Marks a child that is not there.
pub(super) const ABSENT: u32 = u32::MAX;
/// Share of the nodes that the builder tries to place better, per round.
const REINSERTED: f32 = 0.05;
/// The children of each node, parents first, and the row of the item in each slot.
pub(super) struct Topology {
    pub(super) children: Vec<[u32; 4]>,
    pub(super) rows: Vec<u32>,
}

impl Topology {
    /// Of `n` items in boxes of the unit frame.
    pub(super) fn new(n: usize, of_row: impl Fn(usize) -> Box32) -> Self {
        let boxes: Vec<_> = (0..n).map(|row| plain_box(of_row(row))).collect();
        four_wide(&binary_tree(&boxes))
    }
}

/// For the builder, which expects numbers of moderate size whatever the items are.
fn plain_box(b: Box32) -> obvhs::aabb::Aabb {
    let plain = |p: [f32; 3]| {
        Vec3A::from_array(p.map(|c| if c.is_nan() { 0.0 } else { c.clamp(-2.0, 2.0) }))
    };
    obvhs::aabb::Aabb::new(plain(b.min), plain(b.max))
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
fn four_wide(binary: &Bvh2) -> Topology {
    let mut nodes: Vec<[u32; 4]> = Vec::with_capacity(binary.nodes.len() / 4);
    let mut rows = Vec::with_capacity(binary.primitive_indices.len());
    let mut todo = Vec::new();
    if !binary.nodes.is_empty() {
        todo.push((0, None));
    }
    while let Some((root, parent)) = todo.pop() {
        let new = nodes.len();
        nodes.push([ABSENT; 4]);
        if let Some((node, lane)) = parent {
            let node: &mut [u32; 4] = &mut nodes[node];
            node[lane] = new as u32;
        }
        for (lane, child) in descendants(binary, root).into_iter().enumerate() {
            let node = &binary.nodes[child];
            if node.is_leaf() {
                nodes[new][lane] = ITEM | rows.len() as u32;
                rows.push(binary.primitive_indices[node.first_index as usize]);
            } else {
                todo.push((child, Some((new, lane))));
            }
        }
    }
    Topology {
        children: nodes,
        rows,
    }
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
