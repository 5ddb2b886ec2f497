//! Eq. 1: `L = L_d + λ L_s`, the loss that a drape descends.
//!
//! [`DistanceLoss`] is L_d (Eq. 2) and [`StructuralLoss`] is L_s (Eq. 3), each with the terms that go beyond the paper
//! beside its own. λ is the weight of the terms of Eq. 3 ([`Weights::lambda`]); its schedule are the stages of the
//! settings ([`DrapeConfig::weights_at`]).

use std::sync::Arc;

use mesh_core::{Landmark, Positions, Profile, Triangulation, Vector3, VertexData};
use mesh_loss::{
    AreaKl, Chamfer, Conformal, CornerAngle, Drift, Flip, FoldBarrier, LandmarkDistance,
    LocalShape, Loss, Matches, NormalAgreement, SmoothChange, TriangleQuality, WorstDistance,
};

use crate::config::{AngleReference, DrapeConfig};
use crate::schedule::Weights;

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

/// The value of Eq. 1: `L = L_d + λ L_s`, with λ and all other weights as they were in the iteration.
pub(crate) fn total(distance: &[TermReport], structure: &[TermReport]) -> f64 {
    let terms = distance.iter().chain(structure);
    terms.map(|t| t.weight * t.value).sum()
}

/// Adds the gradient of every term that counts and reports the term.
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

/// L_d (Eq. 2): the pairs of one iteration and the landmarks.
pub(crate) struct DistanceLoss<'a> {
    chamfer: Chamfer<'a>,
    landmarks: LandmarkDistance<'a>,
    worst: WorstDistance<'a>,
    normals: NormalAgreement<'a>,
}

impl<'a> DistanceLoss<'a> {
    pub(crate) fn new(
        matches: &'a Matches,
        landmarks: &'a [Landmark],
        config: &DrapeConfig,
    ) -> Self {
        Self {
            chamfer: Chamfer(matches),
            landmarks: LandmarkDistance(landmarks),
            worst: WorstDistance {
                matches,
                share: config.worst_share,
                tolerance: config.worst_tolerance,
            },
            normals: NormalAgreement(matches),
        }
    }

    /// Eq. 2, and between its terms what is beyond the paper.
    pub(crate) fn terms(&self, w: &Weights) -> [Term<'_>; 4] {
        [
            ("chamfer", w.chamfer, &self.chamfer),
            ("worst distance", w.worst_distance, &self.worst),
            ("normals", w.normal_agreement, &self.normals),
            ("landmarks", w.landmark, &self.landmarks),
        ]
    }
}

/// L_s (Eq. 3), angles and areas, with the terms beyond the paper that depend on the mesh alone; and beside it the penalty on
/// skinny triangles (Eq. 4), which belongs to neither side of Eq. 1.
pub(crate) struct StructuralLoss {
    corner_angle: CornerAngle,
    area_kl: AreaKl,
    triangle_quality: TriangleQuality,
    flip: Flip,
    fold_barrier: FoldBarrier,
    conformal: Conformal,
    local_shape: LocalShape,
    drift: Drift,
    smooth_change: SmoothChange,
}

impl StructuralLoss {
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
            smooth_change: SmoothChange::new(t, initial),
        }
    }

    /// Eq. 4 as a penalty.
    pub(crate) fn skinny(&self, w: &Weights) -> Term<'_> {
        ("skinny", w.triangle_quality, &self.triangle_quality)
    }

    /// Eq. 3, each term by λ, then Eq. 4 and what is beyond the paper.
    pub(crate) fn terms(&self, w: &Weights) -> [Term<'_>; 9] {
        [
            ("angles", w.corner_angle, &self.corner_angle),
            ("areas", w.area_kl, &self.area_kl),
            self.skinny(w),
            ("flips", w.flip, &self.flip),
            ("folds", w.fold_barrier, &self.fold_barrier),
            ("conformal", w.conformal, &self.conformal),
            ("local shape", w.local_shape, &self.local_shape),
            ("drift", w.drift, &self.drift),
            ("smooth change", w.smooth_change, &self.smooth_change),
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
