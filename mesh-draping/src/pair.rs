//! Source, target and landmarks together.

use mesh_core::{Landmark, Positions};
use mesh_metrics::{evaluate, EvaluationConfig, EvaluationInput, Report};

use crate::landmarks::{examine, Finding};
use crate::{Error, Source, Target};

/// Everything that a drape starts from. Cloning is cheap but for the landmarks.
#[derive(Clone)]
pub struct Pair {
    /// The mesh to deform.
    pub source: Source,
    /// The shape to drape over.
    pub target: Target,
    /// Places that belong together.
    pub landmarks: Vec<Landmark>,
}

impl Pair {
    /// What is probably wrong with the landmarks.
    pub fn findings(&self) -> Vec<Finding> {
        examine(self)
    }

    /// Judges a shape of the source by every measure of [`mesh_metrics`], against `truth` too where it is known; both in
    /// the target's coordinates, one position per vertex of the source.
    ///
    /// # Errors
    /// Positions of another mesh, or a coordinate that is not finite.
    pub fn judge(&self, draped: &Positions, truth: Option<&Positions>) -> Result<Report, Error> {
        let input = EvaluationInput {
            mesh: self.source.mesh(),
            rest: self.source.rest(),
            draped,
            target: self.target.judged().as_ref(),
            landmarks: &self.landmarks,
            truth,
        };
        Ok(evaluate(input, &EvaluationConfig::standard())?)
    }
}
