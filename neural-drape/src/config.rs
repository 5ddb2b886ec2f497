//! Every setting of a drape. Lengths are in the unit frame of the target: its longest side is 1.

use mesh_core::Triangulation;
use mesh_loss::{Overlap, SamplingConfig};
use serde::{Deserialize, Serialize};

use crate::contact::ContactConfig;
use crate::network::{NetworkConfig, Shapes};
use crate::schedule::{LearningRate, Stage};
use crate::vertices::{Vertices, VerticesConfig};
use crate::{DrapeError, Parametrization};

/// Settings of [`crate::Drape`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DrapeConfig {
    /// Seed of every random draw.
    pub seed: u64,
    /// What is optimised.
    pub parametrization: ParametrizationConfig,
    /// The step length of the optimiser over the run.
    pub learning_rate: LearningRate,
    /// Whether distance and structure are descended in turn (the paper) or as one sum.
    pub descent: Descent,
    /// The shape whose corner angles are kept.
    pub angle_reference: AngleReference,
    /// How pairs are drawn.
    pub sampling: Sampling,
    /// Whether one shape reaches beyond the other.
    pub overlap: OverlapMode,
    /// Which share of the distances counts as worst, 0..=1.
    pub worst_share: f64,
    /// A distance up to this is never counted as worst, in longest sides of the target.
    pub worst_tolerance: f64,
    /// Triangles with a smaller Q_f (Eq. 4) are skinny, 0..=1.
    pub skinny_threshold: f64,
    /// Cosine of the angle between neighbours' normals at which the fold barrier begins, −1..=1.
    pub fold_limit: f64,
    /// Whether [`crate::Drape::finish`] takes out new folds and new skinny triangles.
    pub repair: bool,
    /// How the surface is kept from running through itself; none: it is not, until [`crate::Drape::finish`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact: Option<ContactConfig>,
    /// The run, stage after stage.
    pub stages: Vec<Stage>,
}

impl DrapeConfig {
    /// How many iterations a run has.
    pub fn n_iterations(&self) -> usize {
        self.stages.iter().map(|s| s.n_iterations).sum()
    }
}

/// What is optimised.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ParametrizationConfig {
    /// The paper's network over a progressive encoding of the initial positions.
    Network(NetworkConfig),
    /// The vertices themselves, preconditioned.
    Vertices(VerticesConfig),
}

impl ParametrizationConfig {
    /// The map that moves `shapes.initial`, in the unit frame, with its optimiser.
    pub(crate) fn build(
        &self,
        triangulation: &Triangulation,
        shapes: Shapes<'_>,
        seed: u64,
    ) -> Result<Box<dyn Parametrization>, DrapeError> {
        match self {
            Self::Network(network) => network.build(shapes, seed),
            Self::Vertices(vertices) => Ok(Box::new(Vertices::new(
                triangulation,
                shapes.initial,
                vertices,
            )?)),
        }
    }
}

/// How the terms are descended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Descent {
    /// Two optimiser steps an iteration: the distance terms, then the structural ones (the paper). The penalty on skinny
    /// triangles, which the paper gives to neither, counts in both (the authors' program).
    Alternating,
    /// One step on the sum.
    Combined,
}

/// Which shape gives the angles that [`mesh_loss::CornerAngle`] keeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AngleReference {
    /// The source as given (the paper).
    Rest,
    /// The initial deformation (the authors' program).
    Initial,
}

/// Whether one shape reaches beyond the other; what lies beyond is not pulled to the other's open boundary.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum OverlapMode {
    /// Each that does so by more than a twentieth of its area in the initial shape. Where neither does, a source that ends
    /// openly is matched as if it did for the first quarter of the run: only pairs that surely belong together lead it.
    Auto,
    /// Neither: both shapes are whole.
    Full,
    /// The source covers only a part of the target, as a mask does.
    SourcePartial,
    /// The target covers only a part of the source, as a scan does.
    TargetPartial,
    /// Each has parts that the other lacks.
    #[serde(alias = "both")]
    BothPartial,
}

/// How pairs of points are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sampling {
    /// Samples on each side at the start.
    pub n_samples: usize,
    /// They double with every this many iterations ...
    pub double_every: Option<usize>,
    /// ... up to this many.
    pub max_samples: usize,
    /// They stay where they are for this many iterations, ≥ 1: 1 draws them anew each time. Those that are drawn by area move
    /// on as areas change.
    pub keep_for: usize,
    /// Share of the mesh's samples drawn by face instead of by area, 0..=1.
    pub face_uniform: f64,
    /// Pairs count by clamp(n·n′ + bias, 0.05, 1); without it all count 1.
    pub normal_bias: Option<f64>,
    /// Corners of each shape that the worst distance keeps in mind.
    pub n_hard: usize,
}

/// Each period of [`Sampling::keep_for`] has so many random words of its own.
const WORDS_PER_PERIOD: u128 = 1 << 40;

impl Sampling {
    /// Where in its sequence the generator draws the samples of an iteration from; none where it just goes on.
    pub(crate) fn draws_from(&self, iteration: usize) -> Option<u128> {
        let period = iteration / self.keep_for;
        (self.keep_for > 1).then(|| (1 + period as u128) * WORDS_PER_PERIOD)
    }

    pub(crate) fn at(&self, iteration: usize, overlap: Overlap, mutual: f64) -> SamplingConfig {
        let doublings = self.double_every.map_or(0, |every| iteration / every);
        let factor = 1usize
            .checked_shl(doublings.min(40) as u32)
            .unwrap_or(usize::MAX);
        SamplingConfig {
            n_samples: self
                .n_samples
                .saturating_mul(factor)
                .min(self.max_samples.max(self.n_samples)),
            face_uniform: self.face_uniform,
            normal_bias: self.normal_bias,
            n_hard: self.n_hard,
            overlap,
            mutual,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_double_with_every_so_many_iterations_up_to_the_most() {
        let sampling = Sampling {
            n_samples: 1000,
            double_every: Some(400),
            max_samples: 5000,
            ..DrapeConfig::standard().sampling
        };
        let n = |sampling: Sampling, iteration| {
            let overlap = Overlap::default();
            sampling.at(iteration, overlap, 1.0).n_samples
        };
        let iterations = [0, 399, 400, 799, 800, 1199, 1200, 100_000];
        let expected = [1000, 1000, 2000, 2000, 4000, 4000, 5000, 5000];
        assert_eq!(iterations.map(|i| n(sampling, i)), expected);

        let constant = Sampling {
            double_every: None,
            ..sampling
        };
        assert_eq!(iterations.map(|i| n(constant, i)), [1000; 8]);
        // A bound below the start does not bind.
        let bound_below = Sampling {
            max_samples: 10,
            ..sampling
        };
        assert_eq!(iterations.map(|i| n(bound_below, i)), [1000; 8]);
    }

    #[test]
    fn samples_that_stay_are_drawn_from_the_same_words_for_so_many_iterations() {
        let sampling = Sampling {
            keep_for: 100,
            ..DrapeConfig::standard().sampling
        };
        let from = |iteration| sampling.draws_from(iteration);
        assert_eq!(from(0), from(99));
        assert_eq!(from(100), from(199));
        assert!(from(0) < from(100) && from(1399) < from(1400));
        let anew = Sampling {
            keep_for: 1,
            ..sampling
        };
        assert_eq!([0, 1, 700].map(|i| anew.draws_from(i)), [None; 3]);
    }
}
