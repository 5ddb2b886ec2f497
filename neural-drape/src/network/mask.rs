//! The mask α of the progressive encoding α ⊙ γ(x): low frequencies first, high ones as the run goes on.

use super::config::{Encoding, Networks, Reveal};
use super::encoding::Waves;

/// The mask α of the progressive encoding: the first layer of a network sees `α ⊙ γ(x)`, γ(x) the features of a point that
/// the network is made for.
///
/// Since `Wᵀ(α ⊙ γ) = (diag(α) W)ᵀ γ`, the mask is put into the weights of the first layer ([`Self::weigh`]), and features
/// past the last that is revealed are not computed.
///
/// Source: Mesh Draping, "Progressive Positional Encoding", revealed to all vertices at once.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Mask {
    /// α, one entry per feature, each in 0..=1: 1 for the coordinates, then that of its wave.
    alpha: Vec<f32>,
    /// Factor of what the network puts out, 0..=1: one of several that are summed comes in by it.
    output: f32,
}

impl Mask {
    /// The mask of each network of `encoding` when the run has come to `progress` in 0..=1.
    pub(crate) fn all_at(encoding: &Encoding, waves: &Waves, progress: f64) -> Vec<Self> {
        let n_rows = waves.rows.len();
        match *encoding {
            Encoding::Progressive {
                n_blocks,
                reveal,
                networks: Networks::OnePerBlock,
                ..
            } => (0..n_blocks)
                .map(|block| {
                    let seen = (0..n_rows).filter(|&row| block_of(row, n_rows, n_blocks) <= block);
                    let output = reveal.weight(block, n_blocks, progress);
                    Self::new(waves, &vec![1.0; seen.count()], output)
                })
                .collect(),
            _ => vec![Self::new(
                waves,
                &encoding.row_weights(n_rows, progress),
                1.0,
            )],
        }
    }

    /// The mask of a network that sees as many rows of `waves` as there are `rows`, each by its weight.
    fn new(waves: &Waves, rows: &[f32], output: f32) -> Self {
        let of_waves = rows
            .iter()
            .flat_map(|&w| std::iter::repeat_n(w, waves.kind.n_features()));
        Self {
            alpha: [1.0; 3].into_iter().chain(of_waves).collect(),
            output,
        }
    }

    /// How many features the network is made for.
    pub(crate) fn n_features(&self) -> usize {
        self.alpha.len()
    }

    /// Factor of what the network puts out, 0..=1; the network is hidden where it is 0.
    pub(crate) fn output(&self) -> f32 {
        self.output
    }

    /// How many features are revealed: all before the last whose α is not 0.
    pub(crate) fn n_revealed(&self) -> usize {
        let last = self.alpha.iter().rposition(|&a| a > 0.0);
        last.map_or(0, |last| last + 1)
    }

    /// `diag(α) W`: scales the row of each feature in `weight`, which has `n_outputs` entries a row.
    pub(crate) fn weigh(&self, weight: &mut [f32], n_outputs: usize) {
        for (row, &alpha) in weight.chunks_mut(n_outputs).zip(&self.alpha) {
            row.iter_mut().for_each(|w| *w *= alpha);
        }
    }

    /// α, one entry per feature.
    #[cfg(test)]
    pub(crate) fn alpha(&self) -> &[f32] {
        &self.alpha
    }
}

impl Encoding {
    /// Weight of each row of `waves` at `progress` in [0, 1]: from 0, hidden, to 1.
    ///
    /// A weight never falls as progress grows, and weights never rise from one row to the next: what is revealed is
    /// a prefix.
    pub(super) fn row_weights(&self, n_rows: usize, progress: f64) -> Vec<f32> {
        match *self {
            Self::None | Self::Static(_) => vec![1.0; n_rows],
            Self::Progressive {
                n_blocks, reveal, ..
            } => (0..n_rows)
                .map(|row| reveal.weight(block_of(row, n_rows, n_blocks), n_blocks, progress))
                .collect(),
        }
    }
}

