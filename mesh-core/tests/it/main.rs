//! Properties of meshes, files and target surfaces.

mod closest_point;
mod denoise;
mod io_convert;
mod io_data;
mod io_dialects;
mod io_findings;
mod io_gltf;
mod io_gltf_crate;
mod io_gltf_dialects;
mod io_limits;
mod io_morphs;
mod io_mutations;
mod io_obj;
mod io_off;
mod io_ply;
mod io_readme;
mod io_skins;
mod io_stl;
mod io_support;
mod io_xyz;
mod point_cloud;
mod skipped;
mod target_variants;
mod triangle_soup;
mod triangulation;
