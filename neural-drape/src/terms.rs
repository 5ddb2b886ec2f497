//! The terms of the loss: those of the mesh alone, and how any is added and reported.

use std::sync::Arc;

use mesh_core::{Positions, Profile, Triangulation, Vector3, VertexData};
use mesh_loss::{
    AreaKl, Conformal, CornerAngle, Drift, Flip, FoldBarrier, LocalShape, Loss, TriangleQuality,
};

use crate::config::{AngleReference, DrapeConfig, Weights};

/// One term of the loss in one iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TermReport {
    /// The term.
    pub name: &'static str,
    /// Its value, unweighted.
    pub value: f64,
    /// Its weight.
    pub weight: f64,
}

/// Name, weight, term.
pub(crate) type Term<'t> = (&'static str, f64, &'t dyn Loss);

/// Adds every term that counts and reports it.
pub(crate) fn accumulate(
    terms: &[Term<'_>],
    x: &Positions,
    gradient: &mut VertexData<Vector3>,
    profile: &mut Profile,
) -> Vec<TermReport> {
    terms
        .iter()
        .filter(|(_, weight, _)| *weight > 0.0)
        .map(|&(name, weight, loss)| TermReport {
            name,
            value: profile.time(name, || loss.accumulate(x, weight, gradient)),
            weight,
        })
        .collect()
}

/// The terms that depend on the mesh alone.
pub(crate) struct Structure {
    corner_angle: CornerAngle,
    area_kl: AreaKl,
    triangle_quality: TriangleQuality,
    flip: Flip,
    fold_barrier: FoldBarrier,
    conformal: Conformal,
    local_shape: LocalShape,
    drift: Drift,
}

impl Structure {
    pub(crate) fn new(
        t: &Arc<Triangulation>,
        rest: &Positions,
        initial: &Positions,
        config: &DrapeConfig,
    ) -> Self {
        let angles = match config.angle_reference {
            AngleReference::Rest => rest,
            AngleReference::Initial => initial,
        };
        Self {
            corner_angle: CornerAngle::new(t, angles),
            area_kl: AreaKl::new(t, rest),
            triangle_quality: TriangleQuality::new(t, config.skinny_threshold),
            flip: Flip::new(t, initial),
            fold_barrier: FoldBarrier::new(t, rest, config.fold_limit),
            conformal: Conformal::new(t, rest),
            local_shape: LocalShape::new(t, rest),
            drift: Drift::new(t, initial),
        }
    }

    /// Eq. 3 and its companions.
    pub(crate) fn terms(&self, w: &Weights) -> [Term<'_>; 8] {
        [
            ("angles", w.corner_angle, &self.corner_angle),
            ("areas", w.area_kl, &self.area_kl),
            ("skinny", w.triangle_quality, &self.triangle_quality),
            ("flips", w.flip, &self.flip),
            ("folds", w.fold_barrier, &self.fold_barrier),
            ("conformal", w.conformal, &self.conformal),
            ("local shape", w.local_shape, &self.local_shape),
            ("drift", w.drift, &self.drift),
        ]
    }

    /// From here on, `x` is where vertices should not slide away from.
    pub(crate) fn anchor(&mut self, triangulation: &Triangulation, x: &Positions) {
        self.drift = Drift::new(triangulation, x);
    }

    /// Where vertices should not slide away from.
    pub(crate) fn anchored_at(&self) -> &Positions {
        self.drift.reference()
    }
}
