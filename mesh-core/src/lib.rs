//! Polygon meshes for draping: connectivity with n-gons kept, attributes beside it, target surfaces with exact
//! closest-point queries, and files written back as they were read.
//!
//! | to | call |
//! |---|---|
//! | read a mesh, write it back with new positions | [`io`] |
//! | get connectivity | [`PolygonSoup::into_halfedge`] |
//! | let equal positions move as one | [`PolygonSoup::weld`] |
//! | measure polygons as triangles | [`Triangulation::new`] |
//! | query a target | [`TriangleSoup::new`], [`PointCloud::new`], [`TargetSurface`] |
//! | query a moving mesh | [`TriangleBvh`] |
//! | draw random places | [`sampling::TriangleSampler`], [`sampling::SeededRng`] |
//! | mark pairs of places | [`Landmark`] |
//! | let a coarse mesh stand in for a dense one | [`Proxy`] |
//! | see where time goes | [`Profile`] |
//! | build test solids | [`shapes`] |
//!
//! Points, vectors and matrices are those of [`nalgebra`], which is exported again.

mod attribute;
mod build;
pub mod bvh;
mod error;
mod fans;
mod halfedge;
mod ids;
pub mod io;
mod landmark;
pub mod measure;
mod profile;
mod proxy;
mod rotation;
pub mod sampling;
pub mod shapes;
mod soup;
pub mod surface;
mod triangulation;
mod weld;

pub use attribute::{Attribute, EdgeData, FaceData, HalfedgeData, Positions, VertexData};
pub use bvh::TriangleBvh;
pub use error::TopologyError;
pub use fans::{is_on_side, TriangleFans, ON_SIDE};
pub use halfedge::{HalfedgeMesh, Pieces};
pub use ids::{EdgeId, FaceId, HalfedgeId, Id, VertexId};
pub use landmark::{Landmark, LandmarkKind, MeshPoint};
pub use measure::{Aabb, UnitFrame};
pub use profile::{Clock, Profile, Span};
pub use proxy::Proxy;
pub use rotation::nearest_rotation;
pub use soup::PolygonSoup;
pub use surface::{
    Denoised, Location, NormalSign, PointCloud, Strays, SurfacePoint, SurfaceSample, SurfelCloud,
    TargetSurface, TriangleSoup,
};
pub use triangulation::{Triangulation, TriangulationEdge};
pub use weld::Weld;

pub use nalgebra;

/// A point of space, in the units of its file.
pub type Point3 = nalgebra::Point3<f64>;
/// A direction or displacement, in the units of its file.
pub type Vector3 = nalgebra::Vector3<f64>;
