//! What may be changed between two steps: landmarks, regions, the present shape, the length of the run.
//!
//! Source: Mesh Draping, Interactive Mode.

use mesh_core::{Landmark, Positions, Vector3, VertexData};

use super::Drape;
use crate::input::{check_finite, check_landmarks, check_length};
use crate::objective::StructuralLoss;
use crate::regions::{Guidance, Regions};
use crate::schedule::Stage;
use crate::setting::MAX_COUNT;
use crate::DrapeError;

impl Drape {
    /// Replaces the landmarks from the next step on.
    ///
    /// # Errors
    /// A landmark names a vertex that is not there, or its place or target is not finite; the old landmarks stay.
    pub fn set_landmarks(&mut self, landmarks: &[Landmark]) -> Result<(), DrapeError> {
        check_landmarks(landmarks, self.gradient.len())?;
        self.landmarks = Landmark::followed(landmarks);
        for landmark in &mut self.landmarks {
            landmark.target = self.frame.to_unit(&landmark.target);
        }
        Ok(())
    }

    /// Moves every vertex by its entry, in the target's coordinates; the optimiser keeps its state.
    ///
    /// Source: Mesh Draping, Interactive Mode, where landmarks that are added deform the present result.
    ///
    /// # Errors
    /// Not one finite displacement per vertex; nothing moved.
    pub fn displace(&mut self, displacements: &VertexData<Vector3>) -> Result<(), DrapeError> {
        check_length("the displacement", displacements.len(), self.gradient.len())?;
        check_finite("the displacement", displacements.iter())?;
        let scale = self.frame.scale;
        self.parametrization
            .displace(&displacements.map(|d| d / scale));
        let x = self.parametrization.positions();
        self.structure.anchor(&self.triangulation, x);
        Ok(())
    }

    /// Holds angles, areas and folds to those of `shape` from now on, in the place of the rest shape's; its place, pose and
    /// scale do not count. What is broken in the end is still told by the rest shape.
    ///
    /// # Errors
    /// Not one position per vertex; nothing changed.
    pub fn hold_to(&mut self, shape: &Positions) -> Result<(), DrapeError> {
        check_length("the shape to hold to", shape.len(), self.initial.len())?;
        let anchored_at = self.structure.anchored_at().clone();
        let (triangulation, initial) = (&self.triangulation, &self.initial);
        self.structure = StructuralLoss::new(triangulation, shape, initial, &self.config);
        self.structure.anchor(triangulation, &anchored_at);
        Ok(())
    }

    /// Adds iterations to the run, with the weights that it would have ended with; vertices stay anchored where they
    /// were. A run has at most 10⁹ iterations.
    pub fn extend(&mut self, n_iterations: usize) {
        let n_iterations = n_iterations.min(MAX_COUNT.saturating_sub(self.n_iterations));
        if let Some(&Stage { to, .. }) = self.config.stages.last() {
            self.config.stages.push(Stage {
                n_iterations,
                from: to,
                to,
            });
            self.n_iterations += n_iterations;
        }
    }

    /// Treats parts of the source as free or rigid from now on. Rigid ones take their shape at once.
    ///
    /// # Errors
    /// Not one entry per vertex, or an attraction outside 0..=1; nothing changed.
    pub fn set_regions(&mut self, regions: &Regions) -> Result<(), DrapeError> {
        regions.check(self.gradient.len())?;
        self.guidance = Guidance::new(
            &self.triangulation,
            &self.rest,
            &self.initial,
            regions,
            &self.is_uncovered,
        );
        self.matcher.set_attraction(self.guidance.attraction());
        self.settle()
    }
}
