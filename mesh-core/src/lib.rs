//! Polygon meshes for draping: connectivity with n-gons kept, attributes beside it, target surfaces with exact
//! closest-point queries, and files written back as they were read.
//!
//! | to | call |
//! |---|---|
//! | read a mesh, write it back with new positions | [`io`] |
//! | check a mesh, walk around its polygons | [`PolygonSoup::into_halfedge`] |
//! | let equal positions move as one | [`PolygonSoup::weld`] |
//! | measure polygons as triangles, ask what touches what | [`Triangulation::new`] |
//! | query a target | [`TriangleSoup::new`], [`PointCloud::new`], [`TargetSurface`] |
//! | query a moving mesh | [`TriangleBvh`] |
//! | tell what a map of a surface does to directions | [`map_gradients`] |
//! | draw random places | [`sampling::TriangleSampler`], [`sampling::SeededRng`] |
//! | mark pairs of places | [`Landmark`] |
//! | let a coarse mesh stand in for a dense one | [`Proxy`] |
//! | see where time goes | [`Profile`] |
//! | keep lists of neighbours, join sets | [`Rows`], [`UnionFind`] |
//! | build test solids | [`shapes`] |
//!
//! A mesh has its connectivity in two views. [`HalfedgeMesh`] is the gate and the view of polygons: it checks a soup once,
//! and answers what needs loops, such as holes and genus; an edge that no pair of half-edges can hold is cut there. The
//! [`Triangulation`] is made of it once, at rest, and is what everything else takes: whatever is fitted, smoothed or judged
//! is so on triangles, and asks it for edges, neighbours, boundary and connected pieces. A target needs neither: it is a
//! [`TargetSurface`].
//!
//! Points, vectors and matrices are those of [`nalgebra`], which is exported again.

mod attribute;
mod boundary;
mod build;
pub mod bvh;
mod error;
mod fans;
mod gradients;
mod halfedge;
mod ids;
pub mod io;
mod landmark;
pub mod measure;
mod profile;
mod proxy;
mod rotation;
mod rows;
pub mod sampling;
pub mod shapes;
mod side;
mod soup;
pub mod surface;
mod triangulation;
mod union_find;
mod weld;

pub use attribute::{Attribute, EdgeData, FaceData, HalfedgeData, Positions, VertexData};
pub use boundary::Boundary;
pub use bvh::TriangleBvh;
pub use error::TopologyError;
pub use fans::{is_on_side, TriangleFans, ON_SIDE};
pub use gradients::map_gradients;
pub use halfedge::HalfedgeMesh;
pub use ids::{EdgeId, FaceId, HalfedgeId, Id, VertexId};
pub use landmark::{Curve, CurveShare, Landmark, LandmarkKind, MeshPoint};
pub use measure::{Aabb, UnitFrame};
pub use profile::{Clock, Profile, Span};
pub use proxy::Proxy;
pub use rotation::nearest_rotation;
pub use rows::Rows;
pub use soup::PolygonSoup;
pub use surface::{
    Denoised, Location, NormalSign, Patches, PointCloud, Strays, SurfacePoint, SurfaceSample,
    SurfelCloud, TargetSurface, TriangleSoup,
};
pub use triangulation::{Pieces, Triangulation, TriangulationEdge};
pub use union_find::UnionFind;
pub use weld::Weld;

pub use nalgebra;

/// A point of space, in the units of its file.
pub type Point3 = nalgebra::Point3<f64>;
/// A direction or displacement, in the units of its file.
pub type Vector3 = nalgebra::Vector3<f64>;

/// The examples of the README, which are tested as those of the documentation are.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
