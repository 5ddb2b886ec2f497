//! Judges a draped mesh: how close it is to its target, how much it is distorted, and what is broken in it.
//!
//! | to | call |
//! |---|---|
//! | get everything at once | [`evaluate()`] → [`Report`] |
//! | score fit and distortion together | [`q_transfer()`] |
//! | measure distances both ways | [`SurfaceDistances::measure`], [`vertex_distances`] |
//! | measure them over what has a counterpart on the other | [`Counterparts::distances`] |
//! | sum them up | [`chamfer()`], [`hausdorff_sampled`], [`directed_hausdorff_sampled`], [`percentiles`] |
//! | measure distortion | [`dirichlet_unit_area`], [`dirichlet_energy`], [`face_stretch`], [`mean_angle_deviation`] |
//! | find defects | [`folded_edges`], [`skinny_triangles`], [`triangle_qualities`], [`opposed_triangles`], [`self_intersections`], [`new_crossings`] |
//! | bring shapes to one size | [`common_frame`], [`own_frame`], [`total_area`] |
//!
//! Polygons are measured on the triangles of [`mesh_core::Triangulation`], chosen once at rest. Another judge may cut
//! a polygon with five or more sides, or a concave quad, otherwise; its figures then differ slightly.
//!
//! The crate whose types the signatures name, [`mesh_core`], is exported again.

mod chamfer;
mod config;
mod counterparts;
mod defects;
mod dirichlet;
mod distances;
mod evaluate;
mod hausdorff;
mod normalize;
mod percentile;
mod q_transfer;
mod report;
mod self_intersection;
mod table;

pub use chamfer::{chamfer, Chamfer};
pub use config::EvaluationConfig;
pub use counterparts::{CountedDistances, Counterparts};
pub use defects::{
    folded_edges, mean_angle_deviation, opposed_triangles, skinny_triangles, triangle_qualities,
    FOLD_COSINE, SKINNY_QUALITY,
};
pub use dirichlet::{dirichlet_energy, dirichlet_unit_area, face_stretch};
pub use distances::{vertex_distances, DirectedDistances, SurfaceDistances, TargetKind};
pub use evaluate::{evaluate, EvaluateError, EvaluationInput};
pub use hausdorff::{directed_hausdorff_sampled, hausdorff_sampled};
pub use normalize::{common_frame, own_frame, total_area};
pub use percentile::percentiles;
pub use q_transfer::{q_transfer, HAUSDORFF_WEIGHT, PAPER_TAU};
pub use report::{
    CurveFit, Defects, DistanceSummary, LandmarkFit, LandmarkResidual, Places, Report, TruthError,
};
pub use self_intersection::{new_crossings, self_intersections};

pub use mesh_core;

/// The examples of the README, which are tested as those of the documentation are.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
