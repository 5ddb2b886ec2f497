//! A short drape of a stand-in, and what it came to.

use mesh_core::sampling::SeededRng;
use mesh_core::{Point3, Positions, TriangleBvh, VertexId};
use mesh_loss::Overlap;
use mesh_metrics::{dirichlet_unit_area, HAUSDORFF_WEIGHT};
use neural_drape::{Drape, OverlapMode, Regions};

use crate::draping::set_up;
use crate::{Error, Pair, Preset};

/// Places on the target that tell how much of it is reached.
const N_SAMPLES: usize = 4000;
/// The share of the distances either way that counts as worst.
const WORST: f64 = 0.01;
/// What leaving out a whole shape costs, in the units of the distortion.
const LEFT_OUT: f64 = 2.0;

/// One trial is clearly better than another where it comes to less than this share of it.
const CLEARLY: f64 = 0.92;
/// Costs within this factor of each other are equal.
const AS_NEAR: f64 = 1.02;

/// What a short drape from a start came to.
#[derive(Clone, Debug)]
pub(super) struct Trial {
    /// Where the vertices of the stand-in came to.
    pub(super) positions: Positions,
    /// What was left out.
    pub(super) overlap: OverlapMode,
    /// Dirichlet energy of the map less that of an isometry: 0 at best.
    pub(super) distortion: f64,
    /// Mean of the worst distances, the larger of both ways, in longest sides.
    worst: f64,
    /// Whether anything was taken as lying beyond the other shape.
    is_any_left_out: bool,
    /// Shares of the source and of the target that were left out.
    left_out: [f64; 2],
}

impl Trial {
    /// Drapes the stand-in from `start`; once more as whole shapes where it is left open what lies beyond, and something
    /// was left out or the source ends openly, so that its pairs were chosen with caution at first. The better of the two.
    pub(super) fn best(
        pair: &Pair,
        preset: &Preset,
        regions: &Regions,
        start: &Positions,
    ) -> Result<Self, Error> {
        let asked = preset.drape.overlap;
        let first = Self::run(pair, preset, regions, start, asked)?;
        let ends_openly = !pair.source.triangulation().boundary().is_empty();
        if asked != OverlapMode::Auto || !(first.is_any_left_out || ends_openly) {
            return Ok(first);
        }
        let whole = Self::run(pair, preset, regions, start, OverlapMode::Full)?;
        Ok(if whole.is_better_than(&first) {
            whole
        } else {
            first
        })
    }

    /// Clearly nearer, or as near and clearly less distorted.
    fn is_better_than(&self, other: &Self) -> bool {
        let is_as_near = self.cost() <= AS_NEAR * other.cost();
        self.cost() < CLEARLY * other.cost()
            || is_as_near && self.distortion < CLEARLY * other.distortion
    }

    /// What is compared: the norm of which Q_transfer is made, of the worst distances in the place of the largest, and what
    /// leaving out costs.
    pub(super) fn cost(&self) -> f64 {
        self.distortion.hypot(HAUSDORFF_WEIGHT * self.worst)
            + LEFT_OUT * self.left_out.iter().sum::<f64>()
    }

    fn run(
        pair: &Pair,
        preset: &Preset,
        regions: &Regions,
        start: &Positions,
        overlap: OverlapMode,
    ) -> Result<Self, Error> {
        let mut config = preset.drape.trial();
        config.overlap = overlap;
        let mut drape = set_up(pair, config, start, regions)?;
        while drape.step()?.is_some() {}
        let x = drape.positions();
        let size = pair.target.judged().bounds().longest_side();
        let (to_target, mesh_left_out) = to_target(pair, &drape, &x);
        let (to_mesh, target_left_out) = to_mesh(pair, &drape, &x);
        let triangulation = pair.source.triangulation();
        let energy = dirichlet_unit_area(triangulation, pair.source.rest(), &x);
        Ok(Self {
            is_any_left_out: drape.overlap() != Overlap::default() || drape.is_mesh_part_left_out(),
            overlap,
            distortion: energy - 1.0,
            worst: worst_mean(to_target).max(worst_mean(to_mesh)) / size,
            left_out: [mesh_left_out, target_left_out],
            positions: x,
        })
    }
}

/// Distances of the middles of the triangles from the target, and the share of them that was left out.
fn to_target(pair: &Pair, drape: &Drape, x: &Positions) -> (Vec<f64>, f64) {
    let target = pair.target.draped_over();
    let triangulation = pair.source.triangulation();
    let middles: Vec<Point3> = triangulation
        .corners(x)
        .map(|[a, b, c]| Point3::from((a.coords + b.coords + c.coords) / 3.0))
        .collect();
    let attraction = drape.attraction();
    let is_left_out = |t: &[VertexId; 3]| t.iter().all(|&v| attraction[v] == 0.0);
    let hits = target.closest_points(&middles);
    let exceeds = drape.overlap().mesh_exceeds;
    let places = triangulation.triangles().iter().zip(&hits);
    let counted = places
        .filter(|(t, hit)| !(is_left_out(t) || exceeds && target.is_on_boundary(&hit.location)))
        .map(|(_, hit)| hit.distance_squared.sqrt());
    let counted: Vec<f64> = counted.collect();
    let share = 1.0 - counted.len() as f64 / middles.len().max(1) as f64;
    (counted, share)
}

/// Distances of places of the target from the mesh, and the share of them that was left out.
fn to_mesh(pair: &Pair, drape: &Drape, x: &Positions) -> (Vec<f64>, f64) {
    let target = pair.target.draped_over();
    let triangulation = pair.source.triangulation();
    let samples = target.sample(N_SAMPLES, &mut SeededRng::new(0));
    let points: Vec<Point3> = samples.iter().map(|s| s.point).collect();
    let bvh = TriangleBvh::new(triangulation.corners(x).collect());
    let exceeds = drape.overlap().target_exceeds;
    let hits = bvh.closest_points(&points);
    let is_end = |t: u32| {
        let corners = triangulation.triangles()[t as usize];
        corners.iter().any(|&v| triangulation.is_boundary_vertex(v))
    };
    let counted: Vec<f64> = hits
        .iter()
        .filter(|hit| !(exceeds && is_end(hit.location.row())))
        .map(|hit| hit.distance_squared.sqrt())
        .collect();
    let share = 1.0 - counted.len() as f64 / points.len().max(1) as f64;
    (counted, share)
}

/// Mean of the largest distances; 0 of none.
fn worst_mean(mut distances: Vec<f64>) -> f64 {
    let n = (distances.len() as f64 * WORST).ceil() as usize;
    distances.sort_by(|a, b| b.total_cmp(a));
    distances.truncate(n);
    distances.iter().sum::<f64>() / n.max(1) as f64
}
