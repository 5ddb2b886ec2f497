//! Closest points on triangles, exact in f64, over an f32 box hierarchy.
use crate::{Location, Point3, SurfacePoint};
/// stub
#[derive(Clone)]
pub struct TriangleBvh {}
