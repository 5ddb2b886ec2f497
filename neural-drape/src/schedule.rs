//! What changes over a run: λ of Eq. 1 and the other weights, stage after stage, and the step length.

use serde::{Deserialize, Serialize};

use crate::DrapeConfig;

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
    /// [`mesh_loss::CornerAngle`], the first term of Eq. 3: λ of Eq. 1
    pub corner_angle: f64,
    /// [`mesh_loss::AreaKl`], the second term of Eq. 3: λ of Eq. 1
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
    /// [`mesh_loss::SmoothChange`], since the drape started
    #[serde(default)]
    pub smooth_change: f64,
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
        smooth_change: 0.0,
    };

    /// These weights with both terms of Eq. 3, angles and areas, at λ: `L = L_d + λ L_s` (Eq. 1).
    #[must_use]
    pub const fn with_lambda(self, lambda: f64) -> Self {
        Self {
            corner_angle: lambda,
            area_kl: lambda,
            ..self
        }
    }

    /// λ of Eq. 1; none where angles and areas differ in weight, so that no one factor stands before Eq. 3.
    pub fn lambda(&self) -> Option<f64> {
        (self.corner_angle == self.area_kl).then_some(self.corner_angle)
    }

    /// From `a` at t = 0 to `b` at t = 1 along a straight line.
    fn between(a: &Self, b: &Self, t: f64) -> Self {
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
            smooth_change: mix(a.smooth_change, b.smooth_change),
        }
    }
}

impl DrapeConfig {
    /// The weights of an iteration counted from 0, λ among them; those at the end of the last stage after it.
    pub fn weights_at(&self, iteration: usize) -> Weights {
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

    /// This run with a weight on [`mesh_loss::SmoothChange`] all the way.
    #[must_use]
    pub fn with_smooth_change(mut self, weight: f64) -> Self {
        for stage in &mut self.stages {
            stage.from.smooth_change = weight;
            stage.to.smooth_change = weight;
        }
        self
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
