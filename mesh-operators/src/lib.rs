//! Sparse operators of polygon meshes, sparse Cholesky, and displacement fields extended into space.
//!
//! | to | call |
//! |---|---|
//! | measure bending of a surface | [`cotan_laplacian`], [`pointwise_laplacian`], [`bilaplacian`] |
//! | smooth over edges whatever the shape | [`uniform_laplacian`] |
//! | give each vertex its share of the area | [`voronoi_mass`], [`barycentric_mass`] |
//! | solve `A x = b` for a positive definite `A` | [`SpdSolver`] |
//! | minimise `xᵀ A x` with some rows held | [`FixedSolve`] |
//! | extend displacements to all of space | [`SpaceExtension`] |
//! | measure along a surface | [`geodesic_distance_unfolded`] |
//! | go along a surface from one place to another | [`surface_path`] |
//!
//! Matrices are [`nalgebra_sparse::CsrMatrix`] of `f64`, one row per vertex; polygons count as the triangles of their
//! [`mesh_core::Triangulation`]. Right-hand sides are numbers or vectors ([`SolveValue`]). The crates that the signatures
//! name, [`mesh_core`] (with its `nalgebra`) and [`nalgebra_sparse`], are exported again, so that one dependency is enough.

mod bilaplacian;
mod cotan_laplacian;
mod error;
mod fixed_solve;
mod geodesic;
mod mass;
mod space_extension;
mod spd_solver;
mod surface_path;
mod uniform_laplacian;

pub use bilaplacian::{bilaplacian, multiply, pointwise_laplacian};
pub use cotan_laplacian::{cotan_laplacian, cotan_weights, CotanWeight};
pub use error::SolveError;
pub use fixed_solve::{FixedSolve, FixedSolveScratch};
pub use geodesic::geodesic_distance_unfolded;
pub use mass::{barycentric_mass, voronoi_mass};
pub use space_extension::{Kernel, SpaceExtension};
pub use spd_solver::{SolveValue, SpdSolver};
pub use surface_path::surface_path;
pub use uniform_laplacian::uniform_laplacian;

pub use mesh_core;
pub use nalgebra_sparse::{self, CsrMatrix};

/// The examples of the README, which are tested as those of the documentation are.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
