//! Pictures of meshes without a graphics card: a small software rasteriser.

mod camera;
pub(crate) mod color;
mod image;
mod model;
mod raster;

pub(crate) use camera::{Axes, Up, View};
pub(crate) use image::Image;
pub(crate) use model::Model;
pub(crate) use raster::{draw, Look, Shot};