impl Reveal {
    /// How far `block` is revealed at `progress`, 0 to 1.
    fn weight(&self, block: usize, n_blocks: usize, progress: f64) -> f32 {
        if block == 0 {
            return 1.0;
        }
        let (block, n_blocks) = (block as f64, n_blocks as f64);
        let weight = match *self {
            Self::HoldAndFade { until } => 2.0 * n_blocks * progress / until - (2.0 * block - 1.0),
            Self::Even { until } => (n_blocks - 1.0) * progress / until - (block - 1.0),
        };
        weight.clamp(0.0, 1.0) as f32
    }
}

/// The block of a row: blocks are of one size, and what does not divide evenly is in the first.
///
/// 253 rows in 6 blocks: 3, then 50 each (with the coordinates, the authors' cumulative sizes 6, 56, 106, …).
fn block_of(row: usize, n_rows: usize, n_blocks: usize) -> usize {
    if n_blocks < 2 {
        return 0;
    }
    let size = ((n_rows - 1) / (n_blocks - 1)).max(1);
    let first = n_rows.saturating_sub(size * (n_blocks - 1));
    if row < first {
        0
    } else {
        1 + (row - first) / size
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::NetworkConfig;

    #[test]
    fn the_authors_blocks_have_3_rows_then_50_each() {
        let blocks: Vec<usize> = (0..253).map(|row| block_of(row, 253, 6)).collect();
        let sizes: Vec<usize> = (0..6)
            .map(|b| blocks.iter().filter(|&&k| k == b).count())
            .collect();
        assert_eq!(sizes, [3, 50, 50, 50, 50, 50]);
    }

    #[test]
    fn blocks_are_revealed_monotonically_from_the_first_to_all() {
        for config in [NetworkConfig::paper(), NetworkConfig::standard()] {
            let weights = |step: usize| config.encoding.row_weights(126, step as f64 / 100.0);
            assert_eq!(weights(0).iter().filter(|&&w| w > 0.0).count(), 1);
            assert!(weights(100).iter().all(|&w| w == 1.0));
            for step in 0..100 {
                assert!(weights(step)
                    .iter()
                    .zip(weights(step + 1))
                    .all(|(&a, b)| a <= b));
                assert!(weights(step).windows(2).all(|pair| pair[0] >= pair[1]));
            }
        }
    }

    #[test]
    fn the_schedule_of_the_authors_holds_and_fades_in_turns() {
        let Encoding::Progressive { reveal, .. } = NetworkConfig::authors().encoding else {
            panic!("a progressive encoding");
        };
        // Phases of 2000 / 12 iterations of a run that ends at 1500.
        let alpha = |block, iteration: f64| reveal.weight(block, 6, iteration / 1500.0);
        let phase = 2000.0 / 12.0;
        for block in 1..6 {
            let start = (2 * block - 1) as f64 * phase;
            assert_eq!(alpha(block, start - 1.0), 0.0);
            assert!((alpha(block, start + 0.5 * phase) - 0.5).abs() < 1e-6);
            assert_eq!(alpha(block, start + phase + 1.0), 1.0);
        }
        // The paper's run is as long as its schedule.
        let Encoding::Progressive { reveal, .. } = NetworkConfig::paper().encoding else {
            panic!("a progressive encoding");
        };
        assert_eq!(reveal.weight(5, 6, 9.0 / 12.0), 0.0);
        assert_eq!(reveal.weight(5, 6, 10.0 / 12.0), 1.0);
    }

    #[test]
    fn networks_on_prefixes_see_their_block_and_those_before() {
        let encoding = NetworkConfig::authors().encoding;
        let waves = Waves {
            rows: vec![[0.0; 3]; 253],
            ..Waves::NONE
        };
        let masks = Mask::all_at(&encoding, &waves, 0.0);
        let sizes: Vec<usize> = masks.iter().map(Mask::n_features).collect();
        assert_eq!(sizes, [6, 56, 106, 156, 206, 256]);
        assert!(masks
            .iter()
            .all(|mask| mask.alpha.iter().all(|&a| a == 1.0)));
        let outputs: Vec<f32> = masks.iter().map(Mask::output).collect();
        assert_eq!(outputs, [1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(
            Mask::all_at(&NetworkConfig::paper().encoding, &waves, 0.0).len(),
            1
        );
    }
}
