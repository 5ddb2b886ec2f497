//! Drapes a mesh over a target: the paper's network with progressive positional encoding, or the preconditioned
//! vertices themselves, behind one stepper.
//!
//! | to | call |
//! |---|---|
//! | drape | [`Drape::new`], [`Drape::step`], [`Drape::positions`] |
//! | keep parts of the source free or rigid | [`Regions`], [`Drape::set_regions`] |
//! | choose how | [`DrapeConfig`] and its presets |
//! | move the vertices by a map of your own | [`Parametrization`], [`Drape::with_parametrization`] |
//! | take out folds and skinny triangles at the end | [`Drape::finish`], [`repair`] |
//! | go on with other landmarks | [`Drape::set_landmarks`], [`Drape::displace`], [`Drape::extend`] |
//! | keep a drape in progress | [`Drape::state`], [`Drape::restore`] |
//! | do to other points what was done to the source | [`Warp::new`], [`Warp::apply`] |

mod check;
mod config;
mod coverage;
mod drape;
mod error;
mod input;
pub mod network;
mod objective;
mod parametrization;
mod presets;
mod refine;
mod regions;
mod repair;
mod schedule;
mod setting;
mod state;
mod studies;
mod vertices;
mod warp;

pub use config::{
    AngleReference, Descent, DrapeConfig, OverlapMode, ParametrizationConfig, Sampling,
};
pub use drape::{Drape, StepReport};
pub use error::DrapeError;
pub use input::DrapeInput;
pub use objective::TermReport;
pub use parametrization::Parametrization;
pub use regions::Regions;
pub use repair::{repair, Defects, Repair};
pub use schedule::{LearningRate, Stage, Weights};
pub use state::{DrapeState, StateReader, StateWriter};
pub use studies::Study;
pub use vertices::{Vertices, VerticesConfig};
pub use warp::{Warp, WarpError, WarpInput};
