//! Corners that are far off, kept in mind from one iteration to the next.

use mesh_core::sampling::TrianglePlace;
use mesh_core::{Point3, Positions, SurfaceSample, TargetSurface, TriangleBvh, Triangulation};
use rand::{Rng, RngCore};

use crate::matching::{Side, SurfaceMatch};

/// The corners of both shapes, and those that were farthest off when last seen.
///
/// A random sample falls on the tip of an ear with probability 0, and the tip decides the Hausdorff distance.
pub(crate) struct HardPlaces {
    mesh_corners: Vec<TrianglePlace>,
    target_corners: Vec<Point3>,
    of_mesh: Vec<TrianglePlace>,
    of_target: Vec<SurfaceSample>,
}

impl HardPlaces {
    pub(crate) fn new(
        triangulation: &Triangulation,
        n_vertices: usize,
        target: &dyn TargetSurface,
    ) -> Self {
        let mut corner_of = vec![None; n_vertices];
        for (t, triangle) in triangulation.triangles().iter().enumerate() {
            for (k, v) in triangle.iter().enumerate() {
                let barycentric = [0, 1, 2].map(|other| f64::from(u8::from(other == k)));
                corner_of[v.index()].get_or_insert((t, barycentric));
            }
        }
        Self {
            mesh_corners: corner_of.into_iter().flatten().collect(),
            target_corners: target.vertices(),
            of_mesh: Vec::new(),
            of_target: Vec::new(),
        }
    }

    /// The mesh's far corners, each with its closest point on the target.
    pub(crate) fn to_target(
        &mut self,
        x: &Positions,
        side: &Side<'_>,
        rng: &mut dyn RngCore,
    ) -> Vec<SurfaceMatch> {
        let n = side.config.n_hard;
        let mut places = std::mem::take(&mut self.of_mesh);
        places.extend(random_rows(n, self.mesh_corners.len(), rng).map(|k| self.mesh_corners[k]));
        let pairs = side.match_places(&places, x);
        let (places, pairs) = farthest(places, pairs, x, n);
        self.of_mesh = places;
        pairs
    }

    /// The target's far corners, each with its closest place on the mesh.
    pub(crate) fn to_mesh(
        &mut self,
        x: &Positions,
        bvh: &TriangleBvh,
        side: &Side<'_>,
        rng: &mut dyn RngCore,
    ) -> Vec<SurfaceMatch> {
        let n = side.config.n_hard;
        let mut samples = std::mem::take(&mut self.of_target);
        samples.extend(random_rows(n, self.target_corners.len(), rng).map(|k| {
            let point = self.target_corners[k];
            let location = side.target.closest_point(&point).location;
            SurfaceSample { point, location }
        }));
        let pairs = side.match_samples(&samples, bvh);
        let (samples, pairs) = farthest(samples, pairs, x, n);
        self.of_target = samples;
        pairs
    }
}

/// `n` random rows of `len`; none of an empty list.
fn random_rows(n: usize, len: usize, rng: &mut dyn RngCore) -> impl Iterator<Item = usize> + '_ {
    let n = if len == 0 { 0 } else { n };
    (0..n).map(move |_| rng.random_range(0..len))
}

/// The `n` places whose pairs are farthest off, the farthest first, each once.
fn farthest<P: Copy + PartialEq>(
    places: Vec<P>,
    pairs: Vec<Option<SurfaceMatch>>,
    x: &Positions,
    n: usize,
) -> (Vec<P>, Vec<SurfaceMatch>) {
    let mut ranked: Vec<(f64, usize, P, SurfaceMatch)> = places
        .into_iter()
        .zip(pairs)
        .enumerate()
        .filter_map(|(row, (place, pair))| {
            pair.map(|pair| (pair.offset(x).norm_squared(), row, place, pair))
        })
        .collect();
    ranked.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    ranked.dedup_by(|b, a| a.0 == b.0 && a.2 == b.2);
    ranked.truncate(n);
    ranked
        .into_iter()
        .map(|(_, _, place, pair)| (place, pair))
        .unzip()
}
