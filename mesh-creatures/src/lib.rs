//! Creatures built in code, deformed into other individuals in other poses: test pairs whose every vertex has a known
//! true place.
//!
//! | to | call |
//! |---|---|
//! | choose a kind of creature | [`Plan`] |
//! | draw or make an individual | [`Individual::drawn`], [`Individual::at_rest`], [`Individual::posed`], [`Proportions`] |
//! | get its quads, with texture coordinates, parts and named places | [`Template::new`] |
//! | get source, target, truth and landmarks | [`CreaturePair::new`] |
//!
//! A plan is a control mesh of quads, drawn out of a few patches section by section, in any [`Proportions`], with a
//! skeleton. A pose moves the control mesh by dual quaternions; Catmull and Clark's subdivision makes it smooth, and every
//! vertex of a template lies on the surface that subdivision ends at. The same surface in other triangles is the target:
//! the truth lies on it but for the flatness of its triangles.
//!
//! The crate whose types the signatures name, [`mesh_core`], is exported again.

mod cage;
mod flips;
mod individual;
mod pair;
mod plan;
mod proportions;
mod remesh;
mod skeleton;
mod skin;
mod subdivision;
mod template;

pub use individual::{Dial, Individual, Pose};
pub use pair::{CreaturePair, PairConfig, TrueLandmark, UnknownVariant, Variant};
pub use plan::{Plan, UnknownPlan};
pub use proportions::Proportions;
pub use template::{Place, Template};

pub use mesh_core;

/// The examples of the README, which are tested as those of the documentation are.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
