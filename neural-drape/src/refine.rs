//! Settings for a shape that is nearly draped.

use crate::{ContactConfig, DrapeConfig, LearningRate, ParametrizationConfig, Stage};

/// The largest step of the refinement beside that of the run.
const STEP: f64 = 0.3;

impl DrapeConfig {
    /// The end of this run over again in `n_iterations`: its last weights and samples, its finest steps, which get smaller all the
    /// way. For a start that a coarse mesh has draped ([`mesh_core::Proxy`]).
    #[must_use]
    pub fn refining(&self, n_iterations: usize) -> Self {
        let mut config = self.clone();
        if let Some(&Stage { to, .. }) = self.stages.last() {
            config.stages = vec![Stage {
                n_iterations,
                from: to,
                to,
            }];
        }
        config.contact = self.contact.map(|contact| ContactConfig {
            from: 0.0,
            ..contact
        });
        config.learning_rate = LearningRate {
            peak: STEP * self.learning_rate.peak,
            warm_up: 0,
            decay: 1.0,
        };
        config.sampling.n_samples = self.sampling.max_samples.max(self.sampling.n_samples);
        config.sampling.double_every = None;
        if let ParametrizationConfig::Vertices(vertices) = &mut config.parametrization {
            vertices.smoothing_start = vertices.smoothing_end;
            vertices.n_levels = 1;
        }
        config
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refinement_ends_as_the_run_does() {
        let run = DrapeConfig::standard();
        let refinement = run.refining(40);
        assert!(refinement.check().is_ok());
        let [stage] = refinement.stages[..] else {
            panic!("one stage")
        };
        assert_eq!((stage.n_iterations, stage.from), (40, stage.to));
        assert_eq!(run.stages.last().map(|s| s.to), Some(stage.to));
        assert_eq!(refinement.sampling.n_samples, run.sampling.max_samples);
        assert!(refinement.learning_rate.at(0, 40) < run.learning_rate.peak);
    }
}
