//! Corners that are far off, kept in mind from one iteration to the next.

use mesh_core::sampling::{SeededRng, TrianglePlace};
use mesh_core::{Location, Point3, Positions, SurfaceSample, TargetSurface, Triangulation};

use crate::matches::SurfaceMatch;
use crate::surfaces::{Surfaces, NO_HINT};

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
    /// Where on the target its own corners are, as far as anybody asked.
    own: Vec<Option<Location>>,
    /// What was hit last time: on the target from the mesh's corners, on the mesh from the target's.
    hints: [Vec<u32>; 2],
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
        let mesh_corners: Vec<TrianglePlace> = corner_of.into_iter().flatten().collect();
        let target_corners = target.vertices();
        let (n, m) = (mesh_corners.len(), target_corners.len());
        Self {
            own: vec![None; m],
            hints: [n, m].map(|n| vec![NO_HINT; n]),
            mesh_corners,
            target_corners,
            kept: HardCorners::default(),
        }
    }

    /// The mesh's far corners, each with its closest point on the target.
    pub(crate) fn match_mesh(
        &mut self,
        surfaces: &Surfaces<'_>,
        rng: &mut SeededRng,
    ) -> Vec<SurfaceMatch> {
        let n = surfaces.config.n_hard;
        let mut rows = std::mem::take(&mut self.kept.of_mesh);
        rows.extend(random_rows(n, self.mesh_corners.len(), rng));
        let places: Vec<TrianglePlace> = rows.iter().map(|&k| self.mesh_corners[k]).collect();
        let pairs = with_hints(&rows, &mut self.hints[0], |hints, pairs| {
            surfaces.match_places(&places, hints, pairs);
        });
        let (rows, pairs) = farthest(rows, pairs, surfaces.x, n);
        self.kept.of_mesh = rows;
        pairs
    }

    /// The target's far corners, each with its closest place on the mesh.
    pub(crate) fn match_target(
        &mut self,
        surfaces: &Surfaces<'_>,
        rng: &mut SeededRng,
    ) -> Vec<SurfaceMatch> {
        let n = surfaces.config.n_hard;
        let mut rows = std::mem::take(&mut self.kept.of_target);
        rows.extend(random_rows(n, self.target_corners.len(), rng));
        let (corners, own) = (&self.target_corners, &mut self.own);
        let sample = |&k: &usize| {
            let find = || surfaces.target.closest_point(&corners[k]).location;
            SurfaceSample {
                point: corners[k],
                location: *own[k].get_or_insert_with(find),
            }
        };
        let samples: Vec<SurfaceSample> = rows.iter().map(sample).collect();
        let pairs = with_hints(&rows, &mut self.hints[1], |hints, pairs| {
            surfaces.match_samples(&samples, hints, pairs);
        });
        let (rows, pairs) = farthest(rows, pairs, surfaces.x, n);
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
fn random_rows(n: usize, len: usize, rng: &mut SeededRng) -> impl Iterator<Item = usize> + '_ {
    let n = if len == 0 { 0 } else { n };
    (0..n).map(move |_| rng.below(len))
}

/// The pairs that `work` finds; it uses and renews the hints of these rows.
fn with_hints(
    rows: &[usize],
    of_all: &mut [u32],
    work: impl FnOnce(&mut [u32], &mut Vec<Option<SurfaceMatch>>),
) -> Vec<Option<SurfaceMatch>> {
    let mut hints: Vec<u32> = rows.iter().map(|&k| of_all[k]).collect();
    let mut pairs = Vec::new();
    work(&mut hints, &mut pairs);
    for (&k, hint) in rows.iter().zip(hints) {
        of_all[k] = hint;
    }
    pairs
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
