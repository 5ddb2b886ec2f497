//! Every setting of a drape. Lengths are in the unit frame of the target: its longest side is 1.

use mesh_loss::{Overlap, SamplingConfig};
use serde::{Deserialize, Serialize};

use crate::network::NetworkConfig;
use crate::VerticesConfig;

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
    /// The run, stage after stage.
    pub stages: Vec<Stage>,
}

impl DrapeConfig {
    /// How many iterations a run has.
    pub fn n_iterations(&self) -> usize {
        self.stages.iter().map(|s| s.n_iterations).sum()
    }

    pub(crate) fn weights_at(&self, iteration: usize) -> Weights {
        let mut start = 0;
        for stage in &self.stages {
            if iteration < start + stage.n_iterations {
                let t = (iteration - start) as f64 / stage.n_iterations as f64;
                return Weights::between(&stage.from, &stage.to, t);
            }
            start += stage.n_iterations;
        }
        self.stages.last().map_or(Weights::ZERO, |s| s.to)
    }

    /// The iteration at which each stage starts.
    pub(crate) fn stage_starts(&self) -> Vec<usize> {
        self.stages
            .iter()
            .scan(0, |next, stage| {
                let start = *next;
                *next += stage.n_iterations;
                Some(start)
            })
            .collect()
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

/// Adam's step length over the run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LearningRate {
    /// The largest value.
    pub peak: f64,
    /// Iterations over which it rises linearly to the peak.
    pub warm_up: usize,
    /// Share of the run at its end over which it falls linearly to 0; 0..=1.
    pub decay: f64,
}

impl LearningRate {
    /// The step length at an iteration counted from 0.
    pub fn at(&self, iteration: usize, n_iterations: usize) -> f64 {
        let rise = (iteration + 1) as f64 / (self.warm_up + 1) as f64;
        let left = (n_iterations - iteration) as f64 / n_iterations.max(1) as f64;
        let fall = if self.decay > 0.0 {
            left / self.decay
        } else {
            1.0
        };
        self.peak * rise.min(1.0) * fall.min(1.0)
    }
}

/// How the terms are descended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Descent {
    /// Two optimiser steps an iteration: the distance terms, then the structural ones (the paper).
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
    /// Share of the mesh's samples drawn by face instead of by area, 0..=1.
    pub face_uniform: f64,
    /// Pairs count by clamp(n·n′ + bias, 0.05, 1); without it all count 1.
    pub normal_bias: Option<f64>,
    /// Corners of each shape that the worst distance keeps in mind.
    pub n_hard: usize,
}

impl Sampling {
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

/// A part of the run whose weights go from one set to another.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stage {
    /// How many iterations it takes.
    pub n_iterations: usize,
    /// Weights at its start.
    pub from: Weights,
    /// Weights at its end; in between they follow a straight line.
    pub to: Weights,
}

/// Weights of the terms; a term of weight 0 is not computed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Weights {
    /// [`mesh_loss::Chamfer`]
    pub chamfer: f64,
    /// [`mesh_loss::WorstDistance`]
    pub worst_distance: f64,
    /// [`mesh_loss::NormalAgreement`]
    pub normal_agreement: f64,
    /// [`mesh_loss::LandmarkDistance`]
    pub landmark: f64,
    /// [`mesh_loss::CornerAngle`]
    pub corner_angle: f64,
    /// [`mesh_loss::AreaKl`]
    pub area_kl: f64,
    /// [`mesh_loss::TriangleQuality`]
    pub triangle_quality: f64,
    /// [`mesh_loss::Flip`]
    pub flip: f64,
    /// [`mesh_loss::FoldBarrier`]
    pub fold_barrier: f64,
    /// [`mesh_loss::Conformal`]
    pub conformal: f64,
    /// [`mesh_loss::LocalShape`]
    pub local_shape: f64,
    /// [`mesh_loss::Drift`], from where each stage starts
    pub drift: f64,
}

impl Weights {
    /// Nothing counts.
    pub const ZERO: Self = Self {
        chamfer: 0.0,
        worst_distance: 0.0,
        normal_agreement: 0.0,
        landmark: 0.0,
        corner_angle: 0.0,
        area_kl: 0.0,
        triangle_quality: 0.0,
        flip: 0.0,
        fold_barrier: 0.0,
        conformal: 0.0,
        local_shape: 0.0,
        drift: 0.0,
    };

    pub(crate) fn between(a: &Self, b: &Self, t: f64) -> Self {
        let mix = |a: f64, b: f64| a + (b - a) * t;
        Self {
            chamfer: mix(a.chamfer, b.chamfer),
            worst_distance: mix(a.worst_distance, b.worst_distance),
            normal_agreement: mix(a.normal_agreement, b.normal_agreement),
            landmark: mix(a.landmark, b.landmark),
            corner_angle: mix(a.corner_angle, b.corner_angle),
            area_kl: mix(a.area_kl, b.area_kl),
            triangle_quality: mix(a.triangle_quality, b.triangle_quality),
            flip: mix(a.flip, b.flip),
            fold_barrier: mix(a.fold_barrier, b.fold_barrier),
            conformal: mix(a.conformal, b.conformal),
            local_shape: mix(a.local_shape, b.local_shape),
            drift: mix(a.drift, b.drift),
        }
    }
}
