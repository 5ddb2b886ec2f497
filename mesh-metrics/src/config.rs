//! How a result is measured.

/// How densely surfaces are sampled.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct EvaluationConfig {
    /// Random points on each surface, beside its vertices.
    pub n_samples: usize,
    /// Same seed, same figures.
    pub seed: u64,
}

impl EvaluationConfig {
    /// 100 000 samples on each surface: another seed moves the Hausdorff distance by less than 0.001.
    pub const fn standard() -> Self {
        Self {
            n_samples: 100_000,
            seed: 0,
        }
    }
}
