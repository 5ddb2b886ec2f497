//! Mesh draping as one library: from files in memory to the draped mesh with its report.
//!
//! ```no_run
//! use mesh_draping::{landmarks, Preset, Source, Target, Transfer};
//! # fn main() -> Result<(), mesh_draping::Error> {
//! let source = Source::read("horse.obj")?;
//! let target = Target::read("wolf.obj")?;
//! let landmarks = landmarks::read("pairs.json", &source, &target)?;
//! let outcome = Transfer::new(&source, &target, &landmarks, Preset::standard()).run()?;
//! outcome.write("draped.obj")?;
//! # Ok(())
//! # }
//! ```
//!
//! | to | call |
//! |---|---|
//! | read the mesh to deform | [`Source::read`], [`Source::of_soup`], [`Seams`] |
//! | read the shape to drape over | [`Target::read`], [`Target::of_soup`], [`Target::of_points`] |
//! | read, write, check, mirror and suggest landmarks | [`landmarks`] |
//! | choose the settings | [`Preset`] |
//! | treat parts in their own way | [`Parts`], [`parts`] |
//! | drape | [`Transfer::run`] |
//! | drape step by step, pause, change landmarks, resume | [`Transfer::start`], [`Draping`] |
//! | relax, pull or slide a place of the result by hand | [`Stroke`], [`Draping::brush`] |
//! | snap a place to a vertex, or to the most curved one | [`SnapPoints`] |
//! | start from a shape that nearly fits | [`Transfer::with_start`] |
//! | drape the frames of a motion | [`Transfer::with_motion`] |
//! | start from what shapes of a population have in common | [`Population`] |
//! | get a result as symmetric as the source | [`Transfer::symmetric`] |
//! | drape on a thread of its own | [`Draping::spawn`], [`Background`] |
//! | use the result | [`Outcome`] |
//! | deform by landmarks only | [`initial_deformation`] |
//! | judge any shape of the source | [`Pair::judge`] |
//!
//! Everything that decides a result is here or below; an application adds words, files and pictures. What was assumed,
//! left out or repaired comes back as values: [`Note`], [`landmarks::Finding`], [`Explanation`].

mod background;
mod brush;
mod draping;
mod ending;
mod error;
mod explain;
mod history;
mod initial;
pub mod landmarks;
mod note;
mod outcome;
mod pair;
pub mod parts;
mod plain;
mod population;
pub mod preset;
mod seams;
mod similarity;
mod snap;
mod source;
mod stages;
mod stand_in;
mod start;
mod symmetric;
mod target;
mod transfer;

pub use background::{Background, BackgroundStatus};
pub use brush::{Brush, BrushInput, Moves, Stroke};
pub use draping::{adjusted, Draping};
pub use error::{Error, MeshProblem};
pub use explain::{Advice, CrossingPlace, Explanation, PlaceKind, RegionDistances, WorstPlace};
pub use history::{Curve, History};
pub use initial::{initial_deformation, InitialMethod, InitialShape};
pub use note::{Note, Shape};
pub use outcome::Outcome;
pub use pair::Pair;
pub use parts::{Parts, Treatment};
pub use plain::plain_words;
pub use population::Population;
pub use preset::Preset;
pub use seams::{Seams, SeamsError};
pub use similarity::Similarity;
pub use snap::{SnapPoints, SNAP_REACH};
pub use source::{GatheredPositions, Source};
pub use stages::{Stages, DRAPING, REFINING};
pub use target::Target;
pub use transfer::{Motion, Transfer};

// What the signatures above name, so that one crate is enough.
pub use mesh_core;
pub use mesh_init;
pub use mesh_metrics;
pub use neural_drape;

/// The examples of the README, which are tested as those of the documentation are.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
