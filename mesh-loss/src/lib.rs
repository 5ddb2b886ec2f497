//! The losses of mesh draping, each a value and an analytic gradient in f64. No tensor type is known here.
//!
//! | term | type | source |
//! |---|---|---|
//! | distance to the target, both ways | [`Chamfer`] | Eq. 2 |
//! | the farthest few distances | [`WorstDistance`] | beyond the paper |
//! | agreement of normals | [`NormalAgreement`] | the authors' program |
//! | landmarks | [`LandmarkDistance`] | Eq. 2 |
//! | corner angles | [`CornerAngle`] | Eq. 3, first term |
//! | local area distribution | [`AreaKl`] | Eq. 3, second term |
//! | skinny triangles | [`TriangleQuality`] | Eq. 4 |
//! | flipped faces | [`Flip`] | the authors' program |
//! | folded edges | [`FoldBarrier`] | beyond the paper |
//! | angle distortion as Eq. 6 measures it | [`Conformal`] | beyond the paper |
//! | one-rings turned and scaled only | [`LocalShape`] | beyond the paper |
//! | sliding along the surface | [`Drift`] | beyond the paper |
//! | near in space and far along the surface | [`Contact`] | beyond the paper, after Li et al. 2020 |
//! | change that is uneven along the surface | [`SmoothChange`] | beyond the paper |
//!
//! [`SurfaceMatcher::resample`] draws samples and finds closest points; it alone changes what the distance terms see.
//!
//! ```
//! use std::sync::Arc;
//! use mesh_loss::mesh_core::{shapes, Point3, Positions, Triangulation, Vector3, VertexData};
//! use mesh_loss::{CornerAngle, Loss};
//!
//! let (mesh, rest) = shapes::quad_sphere(6).into_halfedge()?;
//! let angles = CornerAngle::new(&Arc::new(Triangulation::new(&mesh, &rest)), &rest);
//!
//! // A sphere that was stretched has other angles; a small step against the gradient brings them nearer.
//! let x = rest.map(|p| Point3::new(2.0 * p.x, p.y, p.z));
//! let mut gradient = VertexData::new(x.len(), Vector3::zeros());
//! let before = angles.accumulate(&x, 1.0, &mut gradient);
//! let nearer: Positions = x.iter().zip(&gradient).map(|(p, g)| p - g).collect();
//! let after = angles.accumulate(&nearer, 1.0, &mut gradient);
//! assert!(0.0 < after && after < before);
//! # Ok::<(), mesh_loss::mesh_core::TopologyError>(())
//! ```
//!
//! `examples/own_descent.rs` is a whole descent on terms of this crate. The crate whose types the signatures name,
//! [`mesh_core`], is exported again.

mod area_kl;
mod chamfer;
mod conformal;
mod contact;
mod contact_search;
mod corner_angle;
mod drift;
mod flip;
mod fold_barrier;
mod gradient;
mod hard_places;
mod landmark_distance;
mod local_shape;
mod loss;
mod matcher;
mod matches;
mod normal_agreement;
mod smooth_change;
mod surfaces;
mod triangle_quality;
mod worst_distance;

pub use area_kl::AreaKl;
pub use chamfer::Chamfer;
pub use conformal::Conformal;
pub use contact::{Contact, ContactPair};
pub use contact_search::ContactSearch;
pub use corner_angle::CornerAngle;
pub use drift::Drift;
pub use flip::Flip;
pub use fold_barrier::FoldBarrier;
pub use hard_places::HardCorners;
pub use landmark_distance::LandmarkDistance;
pub use local_shape::LocalShape;
pub use loss::Loss;
pub use matcher::SurfaceMatcher;
pub use matches::{Beyond, Matches, Overlap, SamplingConfig, SurfaceMatch};
pub use normal_agreement::NormalAgreement;
pub use smooth_change::SmoothChange;
pub use triangle_quality::TriangleQuality;
pub use worst_distance::WorstDistance;

pub use mesh_core;

/// The examples of the README, which are tested as those of the documentation are.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
