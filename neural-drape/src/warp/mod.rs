//! A drape as a map of space: what it did to the source, done to anything that goes with it.

mod error;
mod format;
#[cfg(test)]
mod tests;

pub use error::WarpError;

use std::path::Path;

use mesh_core::{Location, Point3, Positions, TriangleBvh, Triangulation, Vector3};
use mesh_operators::SpaceExtension;
use rayon::prelude::*;

use crate::network::NetworkMap;

/// Centres of the extension at most: a dense system of this size takes some 50 ms to solve.
const MAX_CENTRES: usize = 1000;
/// Share of the rest shape's longest side within which the surface's own correction fades.
const SURFACE_REACH: f64 = 0.05;
/// Share of the rest shape's longest side within which a network's offset fades: it saw the surface only.
const NETWORK_REACH: f64 = 0.25;

/// A map of space that sends the source at rest to the draped source, and moves along whatever is near it: levels
/// of detail, hair, collision hulls.
///
/// `p ↦ q + n(δ) · network(q) + s(δ) · r(p)`, with `q = p + extension(p)`, δ the distance of p to the surface at rest,
/// r the residual of the closest point (linear in each triangle), and n, s falling from 1 on the surface to 0 at 25 %
/// and 5 % of the longest side. Without a network the extension already holds the whole displacement; with one, that
/// of the initial deformation.
///
/// The source's own vertices land on their draped positions to rounding, where no two of them share one position at
/// rest. Far away only the extension acts, which becomes affine.
#[derive(Clone, Debug)]
pub struct Warp {
    extension: SpaceExtension,
    network: Option<NetworkMap>,
    surface: Surface,
    bvh: TriangleBvh,
}

/// What a warp is made of.
#[derive(Clone, Debug)]
pub struct WarpInput<'a> {
    /// The source's polygons as triangles.
    pub triangulation: &'a Triangulation,
    /// The source as given.
    pub rest: &'a Positions,
    /// Where the drape started.
    pub initial: &'a Positions,
    /// Where it ended.
    pub draped: &'a Positions,
    /// The network that moved the initial shape, if one did, in the coordinates of `initial` ([`crate::Drape::network`]).
    pub network: Option<NetworkMap>,
}

/// The source at rest with what the rest of the warp misses at each vertex.
#[derive(Clone, PartialEq, Debug)]
struct Surface {
    rest: Vec<Point3>,
    /// Rows of `rest`; a vertex without a triangle is a triangle of its own.
    triangles: Vec<[u32; 3]>,
    residuals: Vec<Vector3>,
}

impl Warp {
    /// The warp that sends `input.rest` to `input.draped`.
    ///
    /// # Errors
    /// Shapes of different lengths, none at all, or coordinates that are not finite.
    pub fn new(input: WarpInput<'_>) -> Result<Self, WarpError> {
        let WarpInput {
            rest,
            initial,
            draped,
            network,
            ..
        } = input;
        for (what, shape) in [("initial", initial), ("draped", draped)] {
            if shape.len() != rest.len() {
                return Err(WarpError::LengthMismatch {
                    what,
                    found: shape.len(),
                    expected: rest.len(),
                });
            }
        }
        let extended = if network.is_some() { initial } else { draped };
        let displacements: Vec<Vector3> = extended.iter().zip(rest).map(|(x, p)| x - p).collect();
        let extension = SpaceExtension::new(rest.as_slice(), &displacements, MAX_CENTRES)?;

        let surface = Surface {
            rest: rest.as_slice().to_vec(),
            triangles: triangles_with_loose_vertices(input.triangulation, rest.len()),
            residuals: vec![Vector3::zeros(); rest.len()],
        };
        let mut warp = Self::from_parts(extension, network, surface);
        let reached = warp.apply(rest.as_slice());
        let missed = draped.iter().zip(&reached).map(|(x, y)| x - y);
        warp.surface.residuals = missed.collect();
        Ok(warp)
    }

    fn from_parts(
        extension: SpaceExtension,
        network: Option<NetworkMap>,
        surface: Surface,
    ) -> Self {
        let corners = surface
            .triangles
            .iter()
            .map(|t| t.map(|v| surface.rest[v as usize]));
        Self {
            bvh: TriangleBvh::new(corners.collect()),
            extension,
            network,
            surface,
        }
    }

    /// The images of `points`, given in the coordinates of the source at rest; the same bits whatever the thread
    /// count.
    pub fn apply(&self, points: &[Point3]) -> Vec<Point3> {
        let extend = |p: &Point3| p + self.extension.displacement_at(p);
        let extended: Vec<Point3> = points.par_iter().with_min_len(64).map(extend).collect();
        let networked = match &self.network {
            Some(network) => network.apply(&extended),
            None => extended.clone(),
        };
        points
            .par_iter()
            .with_min_len(64)
            .zip(extended.par_iter().zip(&networked))
            .map(|(p, (q, moved))| self.correct(p, q, moved))
            .collect()
    }

    /// Fades the network's offset and adds the surface's residual.
    fn correct(&self, p: &Point3, extended: &Point3, networked: &Point3) -> Point3 {
        let Some(closest) = self.bvh.closest_point(p) else {
            return *extended;
        };
        let distance = closest.distance_squared.sqrt()
            / self.bvh.bounds().longest_side().max(f64::MIN_POSITIVE);
        let offset = (networked - extended) * fade(distance / NETWORK_REACH);
        let residual = self.surface.residual(&closest.location) * fade(distance / SURFACE_REACH);
        extended + offset + residual
    }

    /// Writes the warp to a `.drape` file, all or nothing.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), WarpError> {
        Ok(mesh_core::io::write_atomic(path, &self.to_bytes())?)
    }

    /// The bytes of a `.drape` file.
    pub fn to_bytes(&self) -> Vec<u8> {
        format::encode(&self.extension, self.network.as_ref(), &self.surface)
    }

    /// Reads a warp from a `.drape` file.
    ///
    /// # Errors
    /// The file cannot be read, is no warp, or is damaged.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, WarpError> {
        let path = path.as_ref();
        let bytes = std::fs::read(path).map_err(|source| WarpError::Read {
            path: path.to_owned(),
            source,
        })?;
        let (extension, network, surface) = format::decode(&bytes).map_err(|e| e.in_file(path))?;
        Ok(Self::from_parts(extension, network, surface))
    }
}

impl Surface {
    /// What the rest of the warp misses at a place of the surface.
    fn residual(&self, location: &Location) -> Vector3 {
        let Location::Triangle { index, barycentric } = location else {
            return Vector3::zeros();
        };
        let corners = self.triangles[*index as usize].iter().zip(barycentric);
        corners
            .map(|(&v, &weight)| self.residuals[v as usize] * weight)
            .sum()
    }
}

/// The triangles, then each vertex that none of them uses.
fn triangles_with_loose_vertices(
    triangulation: &Triangulation,
    n_vertices: usize,
) -> Vec<[u32; 3]> {
    let mut is_loose = vec![true; n_vertices];
    let mut triangles = Vec::with_capacity(triangulation.len());
    for t in triangulation.triangles() {
        triangles.push(t.map(|v| v.index() as u32));
        for v in t {
            is_loose[v.index()] = false;
        }
    }
    let loose = (0..n_vertices as u32).filter(|&v| is_loose[v as usize]);
    triangles.extend(loose.map(|v| [v; 3]));
    triangles
}

/// 1 at 0, falling with a continuous slope to 0 from 1 on: `(1 − t²)²`.
fn fade(t: f64) -> f64 {
    (1.0 - t * t).max(0.0).powi(2)
}
