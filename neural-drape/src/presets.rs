//! Named settings.
//!
//! The losses of the authors' program live in a frame whose longest side is 20; ours is 1. Weights below are theirs
//! times 20 for lengths and 400 for squared lengths.

use crate::network::NetworkConfig;
use crate::{
    AngleReference, Descent, DrapeConfig, DrapeError, LearningRate, OverlapMode,
    ParametrizationConfig, Sampling, Stage, VerticesConfig, Weights,
};

/// Longest side of the authors' frame.
const AUTHORS_SIDE: f64 = 20.0;
/// λ of Eq. 1 in the first 1000 iterations, and in the rest ("Implementation Details").
const LAMBDA_PAPER: [f64; 2] = [1.0, 0.2];
/// λ while landmarks and structure lead, and while the fit does.
const LAMBDA_STANDARD: [f64; 2] = [1.0, 0.3];

impl DrapeConfig {
    /// The names that [`Self::named`] knows, the default first.
    pub const PRESETS: [&'static str; 5] = ["standard", "quick", "network", "paper", "authors"];

    /// The preset of this name, or the study ([`Self::studies`]).
    ///
    /// # Errors
    /// There is no such preset.
    pub fn named(name: &str) -> Result<Self, DrapeError> {
        match name {
            "standard" => Ok(Self::standard()),
            "quick" => Ok(Self::quick()),
            "network" => Ok(Self::network()),
            "paper" => Ok(Self::paper()),
            "authors" => Ok(Self::authors()),
            _ => {
                let study = Self::studies().into_iter().find(|s| s.name == name);
                study
                    .map(|s| s.config)
                    .ok_or_else(|| DrapeError::UnknownPreset {
                        name: name.to_owned(),
                        known: Self::PRESETS.join(", "),
                    })
            }
        }
    }

    /// The default: preconditioned vertices, from coarse to fine.
    ///
    /// Landmarks and structure lead for a third of the run; then the fit does, more and more by its worst places. A mean
    /// over few samples is enough until then: they double twice.
    pub fn standard() -> Self {
        Self {
            seed: 0,
            parametrization: ParametrizationConfig::Vertices(VerticesConfig::standard()),
            learning_rate: LearningRate {
                peak: 1e-2,
                warm_up: 0,
                decay: 0.3,
            },
            descent: Descent::Combined,
            angle_reference: AngleReference::Rest,
            sampling: Sampling {
                n_samples: 1000,
                double_every: Some(400),
                max_samples: 4000,
                keep_for: 1,
                face_uniform: 0.5,
                normal_bias: Some(0.3),
                n_hard: 100,
            },
            overlap: OverlapMode::Auto,
            worst_share: 0.003,
            worst_tolerance: 0.006,
            skinny_threshold: 0.2,
            fold_limit: 0.3,
            repair: true,
            contact: None,
            stages: standard_stages(330, 670),
        }
    }

    /// A fifth of [`Self::standard`] in longer steps, to look at: near the target, with angles less well kept.
    pub fn quick() -> Self {
        let standard = Self::standard();
        Self {
            learning_rate: LearningRate {
                peak: 2e-2,
                ..standard.learning_rate
            },
            sampling: Sampling {
                double_every: Some(100),
                max_samples: 2000,
                ..standard.sampling
            },
            stages: standard_stages(60, 140),
            ..standard
        }
    }

    /// The network with the terms of [`Self::standard`], and all its samples from the start.
    pub fn network() -> Self {
        let standard = Self::standard();
        Self {
            parametrization: ParametrizationConfig::Network(NetworkConfig::standard()),
            learning_rate: LearningRate {
                peak: 3e-3,
                warm_up: 30,
                decay: 0.6,
            },
            sampling: Sampling {
                n_samples: standard.sampling.max_samples,
                double_every: None,
                ..standard.sampling
            },
            ..standard
        }
    }

    /// The paper as printed: its network, schedule and terms, 1000 + 500 iterations.
    ///
    /// Where it is silent, one choice is made for each thing, most after the authors' program: docs/paper.md has the table. No
    /// term that the paper does not have counts: none of normals, none of flips.
    pub fn paper() -> Self {
        let first = Weights {
            chamfer: AUTHORS_SIDE,
            landmark: 100.0 * AUTHORS_SIDE * AUTHORS_SIDE,
            triangle_quality: 0.1,
            ..Weights::ZERO.with_lambda(LAMBDA_PAPER[0])
        };
        let second = Weights {
            landmark: 10.0 * AUTHORS_SIDE * AUTHORS_SIDE,
            ..first.with_lambda(LAMBDA_PAPER[1])
        };
        let constant = |n_iterations, weights| Stage {
            n_iterations,
            from: weights,
            to: weights,
        };
        Self {
            seed: 0,
            parametrization: ParametrizationConfig::Network(NetworkConfig::paper()),
            learning_rate: LearningRate {
                peak: 1e-3,
                warm_up: 0,
                decay: 0.0,
            },
            descent: Descent::Alternating,
            angle_reference: AngleReference::Rest,
            sampling: Sampling {
                n_samples: 3000,
                double_every: Some(100),
                max_samples: 10_000,
                keep_for: 1,
                face_uniform: 0.0,
                normal_bias: None,
                n_hard: 0,
            },
            overlap: OverlapMode::Full,
            worst_share: 0.01,
            worst_tolerance: 0.0,
            skinny_threshold: 0.1,
            fold_limit: 0.3,
            repair: false,
            contact: None,
            stages: vec![constant(1000, first), constant(500, second)],
        }
    }

    /// The authors' program, which differs from their paper: six networks on prefixes of the encoding, summed; corner angles of
    /// the initial shape; normals that agree; faces that do not flip, a term that fades within each stage; half of the
    /// samples by face, all of them kept for 100 iterations. 1500 of its 1000 + 1000 iterations.
    ///
    /// Departures: a residual output in place of the training to the identity; samples of the target by area alone;
    /// distances to surfaces, where the program's are between samples.
    pub fn authors() -> Self {
        let paper = Self::paper();
        let stages = paper.stages.iter().zip([1.0, 0.5]).map(|(stage, done)| {
            let flip = stage.from.corner_angle;
            let from = Weights {
                normal_agreement: 0.2,
                flip,
                ..stage.from
            };
            let to = Weights {
                flip: flip * (1.0 - done),
                ..from
            };
            Stage { from, to, ..*stage }
        });
        Self {
            parametrization: ParametrizationConfig::Network(NetworkConfig::authors()),
            angle_reference: AngleReference::Initial,
            sampling: Sampling {
                face_uniform: 0.5,
                keep_for: 100,
                ..paper.sampling
            },
            stages: stages.collect(),
            ..paper
        }
    }
}

/// Landmarks and structure lead, then the fit, at last its worst places.
fn standard_stages(n_leading: usize, n_fitting: usize) -> Vec<Stage> {
    let start = Weights {
        chamfer: AUTHORS_SIDE,
        worst_distance: 0.1 * AUTHORS_SIDE,
        normal_agreement: 0.2,
        landmark: 10.0 * AUTHORS_SIDE * AUTHORS_SIDE,
        triangle_quality: 0.3,
        flip: 1.0,
        fold_barrier: 5.0,
        ..Weights::ZERO.with_lambda(LAMBDA_STANDARD[0])
    };
    let fit = Weights {
        worst_distance: 0.2 * AUTHORS_SIDE,
        landmark: 5.0 * AUTHORS_SIDE * AUTHORS_SIDE,
        flip: 0.0,
        drift: 15.0 * AUTHORS_SIDE * AUTHORS_SIDE,
        ..start.with_lambda(LAMBDA_STANDARD[1])
    };
    let end = Weights {
        worst_distance: 2.4 * AUTHORS_SIDE,
        landmark: 45.0 * AUTHORS_SIDE * AUTHORS_SIDE,
        drift: 7.5 * AUTHORS_SIDE * AUTHORS_SIDE,
        triangle_quality: 0.5,
        fold_barrier: 10.0,
        ..fit
    };
    vec![
        Stage {
            n_iterations: n_leading,
            from: start,
            to: Weights { flip: 0.0, ..start },
        },
        Stage {
            n_iterations: n_fitting,
            from: fit,
            to: end,
        },
    ]
}
