//! Pictures without a graphics card, and the report page of a drape.
//!
//! | to | call |
//! |---|---|
//! | draw a mesh or a cloud | [`draw`], [`Model`], [`Look`], [`Shot`] |
//! | draw the shapes of a drape, all from one direction | [`Gallery`] |
//! | find which way is up | [`Upright`], [`Up`] |
//! | put pictures beside each other, write a PNG file | [`Image`] |
//! | carry the target's colours, normals and relief into the source's texture | [`bake`] |
//! | make the report page of a drape | [`Page`] |
//! | build another self-contained page | [`html`] |

pub mod bake;
mod camera;
pub mod color;
mod error;
mod gallery;
mod image;
mod model;
mod raster;
mod report;
mod upright;

pub use camera::{Axes, Up, UpError, View, ViewError};
pub use error::RenderError;
pub use gallery::{Gallery, DISTANCE_AT_TOP, STRETCH_AT_TOP, TRUTH_AT_TOP};
pub use image::{Image, Pixel};
pub use model::{Facet, Model};
pub use raster::{draw, Look, Shot};
pub use report::{html, Page};
pub use upright::Upright;

pub use {mesh_core, mesh_draping};

/// The examples of the README, which are tested as those of the documentation are.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
