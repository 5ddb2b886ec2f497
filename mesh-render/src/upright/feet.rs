//! Feet: parts of a shape that rise from the ground apart and join higher up.

use mesh_core::{Aabb, UnionFind, Vector3};

use super::outline::Outline;
use super::Evidence;
use crate::Up;

/// A foot begins at most this far above the lowest point, in longest sides of the box.
const NEAR_GROUND: f64 = 0.06;
/// A foot rises at least so far before it joins another, likewise.
const LEAST_LENGTH: f64 = 0.05;
/// What stands upside down in its file, −Y or −Z up, is rare: its evidence counts this share.
const UPSIDE_DOWN: f64 = 0.4;
/// So many feet count beside the first: those of a four-legged animal.
const MOST_FEET: usize = 3;

/// The summed lengths of the feet beside the first one when each axis points up, in longest sides of the box.
///
/// A foot is a part of the sublevel set `{p : p · up ≤ h}` that begins near the ground; its length is the height at which
/// it joins a part that begins lower, less the height at which it begins: its persistence. Source: Edelsbrunner,
/// Letscher and Zomorodian 2002, of the height function. The rim of an opening is no foot: masks and scans end there.
pub(super) fn evidence(outline: &Outline) -> Evidence {
    Up::AXES.map(|(up, _)| {
        let mut lengths = lengths(outline, &up.direction());
        lengths.sort_by(|a, b| b.total_cmp(a));
        let sum: f64 = lengths.iter().take(MOST_FEET).sum();
        let is_upside_down = up == Up::MINUS_Y || up == Up::MINUS_Z;
        sum * if is_upside_down { UPSIDE_DOWN } else { 1.0 }
    })
}

/// The length of each foot but the one that begins lowest.
fn lengths(outline: &Outline, up: &Vector3) -> Vec<f64> {
    let side = Aabb::of(&outline.points).longest_side();
    let heights: Vec<f64> = outline.points.iter().map(|p| p.coords.dot(up)).collect();
    let mut order: Vec<usize> = (0..heights.len()).collect();
    order.sort_by(|&a, &b| heights[a].total_cmp(&heights[b]));
    let ground = order.first().map_or(0.0, |&row| heights[row]);

    let mut parts = UnionFind::new(heights.len());
    // The lowest point of the part that each row stands for.
    let mut lowest: Vec<usize> = (0..heights.len()).collect();
    let mut is_wet = vec![false; heights.len()];
    let mut lengths = Vec::new();
    for row in order {
        is_wet[row] = true;
        for &other in &outline.neighbours[row] {
            let (a, b) = (parts.find(row), parts.find(other as usize));
            if !is_wet[other as usize] || a == b {
                continue;
            }
            let (mut low, mut high) = (lowest[a], lowest[b]);
            if heights[high] < heights[low] {
                (low, high) = (high, low);
            }
            let length = heights[row] - heights[high];
            let is_near_ground = heights[high] - ground < NEAR_GROUND * side;
            if is_near_ground && length > LEAST_LENGTH * side && !outline.is_rim[high] {
                lengths.push(length / side);
            }
            parts.union(a, b);
            lowest[parts.find(a)] = low;
        }
    }
    lengths
}
