//! Settings for a shape that is nearly draped.

use crate::{ContactConfig, DrapeConfig, LearningRate, ParametrizationConfig, Stage};

/// The largest step of the refinement beside that of the run.
const STEP: f64 = 0.3;
/// How much more angles and areas count where one body moves than between two bodies.
const SAME_BODY: f64 = 10.0;

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

    /// A run for the next frame of a motion, which starts from the one before: the last weights and samples, from coarse to
    /// fine as the whole run goes, so that a limb can slide back as one. Vertices slide to where angles and areas lead, which
    /// count more: one body keeps them while it moves ([`Drape::hold_to`](crate::Drape::hold_to)).
    #[must_use]
    pub fn following(&self, n_iterations: usize) -> Self {
        let mut config = Self {
            parametrization: self.parametrization.clone(),
            learning_rate: LearningRate {
                warm_up: 0,
                decay: 1.0,
                ..self.learning_rate
            },
            ..self.refining(n_iterations)
        };
        for stage in &mut config.stages {
            for weights in [&mut stage.from, &mut stage.to] {
                weights.corner_angle *= SAME_BODY;
                weights.area_kl *= SAME_BODY;
                weights.drift = 0.0;
            }
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

    #[test]
    fn in_a_motion_structure_leads_along_the_surface() {
        let refinement = DrapeConfig::standard().refining(40);
        let next = DrapeConfig::standard().following(40);
        assert!(next.check().is_ok());
        let (weights, before) = (next.weights_at(20), refinement.weights_at(20));
        assert!(before.drift > 0.0 && weights.drift == 0.0);
        assert_eq!(weights.lambda(), before.lambda().map(|l| SAME_BODY * l));
    }
}
