//! The nearest among points.

use crate::bvh::BoxTree;
use crate::{Aabb, Point3};

/// A box tree over points, and the points in its order.
pub(super) struct PointTree {
    tree: BoxTree,
    points: Vec<Point3>,
}

impl PointTree {
    pub(super) fn of(points: &[Point3]) -> Self {
        Self::new(points, Aabb::of(points))
    }

    pub(super) fn new(points: &[Point3], bounds: Aabb) -> Self {
        let of_row = |row: usize| Aabb {
            min: points[row],
            max: points[row],
        };
        let tree = BoxTree::new(bounds, points.len(), of_row);
        let points = tree
            .rows()
            .iter()
            .map(|&row| points[row as usize])
            .collect();
        Self { tree, points }
    }

    /// The row of each point, in an order in which neighbours are close.
    pub(super) fn rows(&self) -> &[u32] {
        self.tree.rows()
    }

    /// The place of a row in that order.
    pub(super) fn slot(&self, row: u32) -> u32 {
        self.tree.slot(row)
    }

    /// The nearest point, the lowest row among equals, and its squared distance; sooner if that in row `hint` is near.
    pub(super) fn nearest(&self, query: &Point3, hint: u32) -> (u32, f64) {
        let mut best = (0, f64::INFINITY);
        if (hint as usize) < self.points.len() {
            let hinted = self.points[self.tree.slot(hint) as usize];
            best = (hint, (hinted - query).norm_squared());
        }
        self.tree.nearest(query, best.1, |slot| {
            let d = (self.points[slot as usize] - query).norm_squared();
            let row = self.tree.rows()[slot as usize];
            if d < best.1 || (d == best.1 && row < best.0) {
                best = (row, d);
            }
            best.1
        });
        best
    }

    /// The `k` nearest points, nearest first, the lower row first among equals.
    pub(super) fn nearest_rows(&self, query: &Point3, k: usize) -> Vec<u32> {
        let mut best: Vec<(f64, u32)> = Vec::with_capacity(k + 1);
        self.tree.nearest(query, f64::INFINITY, |slot| {
            let candidate = (
                (self.points[slot as usize] - query).norm_squared(),
                self.tree.rows()[slot as usize],
            );
            let at = best.partition_point(|&b| b < candidate);
            if at < k {
                best.truncate(k - 1);
                best.insert(at, candidate);
            }
            best.get(k - 1).map_or(f64::INFINITY, |b| b.0)
        });
        best.into_iter().map(|(_, row)| row).collect()
    }
}
