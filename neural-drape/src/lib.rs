//! Drapes a mesh over a target: the paper's network with progressive positional encoding, or the preconditioned
//! vertices themselves, behind one stepper.
//!
//! | to | call |
//! |---|---|
//! | drape | [`Drape::new`], [`Drape::step`], [`Drape::positions`] |
//! | keep parts of the source free or rigid | [`Regions`], [`Drape::set_regions`] |
//! | choose how | [`DrapeConfig`] and its presets |
//! | take out folds and skinny triangles at the end | [`Drape::finish`], [`repair`] |
//! | go on with other landmarks | [`Drape::set_landmarks`], [`Drape::displace`], [`Drape::extend`] |
//! | keep a drape in progress | [`Drape::state`], [`Drape::restore`] |
//! | do to other points what was done to the source | [`Warp::new`], [`Warp::apply`] |

mod check;
mod config;
mod coverage;
mod drape;
mod error;
pub mod network;
mod parametrization;
mod presets;
mod refine;
mod regions;
mod repair;
mod state;
mod studies;
mod terms;
mod vertices;
mod warp;

pub use config::{
    AngleReference, Descent, DrapeConfig, LearningRate, OverlapMode, ParametrizationConfig,
    Sampling, Stage, Weights,
};
pub use drape::{Drape, DrapeInput, StepReport};
pub use error::DrapeError;
pub use parametrization::Parametrization;
pub use regions::Regions;
pub use repair::{repair, Defects, Repair};
pub use state::{DrapeState, StateReader, StateWriter};
pub use terms::TermReport;
pub use vertices::{Vertices, VerticesConfig};
pub use warp::{Warp, WarpError, WarpInput};
