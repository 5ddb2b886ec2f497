//! The farthest few distances: what a mean does not see.

use mesh_core::{Positions, Vector3, VertexData};

use crate::{Loss, Matches, SurfaceMatch};

/// Mean excess of the largest `share` of the matched distances over a tolerance, both ways.
///
/// `W = Σ over both ways of 1/k Σ over the k largest of max(0, |pₖ − qₖ| − τ)`, with k = ⌈share · n⌉ for n samples
///
/// The corners that are far off compete with the samples: a tip is where a sample hardly ever falls. The weights of the
/// pairs do not count: the tip of an ear is seen from its side. Units: those of the coordinates. Q hangs on the
/// Hausdorff distance, which an ear tip decides.
/// Source: beyond the paper. Off in `paper`.
pub struct WorstDistance<'a> {
    /// The pairs.
    pub matches: &'a Matches,
    /// Which share of them counts, 0..=1.
    pub share: f64,
    /// τ: a distance up to this is good enough.
    pub tolerance: f64,
}

impl Loss for WorstDistance<'_> {
    fn accumulate(&self, x: &Positions, weight: f64, grad: &mut VertexData<Vector3>) -> f64 {
        let m = self.matches;
        [
            (&m.to_target, &m.hard_to_target),
            (&m.to_mesh, &m.hard_to_mesh),
        ]
        .into_iter()
        .map(|(matches, hard)| self.mean_of_largest(matches, hard, x, weight, grad))
        .sum()
    }
}

impl WorstDistance<'_> {
    fn mean_of_largest(
        &self,
        matches: &[SurfaceMatch],
        hard: &[SurfaceMatch],
        x: &Positions,
        weight: f64,
        grad: &mut VertexData<Vector3>,
    ) -> f64 {
        let k = ((self.share * matches.len() as f64).ceil() as usize).min(matches.len());
        if k == 0 {
            return 0.0;
        }
        let pair_at = |row: usize| {
            matches
                .get(row)
                .unwrap_or_else(|| &hard[row - matches.len()])
        };
        let mut ranked: Vec<(f64, usize)> = matches
            .iter()
            .chain(hard)
            .enumerate()
            .map(|(row, pair)| (pair.offset(x).norm_squared(), row))
            .collect();
        let farther = |a: &(f64, usize), b: &(f64, usize)| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1));
        ranked.select_nth_unstable_by(k - 1, farther);
        ranked.truncate(k);
        ranked.sort_unstable_by(farther);

        for &(_, row) in &ranked {
            let pair = pair_at(row);
            let offset = pair.offset(x);
            let distance = offset.norm();
            if distance > self.tolerance.max(f64::MIN_POSITIVE) {
                pair.scatter(&(offset * (weight / (k as f64 * distance))), grad);
            }
        }
        let excess = |&(squared, _): &(f64, usize)| (squared.sqrt() - self.tolerance).max(0.0);
        ranked.iter().map(excess).sum::<f64>() / k as f64
    }
}
