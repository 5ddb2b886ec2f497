//! Landmark-guided initial deformation of polygon meshes: affine, biharmonic, as rigid as possible.
//!
//! | to | call |
//! |---|---|
//! | get the shape that draping starts at | [`initialize`] |
//! | deform a result further when landmarks are added | [`adjust`] |
//! | do either again and again while landmarks are dragged | [`InteractiveInit`] |
//! | fit as much of an affine map as landmarks determine | [`fit_affine`] |
//! | find how the source stands, without landmarks | [`find_pose`] |
//! | bring a source into the pose of its target, by where on the body places are | [`Guide`] |
//! | measure how far landmarks are from each other along both shapes | [`LandmarkWays`] |
//! | spread displacements smoothly | [`biharmonic_displacement`] |
//! | spread rotations and scales smoothly | [`SimilarSolver`] |
//! | deform as rigidly as possible | [`ArapSolver`] |
//!
//! The crates that the signatures name, [`mesh_core`] and [`mesh_operators`], are exported again.
//!
//! ```
//! use mesh_init::mesh_core::{shapes, Landmark, Point3, Triangulation, UnitFrame, VertexId};
//! use mesh_init::{initialize, InitConfig, InitInput};
//! let (mesh, rest) = shapes::quad_sphere(8).into_halfedge()?;
//! let stretched = rest.map(|p| Point3::new(3.0 * p.x, p.y, p.z));
//! let landmarks = [0, 8, 40, 100, 200].map(|v| Landmark::new(VertexId::new(v), stretched[VertexId::new(v)]));
//! let input = InitInput {
//!     triangulation: &Triangulation::new(&mesh, &rest),
//!     rest: &rest,
//!     landmarks: &landmarks,
//!     target_frame: UnitFrame::principal(stretched.as_slice()),
//! };
//! let initial = initialize(input, &InitConfig::paper())?;
//! assert!(initial.positions.iter().zip(&stretched).all(|(p, q)| (p - q).norm() < 1e-6));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod affine;
mod arap;
mod biharmonic;
mod cells;
mod config;
mod deformer;
mod error;
mod frames;
mod guide;
mod initialize;
mod interactive;
mod pose;
mod reach;
mod similar;

pub use affine::{fit_affine, AffineFit, AffineKind, FramePair, PointPair, SimilarityPrior};
pub use arap::{ArapScratch, ArapSolver};
pub use biharmonic::{biharmonic_displacement, BiharmonicSolver};
pub use config::{InitConfig, Pinning, Spread};
pub use error::InitError;
pub use guide::{Guide, GuideConfig, GuideInput, LandmarkWays};
pub use initialize::{adjust, initialize, point_pairs, InitInput, Initial};
pub use interactive::InteractiveInit;
pub use pose::{find_pose, Pose, PoseInput};
pub use similar::{PulledVertex, SimilarConfig, SimilarSolver};

pub use {mesh_core, mesh_operators};

/// The examples of the README, which are tested as those of the documentation are.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
