//! Source, target and landmarks together.

use mesh_core::{Landmark, Positions};
use mesh_init::InitError;
use mesh_metrics::{evaluate, EvaluationConfig, EvaluationInput, Report};
use neural_drape::network::NetworkMap;
use neural_drape::{DrapeError, Regions, Warp, WarpInput};

use crate::landmarks::{examine, Finding};
use crate::{Error, Note, Source, Target};

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
    /// What a drape from `initial` to `draped` does to space, to do it to other points; through `network`, if that moved
    /// the vertices. Both shapes are in the target's coordinates.
    ///
    /// # Errors
    /// The map cannot be made of these shapes.
    pub fn warp(
        &self,
        initial: &Positions,
        draped: &Positions,
        network: Option<NetworkMap>,
    ) -> Result<Warp, Error> {
        Ok(Warp::new(WarpInput {
            triangulation: self.source.triangulation(),
            rest: self.source.rest(),
            initial,
            draped,
            network,
        })?)
    }

    /// What is probably wrong with the landmarks.
    pub fn findings(&self) -> Vec<Finding> {
        examine(self)
    }

    /// How many landmarks count: those of curves too, those of weight 0 not.
    pub(crate) fn n_followed(&self) -> usize {
        self.landmarks.iter().filter(|l| l.is_followed()).count()
    }

    /// What was found in the files of both shapes, and what was left out of the target.
    pub fn notes(&self) -> Vec<Note> {
        let mut notes = self.source.notes();
        notes.extend_from_slice(self.target.notes());
        notes
    }

    /// Judges a shape of the source by every measure of [`mesh_metrics`], against `truth` too where it is known; both in
    /// the target's coordinates, one position per vertex of the source.
    ///
    /// # Errors
    /// Positions of another mesh, or a coordinate that is not finite.
    pub fn judge(&self, draped: &Positions, truth: Option<&Positions>) -> Result<Report, Error> {
        let input = EvaluationInput {
            triangulation: self.source.triangulation(),
            rest: self.source.rest(),
            draped,
            target: self.target.judged().as_ref(),
            landmarks: &self.landmarks,
            truth,
        };
        Ok(evaluate(input, &EvaluationConfig::standard())?)
    }

    /// Whether landmarks name vertices that the source has.
    pub(crate) fn check_landmarks(&self, landmarks: &[Landmark]) -> Result<(), InitError> {
        let n_vertices = self.source.rest().len();
        for (landmark, l) in landmarks.iter().enumerate() {
            let beyond = l.source.vertices.iter().find(|v| v.index() >= n_vertices);
            if let Some(v) = beyond {
                return Err(InitError::LandmarkOutOfRange {
                    landmark,
                    vertex: v.index(),
                    n_vertices,
                });
            }
        }
        Ok(())
    }

    /// Whether there is an entry for each vertex of the source.
    pub(crate) fn check_lengths(
        &self,
        regions: &Regions,
        truth: Option<&Positions>,
    ) -> Result<(), DrapeError> {
        let expected = self.source.rest().len();
        self.check_each([
            ("the attraction of the regions", regions.attraction.len()),
            ("the rigid regions", regions.rigid.len()),
            ("the truth", truth.map_or(expected, Positions::len)),
        ])
    }

    pub(crate) fn check_each<const N: usize>(
        &self,
        lengths: [(&'static str, usize); N],
    ) -> Result<(), DrapeError> {
        let expected = self.source.rest().len();
        match lengths.into_iter().find(|(_, found)| *found != expected) {
            Some((what, found)) => Err(DrapeError::LengthMismatch {
                what,
                found,
                expected,
            }),
            None => Ok(()),
        }
    }
}
