//! What is optimised: the one interface behind which the network and the explicit vertices stand.

use mesh_core::{Positions, Vector3, VertexData};

use crate::network::NetworkMap;
use crate::{DrapeError, StateReader, StateWriter};

/// A differentiable map θ ↦ positions, with its own optimiser.
pub trait Parametrization: Send {
    /// Positions for the current parameters, one per vertex, in the unit frame of the target.
    fn positions(&self) -> &Positions;

    /// One optimiser step against `gradient` (dL/dx, one entry per vertex); positions are recomputed.
    ///
    /// # Errors
    /// The step left the finite numbers.
    fn descend(
        &mut self,
        gradient: &VertexData<Vector3>,
        learning_rate: f64,
    ) -> Result<(), DrapeError>;

    /// How far the run is, 0..=1: the network reveals its encoding by it, the vertices refine their steps.
    ///
    /// # Errors
    /// The map cannot be prepared for it.
    fn set_progress(&mut self, progress: f64) -> Result<(), DrapeError>;

    /// Moves every vertex by its entry; parameters and optimiser stay as they are.
    fn displace(&mut self, displacements: &VertexData<Vector3>);

    /// Writes parameters and optimiser, so that [`Self::restore`] can go on from here.
    fn save(&mut self, state: &mut StateWriter);

    /// Goes on from what [`Self::save`] wrote.
    ///
    /// # Errors
    /// The state does not fit.
    fn restore(&mut self, state: &mut StateReader<'_>) -> Result<(), DrapeError>;

    /// The map of space behind the positions, in their frame; none where only the vertices are known.
    fn network(&self) -> Option<NetworkMap> {
        None
    }
}
