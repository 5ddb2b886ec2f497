//! Which boxes overlap a given box: a median-split tree in f64.
//!
//! [`mesh_core::TriangleBvh`] answers closest-point queries only; this one answers the other question.

use mesh_core::{Aabb, Point3};

const LEAF_SIZE: usize = 4;

/// A tree over boxes, each known by its row.
pub(crate) struct BoxTree {
    root: Option<Node>,
}

struct Node {
    bounds: Aabb,
    content: Content,
}

enum Content {
    Leaf(Vec<(usize, Aabb)>),
    Halves(Box<[Node; 2]>),
}

impl BoxTree {
    pub(crate) fn new(boxes: &[Aabb]) -> Self {
        let items: Vec<_> = boxes.iter().copied().enumerate().collect();
        Self {
            root: (!items.is_empty()).then(|| Node::new(items)),
        }
    }

    /// Calls `visit` with the row of every box that overlaps or touches `query`.
    pub(crate) fn for_each_overlapping(&self, query: &Aabb, mut visit: impl FnMut(usize)) {
        let mut stack: Vec<&Node> = self.root.iter().collect();
        while let Some(node) = stack.pop() {
            if !is_overlapping(&node.bounds, query) {
                continue;
            }
            match &node.content {
                Content::Halves(halves) => stack.extend(halves.iter()),
                Content::Leaf(items) => items
                    .iter()
                    .filter(|(_, bounds)| is_overlapping(bounds, query))
                    .for_each(|&(row, _)| visit(row)),
            }
        }
    }
}

impl Node {
    fn new(mut items: Vec<(usize, Aabb)>) -> Self {
        let bounds = Aabb::of(items.iter().flat_map(|(_, b)| [&b.min, &b.max]));
        if items.len() <= LEAF_SIZE {
            return Self {
                bounds,
                content: Content::Leaf(items),
            };
        }
        let centers: Vec<Point3> = items.iter().map(|(_, b)| b.center()).collect();
        let spread = Aabb::of(&centers);
        let axis = (spread.max - spread.min).imax();
        let middle = items.len() / 2;
        items.select_nth_unstable_by(middle, |(i, a), (j, b)| {
            a.center()[axis].total_cmp(&b.center()[axis]).then(i.cmp(j))
        });
        let upper = items.split_off(middle);
        Self {
            bounds,
            content: Content::Halves(Box::new([Self::new(items), Self::new(upper)])),
        }
    }
}

fn is_overlapping(a: &Aabb, b: &Aabb) -> bool {
    (0..3).all(|k| a.min[k] <= b.max[k] && b.min[k] <= a.max[k])
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    #[test]
    fn equals_brute_force() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let mut random_box = || {
            let corner = Point3::new(rng.random(), rng.random(), rng.random());
            let size = mesh_core::Vector3::new(rng.random(), rng.random(), rng.random()) * 0.2;
            Aabb { min: corner, max: corner + size }
        };
        let boxes: Vec<Aabb> = (0..300).map(|_| random_box()).collect();
        let tree = BoxTree::new(&boxes);
        for query in &boxes {
            let mut found = Vec::new();
            tree.for_each_overlapping(query, |row| found.push(row));
            found.sort_unstable();
            let expected: Vec<usize> = (0..boxes.len()).filter(|&i| is_overlapping(&boxes[i], query)).collect();
            assert_eq!(found, expected);
        }
    }

    #[test]
    fn no_boxes_no_overlaps() {
        let everything = Aabb { min: Point3::new(-1., -1., -1.), max: Point3::new(1., 1., 1.) };
        BoxTree::new(&[]).for_each_overlapping(&everything, |row| panic!("found {row}"));
    }
}
