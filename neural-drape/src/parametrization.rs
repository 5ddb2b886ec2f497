//! What is optimised: the one interface behind which the network and the explicit vertices stand.

use mesh_core::{Positions, Vector3, VertexData};

use crate::network::NetworkMap;
use crate::{DrapeError, StateReader, StateWriter};

/// A differentiable map θ ↦ positions, with its own optimiser: f(M | θ) of the paper.
///
/// The network ([`crate::network`]) and the preconditioned vertices ([`crate::Vertices`]) are two; [`crate::Drape::with_parametrization`] takes one of your own.
///
/// A drape that only shifts the source as a whole, by 3 parameters t: `x = x₀ + t`, `dL/dt = Σᵢ dL/dxᵢ`.
///
/// ```
/// use std::sync::Arc;
/// use mesh_core::{shapes, Positions, TargetSurface, TriangleSoup, Triangulation, Vector3, VertexData};
/// use neural_drape::{
///     Drape, DrapeConfig, DrapeError, DrapeInput, Parametrization, StateReader, StateWriter,
/// };
///
/// struct Shift(Positions);
///
/// impl Parametrization for Shift {
///     fn positions(&self) -> &Positions {
///         &self.0
///     }
///     fn descend(&mut self, gradient: &VertexData<Vector3>, rate: f64) -> Result<(), DrapeError> {
///         let sum: Vector3 = gradient.iter().sum();
///         let step = sum.try_normalize(1e-12).unwrap_or_default() * rate;
///         self.0.iter_mut().for_each(|p| *p -= step);
///         Ok(())
///     }
///     fn set_progress(&mut self, _progress: f64) -> Result<(), DrapeError> {
///         Ok(())
///     }
///     fn displace(&mut self, displacements: &VertexData<Vector3>) {
///         self.0.iter_mut().zip(displacements).for_each(|(p, d)| *p += d);
///     }
///     fn save(&mut self, state: &mut StateWriter) {
///         state.points(&self.0);
///     }
///     fn restore(&mut self, state: &mut StateReader<'_>) -> Result<(), DrapeError> {
///         state.points(self.0.iter_mut())
///     }
/// }
///
/// let (mesh, rest) = shapes::quad_sphere(8).into_halfedge()?;
/// let target: Arc<dyn TargetSurface> = Arc::new(TriangleSoup::new(shapes::icosphere(3))?);
/// let input = DrapeInput {
///     triangulation: &Arc::new(Triangulation::new(&mesh, &rest)),
///     initial: &rest.map(|p| p + Vector3::new(0.3, 0.2, 0.0)),
///     rest: &Arc::new(rest),
///     target: &target,
///     landmarks: &[],
/// };
/// let start = |initial: &Positions| Ok(Box::new(Shift(initial.clone())) as Box<dyn Parametrization>);
/// let mut drape = Drape::with_parametrization(input, DrapeConfig::quick(), start)?;
/// while drape.step()?.is_some() {}
/// let x = drape.positions();
/// let centre = x.iter().map(|p| p.coords).sum::<Vector3>() / x.len() as f64;
/// assert!(centre.norm() < 0.02);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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
