//! Positional encoding: x and waves of x, low frequencies revealed first.

use rand::Rng;
use rand_chacha::ChaCha8Rng;

use super::config::{Encoding, Frequencies, Reveal};

/// Factor inside the authors' sine, `sin(30 W x)`: W stays small and trains at the rate of the other weights
/// (Sitzmann et al. 2020).
const SINE_GAIN: f32 = 30.0;

/// The waves of an encoding: functions of a point, in order of frequency.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Waves {
    /// One frequency vector for each row.
    pub(crate) rows: Vec<[f32; 3]>,
    /// Factor between `row · x` and the phase, in radians.
    pub(crate) gain: f32,
    /// What is taken of a phase.
    pub(crate) kind: WaveKind,
}

/// What is taken of a phase.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum WaveKind {
    /// Its sine: one feature.
    Sine,
    /// Its sine, then its cosine: two features.
    SineCosine,
}

impl WaveKind {
    /// How many features a phase gives.
    pub(crate) const fn n_features(self) -> usize {
        match self {
            Self::Sine => 1,
            Self::SineCosine => 2,
        }
    }
}

impl Waves {
    /// No waves: the features of a point are its coordinates.
    pub(crate) const NONE: Self = Self {
        rows: Vec::new(),
        gain: 1.0,
        kind: WaveKind::Sine,
    };

    /// The waves of `encoding`, drawn from `rng` and sorted by frequency.
    pub(super) fn draw(encoding: &Encoding, rng: &mut ChaCha8Rng) -> Self {
        match encoding.frequencies() {
            None => Self::NONE,
            Some(Frequencies::Uniform { count, max, .. }) => Self {
                rows: uniform_rows(count, max as f32 / SINE_GAIN, rng),
                gain: SINE_GAIN,
                kind: WaveKind::Sine,
            },
            Some(Frequencies::Gaussian { count, deviation }) => Self {
                rows: gaussian_rows(count, deviation as f32, rng),
                gain: 1.0,
                kind: WaveKind::SineCosine,
            },
        }
    }

    /// How many features a point has: its coordinates and its waves.
    pub(crate) fn n_features(&self) -> usize {
        3 + self.rows.len() * self.kind.n_features()
    }

    /// The first `features.len()` features of `point`, and with `slopes` the derivative of each by its phase.
    pub(super) fn encode(
        &self,
        point: &[f32; 3],
        features: &mut [f32],
        mut slopes: Option<&mut [f32]>,
    ) {
        let (coordinates, waves) = features.split_at_mut(3);
        coordinates.copy_from_slice(point);
        let per_row = self.kind.n_features();
        for (k, (values, row)) in waves.chunks_mut(per_row).zip(&self.rows).enumerate() {
            let (sin, cos) = (self.gain * dot(row, point)).sin_cos();
            values.copy_from_slice(&[sin, cos][..values.len()]);
            if let Some(slopes) = &mut slopes {
                let start = 3 + k * per_row;
                slopes[start..start + values.len()].copy_from_slice(&[cos, -sin][..values.len()]);
            }
        }
    }
}

impl Encoding {
    /// The waves' description, if there are any.
    pub(super) fn frequencies(&self) -> Option<Frequencies> {
        match *self {
            Self::None => None,
            Self::Static(frequencies) | Self::Progressive { frequencies, .. } => Some(frequencies),
        }
    }

    /// Whether the optimiser moves the frequencies.
    pub(super) fn is_trainable(&self) -> bool {
        matches!(
            self.frequencies(),
            Some(Frequencies::Uniform {
                trainable: true,
                ..
            })
        )
    }

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
            Self::HoldAndFade => 2.0 * n_blocks * progress - (2.0 * block - 1.0),
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

/// Entries uniform in ±`bound`, each column sorted by magnitude.
fn uniform_rows(count: usize, bound: f32, rng: &mut ChaCha8Rng) -> Vec<[f32; 3]> {
    let columns = [(); 3].map(|()| {
        let mut column: Vec<f32> = (0..count)
            .map(|_| bound * rng.random_range(-1.0..1.0))
            .collect();
        column.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
        column
    });
    (0..count)
        .map(|row| [0, 1, 2].map(|axis| columns[axis][row]))
        .collect()
}

/// Normal entries, rows sorted by length.
fn gaussian_rows(count: usize, deviation: f32, rng: &mut ChaCha8Rng) -> Vec<[f32; 3]> {
    let mut rows: Vec<[f32; 3]> = (0..count)
        .map(|_| [(); 3].map(|()| deviation * normal(rng)))
        .collect();
    rows.sort_by(|a, b| dot(a, a).total_cmp(&dot(b, b)));
    rows
}

/// A standard normal number (Box and Muller).
fn normal(rng: &mut ChaCha8Rng) -> f32 {
    let radius = (-2.0 * (1.0 - rng.random::<f64>()).ln()).sqrt();
    (radius * (std::f64::consts::TAU * rng.random::<f64>()).cos()) as f32
}

fn dot(a: &[f32; 3], b: &[f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::NetworkConfig;
    use rand::SeedableRng;

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
    fn rows_are_sorted_by_frequency() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let waves = Waves::draw(&NetworkConfig::paper().encoding, &mut rng);
        let highest = waves
            .rows
            .iter()
            .flatten()
            .fold(0.0f32, |m, w| m.max(w.abs()));
        assert!(waves
            .rows
            .windows(2)
            .all(|p| (0..3).all(|a| p[0][a].abs() <= p[1][a].abs())));
        assert!(highest * waves.gain <= 10.0);

        let waves = Waves::draw(&NetworkConfig::standard().encoding, &mut rng);
        assert!(waves
            .rows
            .windows(2)
            .all(|p| dot(&p[0], &p[0]) <= dot(&p[1], &p[1])));
    }

    #[test]
    fn a_point_is_encoded_as_itself_and_its_waves() {
        let waves = Waves {
            rows: vec![[1.0, 0.0, 0.0], [0.0, 2.0, 0.0]],
            gain: 1.0,
            kind: WaveKind::SineCosine,
        };
        let mut features = [0.0; 7];
        let mut slopes = [0.0; 7];
        waves.encode(&[0.5, 0.25, -1.0], &mut features, Some(&mut slopes));
        let (sin, cos) = 0.5f32.sin_cos();
        assert_eq!(features, [0.5, 0.25, -1.0, sin, cos, sin, cos]);
        assert_eq!(slopes[3..], [cos, -sin, cos, -sin]);
    }
}
