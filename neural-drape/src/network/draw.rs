//! The waves of an encoding, drawn from a seed and sorted by frequency.

use rand::Rng;
use rand_chacha::ChaCha8Rng;

use super::config::{Encoding, Frequencies};
use super::encoding::{dot, WaveKind, Waves};

/// Factor inside the authors' sine, `sin(30 W x)`: W stays small and trains at the rate of the other weights
/// (Sitzmann et al. 2020).
const SINE_GAIN: f32 = 30.0;

impl Waves {
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
}

impl Encoding {
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

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;
    use crate::network::NetworkConfig;

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
}
