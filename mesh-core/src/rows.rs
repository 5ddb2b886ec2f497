//! Lists of different lengths, one after the other.

use std::ops::{Index, Range};

/// A list of items for each row, all in one vector: the compressed rows of sparse matrices.
///
/// ```
/// use mesh_core::Rows;
/// let rows = Rows::from_pairs(3, [(2, 'a'), (0, 'b'), (2, 'c')].into_iter());
/// assert_eq!(rows.iter().collect::<Vec<_>>(), [&['b'][..], &[], &['a', 'c']]);
/// assert_eq!(&rows[2], ['a', 'c']);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rows<T> {
    /// Where each row begins in `items`, and where the last one ends.
    starts: Vec<u32>,
    items: Vec<T>,
}

impl<T: Copy> Rows<T> {
    /// `n` rows: the second of each pair in the row of the first, in the order of the pairs, which are walked twice.
    ///
    /// # Panics
    /// If a pair names a row that is not there, or there are more pairs than 32 bits can count.
    pub fn from_pairs(n: usize, pairs: impl Iterator<Item = (usize, T)> + Clone) -> Self {
        let mut starts = vec![0u32; n + 1];
        for (row, _) in pairs.clone() {
            starts[row + 1] += 1;
        }
        for row in 0..n {
            starts[row + 1] = offset(starts[row] as usize + starts[row + 1] as usize);
        }
        let Some((_, first)) = pairs.clone().next() else {
            return Self {
                starts,
                items: Vec::new(),
            };
        };
        let mut items = vec![first; starts[n] as usize];
        let mut next = starts.clone();
        for (row, item) in pairs {
            items[next[row] as usize] = item;
            next[row] += 1;
        }
        Self { starts, items }
    }

    /// One row for each list.
    ///
    /// # Panics
    /// If there are more items than 32 bits can count.
    pub fn from_lists<L: IntoIterator<Item = T>>(lists: impl IntoIterator<Item = L>) -> Self {
        let (mut starts, mut items) = (vec![0], Vec::new());
        for list in lists {
            items.extend(list);
            starts.push(offset(items.len()));
        }
        Self { starts, items }
    }
}

impl<T> Rows<T> {
    /// How many rows there are.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// All rows, in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[T]> + Clone {
        (0..self.len()).map(|row| &self[row])
    }

    /// The items of all rows, one row after the other.
    pub fn items(&self) -> &[T] {
        &self.items
    }

    /// Where the items of a row are among those of all: for values that lie beside them.
    ///
    /// # Panics
    /// If the row is not there.
    pub fn range(&self, row: usize) -> Range<usize> {
        self.starts[row] as usize..self.starts[row + 1] as usize
    }
}

impl<T> Index<usize> for Rows<T> {
    type Output = [T];

    fn index(&self, row: usize) -> &[T] {
        &self.items[self.range(row)]
    }
}

fn offset(n: usize) -> u32 {
    u32::try_from(n).expect("as many items as 32 bits can count")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_and_their_pairs_give_the_same_rows() {
        let lists = [vec![3, 1], vec![], vec![2, 2, 2]];
        let rows = Rows::from_lists(lists.clone());
        let pairs = (0..)
            .zip(&lists)
            .flat_map(|(k, l)| l.iter().map(move |&x| (k, x)));
        assert_eq!(rows, Rows::from_pairs(3, pairs));
        assert_eq!(rows.iter().map(<[i32]>::to_vec).collect::<Vec<_>>(), lists);
        assert_eq!(rows.items()[rows.range(2)], rows[2]);
        assert_eq!((rows.len(), rows.is_empty()), (3, false));
    }

    #[test]
    fn without_pairs_all_rows_are_empty() {
        let rows = Rows::<u8>::from_pairs(2, [].into_iter());
        assert_eq!(rows.iter().map(<[u8]>::len).collect::<Vec<_>>(), [0, 0]);
        assert!(Rows::<u8>::from_pairs(0, [].into_iter()).is_empty());
    }
}
