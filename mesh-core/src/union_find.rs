//! Disjoint sets that grow together.

/// Disjoint sets of `0..n`, each element with a sign relative to its set.
///
/// Sets are joined by size and paths compressed: a sequence of operations takes almost linear time. Source: Tarjan 1975.
/// What joins neighbours without a sign uses [`Self::union`] and [`Self::find`] alone.
///
/// ```
/// use mesh_core::UnionFind;
/// let mut sets = UnionFind::new(4);
/// sets.union(0, 2);
/// sets.union_signed(2, 3, true);
/// assert_eq!(sets.find(0), sets.find(3));
/// assert_ne!(sets.find_signed(0).1, sets.find_signed(3).1);
/// assert_eq!(sets.sets(|_| true), [vec![0, 2, 3], vec![1]]);
/// ```
#[derive(Clone, Debug)]
pub struct UnionFind {
    /// A parent, and whether the sign differs from the parent's; itself and no at the root of a set.
    parents: Vec<(u32, bool)>,
    sizes: Vec<u32>,
}

impl UnionFind {
    /// `n` sets of one element each.
    ///
    /// # Panics
    /// If `n` is more than 32 bits can count.
    pub fn new(n: usize) -> Self {
        let n = u32::try_from(n).expect("as many elements as 32 bits can count");
        Self {
            parents: (0..n).map(|row| (row, false)).collect(),
            sizes: vec![1; n as usize],
        }
    }

    /// The element that stands for the set of `row`.
    pub fn find(&mut self, row: usize) -> usize {
        self.find_signed(row).0
    }

    /// The element that stands for the set of `row`, and whether the sign of `row` differs from its.
    pub fn find_signed(&mut self, row: usize) -> (usize, bool) {
        let (mut root, mut differs) = (row as u32, false);
        while self.parents[root as usize].0 != root {
            let (parent, flip) = self.parents[root as usize];
            differs ^= flip;
            root = parent;
        }
        let (mut at, mut rest) = (row as u32, differs);
        while at != root {
            let (parent, flip) = std::mem::replace(&mut self.parents[at as usize], (root, rest));
            rest ^= flip;
            at = parent;
        }
        (root as usize, differs)
    }

    /// Joins the sets of two elements.
    pub fn union(&mut self, a: usize, b: usize) {
        self.union_signed(a, b, false);
    }

    /// Joins the sets of two elements, whose signs are then alike unless they `differ`; in one set already, they keep
    /// theirs.
    pub fn union_signed(&mut self, a: usize, b: usize, differ: bool) {
        let ((a, a_differs), (b, b_differs)) = (self.find_signed(a), self.find_signed(b));
        if a == b {
            return;
        }
        let (small, large) = if self.sizes[a] < self.sizes[b] {
            (a, b)
        } else {
            (b, a)
        };
        self.parents[small] = (large as u32, a_differs ^ b_differs ^ differ);
        self.sizes[large] += self.sizes[small];
    }

    /// The sets of the elements for which `is_listed` holds, each ascending, in the order of their first elements.
    pub fn sets(&mut self, is_listed: impl Fn(usize) -> bool) -> Vec<Vec<usize>> {
        let mut set_of = vec![None; self.parents.len()];
        let mut sets: Vec<Vec<usize>> = Vec::new();
        for row in (0..self.parents.len()).filter(|&row| is_listed(row)) {
            let set = *set_of[self.find(row)].get_or_insert_with(|| {
                sets.push(Vec::new());
                sets.len() - 1
            });
            sets[set].push(row);
        }
        sets
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Against a search through all edges.
        #[test]
        fn sets_are_what_edges_connect(edges in prop::collection::vec((0usize..12, 0usize..12), 0..14)) {
            let mut sets = UnionFind::new(12);
            edges.iter().for_each(|&(a, b)| sets.union(a, b));
            for start in 0..12 {
                let mut is_reached = [false; 12];
                is_reached[start] = true;
                for _ in 0..12 {
                    for &(a, b) in &edges {
                        let either = is_reached[a] || is_reached[b];
                        (is_reached[a], is_reached[b]) = (either, either);
                    }
                }
                for other in 0..12 {
                    prop_assert_eq!(is_reached[other], sets.find(start) == sets.find(other));
                }
            }
        }

        /// Signs given to elements come back, up to one flip of each set.
        #[test]
        fn signs_are_kept_relative_to_each_other(
            signs in prop::array::uniform12(any::<bool>()),
            edges in prop::collection::vec((0usize..12, 0usize..12), 0..20),
        ) {
            let mut sets = UnionFind::new(12);
            for &(a, b) in &edges {
                sets.union_signed(a, b, signs[a] != signs[b]);
            }
            for (a, b) in edges {
                let differ = sets.find_signed(a).1 != sets.find_signed(b).1;
                prop_assert_eq!(differ, signs[a] != signs[b]);
            }
        }
    }

    #[test]
    fn only_what_is_listed_is_in_a_set() {
        let mut sets = UnionFind::new(5);
        sets.union(4, 1);
        sets.union(1, 3);
        assert_eq!(sets.sets(|row| row != 1), [vec![0], vec![2], vec![3, 4]]);
    }
}
