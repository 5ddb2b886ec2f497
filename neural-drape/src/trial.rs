//! Settings for the short runs on a stand-in: one that tells what a start is worth, and one that leads it.

use crate::network::NetworkConfig;
use crate::{DrapeConfig, LearningRate, ParametrizationConfig, Stage, VerticesConfig};

/// Iterations of a trial, of all its stages together.
const N_ITERATIONS: usize = 150;
/// The largest step.
const STEP: f64 = 2e-2;
/// Samples on each side.
const N_SAMPLES: usize = 1000;
/// Iterations of a guide, of all its stages together.
const N_GUIDING: usize = 300;

impl DrapeConfig {
    /// This run in short, on explicit vertices and without its last stage: what it comes to on a stand-in of a thousand
    /// vertices tells which start, or which setting, is worth a whole run.
    #[must_use]
    pub fn trial(&self) -> Self {
        Self {
            parametrization: ParametrizationConfig::Vertices(VerticesConfig::standard()),
            learning_rate: LearningRate {
                peak: STEP,
                warm_up: 0,
                decay: 0.3,
            },
            ..self.in_short(N_ITERATIONS)
        }
    }

    /// This run in short, by a network of the source's positions whose low frequencies come first and without its last
    /// stage: a smooth map that brings whole parts to where they belong, before explicit vertices refine it.
    ///
    /// Source: Mesh Draping, "Progressive Positional Encoding", the network's part of the work.
    #[must_use]
    pub fn guide(&self) -> Self {
        Self {
            parametrization: ParametrizationConfig::Network(NetworkConfig::guide()),
            learning_rate: Self::network().learning_rate,
            ..self.in_short(N_GUIDING)
        }
    }

    /// All stages in about `n_iterations` together, with few samples.
    fn in_short(&self, n_iterations: usize) -> Self {
        let n: usize = self.n_iterations().max(1);
        let stages = self.stages.iter().map(|stage| Stage {
            n_iterations: (stage.n_iterations * n_iterations / n).max(1),
            ..*stage
        });
        let mut config = Self {
            stages: stages.collect(),
            repair: false,
            contact: None,
            ..self.clone()
        };
        config.sampling.n_samples = N_SAMPLES;
        config.sampling.double_every = None;
        config.sampling.max_samples = N_SAMPLES;
        config
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_trial_has_all_stages_in_short() {
        let run = DrapeConfig::standard();
        let trial = run.trial();
        assert!(trial.check().is_ok());
        assert_eq!(trial.stages.len(), run.stages.len());
        assert_eq!(trial.n_iterations(), N_ITERATIONS - 1);
        for (short, long) in trial.stages.iter().zip(&run.stages) {
            assert_eq!((short.from, short.to), (long.from, long.to));
        }
        let paper = DrapeConfig::paper().trial();
        assert!(matches!(
            paper.parametrization,
            ParametrizationConfig::Vertices(_)
        ));
    }
}
