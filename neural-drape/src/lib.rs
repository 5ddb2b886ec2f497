//! Drapes a mesh over a target: the paper's network with progressive positional encoding, or the preconditioned
//! vertices themselves, behind one stepper.
//!
//! | to | call |
//! |---|---|
//! | drape | [`Drape::new`], [`Drape::step`], [`Drape::positions`] |
//! | keep parts of the source free or rigid | [`Regions`], [`Drape::set_regions`] |
//! | choose how | [`DrapeConfig`] and its presets |
//! | move the vertices by a map of your own | [`Parametrization`], [`Drape::with_parametrization`] |
//! | take out folds, skinny triangles and crossings at the end | [`Drape::finish`], [`repair`] |
//! | go on with other landmarks | [`Drape::set_landmarks`], [`Drape::displace`], [`Drape::extend`] |
//! | keep a drape in progress | [`Drape::state`], [`Drape::restore`] |
//! | do to other points what was done to the source | [`Warp::new`], [`Warp::apply`] |
//!
//! ```
//! use std::sync::Arc;
//! use neural_drape::mesh_core::{
//!     shapes, Landmark, Point3, TargetSurface, TriangleSoup, Triangulation, VertexId,
//! };
//! use neural_drape::{Drape, DrapeConfig, DrapeInput};
//!
//! // A sphere of quads over an ellipsoid of triangles.
//! let (mesh, rest) = shapes::quad_sphere(8).into_halfedge()?;
//! let mut ellipsoid = shapes::icosphere(3);
//! ellipsoid.positions.iter_mut().for_each(|p| *p = Point3::new(p.x, 0.7 * p.y, 0.5 * p.z));
//! let target: Arc<dyn TargetSurface> = Arc::new(TriangleSoup::new(ellipsoid)?);
//!
//! let top = VertexId::new(0);
//! let place = Point3::new(rest[top].x, 0.7 * rest[top].y, 0.5 * rest[top].z);
//! let input = DrapeInput {
//!     triangulation: &Arc::new(Triangulation::new(&mesh, &rest)),
//!     initial: &rest.map(|p| p * 0.8),
//!     rest: &Arc::new(rest),
//!     target: &target,
//!     landmarks: &[Landmark::new(top, place)],
//! };
//! let mut drape = Drape::new(input, DrapeConfig { seed: 7, ..DrapeConfig::quick() })?;
//! while let Some(step) = drape.step()? {
//!     // Show `step`; pause, read `drape.positions()`, change landmarks, or stop, at any step.
//!     assert!(step.total.is_finite());
//! }
//! let draped = drape.finish().positions;
//! assert!((draped[top] - place).norm() < 0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! `examples/threaded.rs` drapes on a thread, with progress, pause and cancel.
//!
//! The cargo feature `network`, on by default, brings the paper's network (and dfdx); the preconditioned vertices need
//! none of it. The crates whose types the signatures name, [`mesh_core`] and [`mesh_loss`], are exported again.

mod check;
mod config;
mod contact;
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
mod trial;
mod untangle;
mod vertices;
mod warp;

pub use config::{
    AngleReference, Descent, DrapeConfig, OverlapMode, ParametrizationConfig, Sampling,
};
pub use contact::ContactConfig;
pub use drape::{Drape, StepReport};
pub use error::DrapeError;
pub use input::DrapeInput;
pub use objective::TermReport;
pub use parametrization::Parametrization;
pub use regions::Regions;
pub use repair::{repair, Crossings, Defects, Fit, Repair};
pub use schedule::{LearningRate, Stage, Weights};
pub use state::{DrapeState, StateReader, StateWriter};
pub use studies::Study;
pub use vertices::{Vertices, VerticesConfig};
pub use warp::{Warp, WarpError, WarpInput};

pub use {mesh_core, mesh_loss};

/// The examples of the README, which are tested as those of the documentation are.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
