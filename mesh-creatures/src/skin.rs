//! How much each bone moves a vertex.

/// Bones and their shares, which sum to 1; bones in order, none twice.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Skin(Vec<(usize, f64)>);

impl Skin {
    /// Moved by one bone alone.
    pub(crate) fn of(bone: usize) -> Self {
        Self(vec![(bone, 1.0)])
    }

    /// Moved by two bones, by the second with this share.
    pub(crate) fn between(one: usize, other: usize, share: f64) -> Self {
        Self::mixed([(&Self::of(one), 1.0 - share), (&Self::of(other), share)])
    }

    /// `Σ wₖ sₖ`.
    pub(crate) fn mixed<'a>(terms: impl IntoIterator<Item = (&'a Self, f64)>) -> Self {
        let mut sum: Vec<(usize, f64)> = Vec::new();
        for (skin, weight) in terms {
            for &(bone, share) in &skin.0 {
                match sum.binary_search_by_key(&bone, |entry| entry.0) {
                    Ok(row) => sum[row].1 += weight * share,
                    Err(row) => sum.insert(row, (bone, weight * share)),
                }
            }
        }
        Self(sum)
    }

    pub(crate) fn shares(&self) -> &[(usize, f64)] {
        &self.0
    }
}
