//! Corners that are far off, kept in mind from one iteration to the next.

use mesh_core::sampling::TrianglePlace;
use mesh_core::{Point3, Positions, SurfaceSample, TargetSurface, TriangleBvh, Triangulation};
use rand::{Rng, RngCore};

use crate::matching::{Side, SurfaceMatch};

/// The corners kept in mind, as rows: what a matcher remembers from one resampling to the next.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct HardCorners {
    /// Among the vertices of the mesh that a triangle uses.
    pub of_mesh: Vec<usize>,
    /// Among the corners of the target.
    pub of_target: Vec<usize>,
}

/// The corners of both shapes, and those that were farthest off when last seen.
///
/// A random sample falls on the tip of an ear with probability 0, and the tip decides the Hausdorff distance.
pub(crate) struct HardPlaces {
    mesh_corners: Vec<TrianglePlace>,
    target_corners: Vec<Point3>,
    kept: HardCorners,
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
            kept: HardCorners::default(),
        }
    }

    /// The mesh's far corners, each with its closest point on the target.
    pub(crate) fn match_mesh(
        &mut self,
        x: &Positions,
        side: &Side<'_>,
        rng: &mut dyn RngCore,
    ) -> Vec<SurfaceMatch> {
        let n = side.config.n_hard;
        let mut rows = std::mem::take(&mut self.kept.of_mesh);
        rows.extend(random_rows(n, self.mesh_corners.len(), rng));
        let places: Vec<TrianglePlace> = rows.iter().map(|&k| self.mesh_corners[k]).collect();
        let (rows, pairs) = farthest(rows, side.match_places(&places, x), x, n);
        self.kept.of_mesh = rows;
        pairs
    }

    /// The target's far corners, each with its closest place on the mesh.
    pub(crate) fn match_target(
        &mut self,
        x: &Positions,
        bvh: &TriangleBvh,
        side: &Side<'_>,
        rng: &mut dyn RngCore,
    ) -> Vec<SurfaceMatch> {
        let n = side.config.n_hard;
        let mut rows = std::mem::take(&mut self.kept.of_target);
        rows.extend(random_rows(n, self.target_corners.len(), rng));
        let points: Vec<Point3> = rows.iter().map(|&k| self.target_corners[k]).collect();
        let samples: Vec<SurfaceSample> = points
            .iter()
            .zip(side.target.closest_points(&points))
            .map(|(&point, hit)| SurfaceSample {
                point,
                location: hit.location,
            })
            .collect();
        let (rows, pairs) = farthest(rows, side.match_samples(&samples, bvh), x, n);
        self.kept.of_target = rows;
        pairs
    }

    pub(crate) fn kept(&self) -> &HardCorners {
        &self.kept
    }

    /// Keeps these instead; whether all their rows are there.
    pub(crate) fn keep(&mut self, kept: HardCorners) -> bool {
        let fits = kept.of_mesh.iter().all(|&k| k < self.mesh_corners.len())
            && kept
                .of_target
                .iter()
                .all(|&k| k < self.target_corners.len());
        if fits {
            self.kept = kept;
        }
        fits
    }
}

/// `n` random rows of `len`; none of an empty list.
fn random_rows(n: usize, len: usize, rng: &mut dyn RngCore) -> impl Iterator<Item = usize> + '_ {
    let n = if len == 0 { 0 } else { n };
    (0..n).map(move |_| rng.random_range(0..len))
}

/// The `n` rows whose pairs are farthest off, the farthest first, each once.
fn farthest(
    rows: Vec<usize>,
    pairs: Vec<Option<SurfaceMatch>>,
    x: &Positions,
    n: usize,
) -> (Vec<usize>, Vec<SurfaceMatch>) {
    let mut ranked: Vec<(f64, usize, SurfaceMatch)> = rows
        .into_iter()
        .zip(pairs)
        .filter_map(|(row, pair)| pair.map(|pair| (pair.offset(x).norm_squared(), row, pair)))
        .collect();
    ranked.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    ranked.dedup_by_key(|r| r.1);
    ranked.truncate(n);
    ranked.into_iter().map(|(_, row, pair)| (row, pair)).unzip()
}
