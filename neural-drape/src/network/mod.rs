//! The paper's parametrisation: a network whose parameters say where every vertex goes.
//!
//! | file | what |
//! |---|---|
//! | `config` | depth, width, encoding and the schedule that reveals it |
//! | `encoding`, `wave`, `draw` | the features γ(x) of a point: waves, their sines and cosines, and how they are drawn |
//! | `mask` | the mask α of the progressive encoding: the first layer sees α ⊙ γ(x) |
//! | `layer` | a fully connected layer and the ReLU, forward and backward |
//! | `block`, `pass` | all layers over all points, forward and backward, in fixed groups |
//! | `map` | the network as a map of space, with the weights at hand |
//! | `tape` | the parameters on dfdx's tape, and its Adam |
//! | `mlp` | [`Network`]: all of it as a parametrisation |
//!
//! `draw`, `mask`, `pass`, `tape` and `mlp`, that is, all that trains, need the cargo feature `network`.

mod block;
mod config;
#[cfg(feature = "network")]
mod draw;
mod encoding;
mod layer;
mod map;
#[cfg(feature = "network")]
mod mask;
#[cfg(feature = "network")]
mod mlp;
#[cfg(feature = "network")]
mod pass;
#[cfg(feature = "network")]
mod tape;
mod wave;

pub use config::{Encoding, Frequencies, NetworkConfig, NetworkInput, Networks, Reveal};
pub use map::NetworkMap;
#[cfg(feature = "network")]
pub use mlp::Network;

use mesh_core::Positions;

use crate::{DrapeError, Parametrization};
pub(crate) use encoding::{WaveKind, Waves};
pub(crate) use layer::Layer;

/// The shapes of a source that a network moves, one position per vertex each.
#[derive(Clone, Copy, Debug)]
pub struct Shapes<'a> {
    /// The source as given, in any frame.
    pub rest: &'a Positions,
    /// Where it starts.
    pub initial: &'a Positions,
}

impl<'a> Shapes<'a> {
    /// A source that starts as it is given.
    pub const fn at_rest(x: &'a Positions) -> Self {
        Self {
            rest: x,
            initial: x,
        }
    }
}

impl NetworkConfig {
    /// The network that moves `shapes.initial`.
    #[cfg(feature = "network")]
    pub(crate) fn build(
        &self,
        shapes: Shapes<'_>,
        seed: u64,
    ) -> Result<Box<dyn Parametrization>, DrapeError> {
        Ok(Box::new(Network::new(shapes, self, seed)?))
    }

    /// An error: this build has no network.
    #[cfg(not(feature = "network"))]
    pub(crate) fn build(
        &self,
        _shapes: Shapes<'_>,
        _seed: u64,
    ) -> Result<Box<dyn Parametrization>, DrapeError> {
        Err(DrapeError::NetworkFeatureOff)
    }
}
