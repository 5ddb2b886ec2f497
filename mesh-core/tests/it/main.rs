//! Properties of meshes, files and target surfaces.

mod closest_point;
mod triangle_soup;
