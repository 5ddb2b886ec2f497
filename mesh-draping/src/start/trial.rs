//! A short drape of a stand-in, and what it came to.

use mesh_core::sampling::SeededRng;
use mesh_core::{Point3, Positions, SurfacePoint, TriangleBvh};
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
/// Another start is taken where it comes to less than this share of what the first comes to: among equals, the plain
/// deformation by landmarks is known to keep proportions.
const BETTER_START: f64 = 0.9;
/// A start whose Dirichlet energy comes to more than this above that of the first is not taken: it is nearer because it is
/// stretched.
const MORE_DISTORTED: f64 = 0.05;
/// Of two trials from one start, one is clearly better where it comes to less than this share of the other.
const CLEARLY: f64 = 0.92;
/// Costs within this factor of each other are equal.
const AS_NEAR: f64 = 1.02;
/// A place farther than this from the other shape, in longest sides, is not reached.
const FAR: f64 = 0.03;
/// Where more than this share of what was kept is not reached, the kept part does not fit either, and leaving the rest out
/// has no ground. Partial scans and masks that are draped well come to 0.08 at most, failed ones to 0.35.
const UNREACHED: f64 = 0.15;

/// What a short drape from a start came to.
#[derive(Clone, Debug)]
pub(super) struct Trial {
    /// Where the vertices of the stand-in came to.
    pub(super) positions: Positions,
    /// What was left out.
    pub(super) overlap: OverlapMode,
    /// Dirichlet energy of the map less that of an isometry: 0 at best.
    distortion: f64,
    /// Mean of the worst distances, the larger of both ways, in longest sides.
    worst: f64,
    /// The share of what was not left out that is not reached, the larger of both shapes.
    unreached: f64,
    /// Whether anything was taken as lying beyond the other shape.
    pub(super) is_any_left_out: bool,
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
        Ok(if whole.is_clearly_better_than(&first) {
            whole
        } else {
            first
        })
    }

    /// As [`Self::best`], from where a network of the rest shape has led the start ([`neural_drape::DrapeConfig::guide`]).
    pub(super) fn guided(
        pair: &Pair,
        preset: &Preset,
        regions: &Regions,
        start: &Positions,
    ) -> Result<Self, Error> {
        let mut guide = set_up(pair, preset.drape.guide(), start, regions)?;
        while guide.step()?.is_some() {}
        Self::best(pair, preset, regions, &guide.positions())
    }

    /// Whether the start of this trial is to be taken in the place of the first, whose trial is `first`.
    pub(super) fn is_better_start_than(&self, first: &Self) -> bool {
        self.cost() < BETTER_START * first.cost()
            && self.distortion <= first.distortion + MORE_DISTORTED
    }

    /// Clearly nearer, or as near and clearly less distorted; or the other left parts out and what it kept does not fit.
    fn is_clearly_better_than(&self, other: &Self) -> bool {
        let is_as_near = self.cost() <= AS_NEAR * other.cost();
        self.cost() < CLEARLY * other.cost()
            || is_as_near && self.distortion < CLEARLY * other.distortion
            || other.is_any_left_out && other.unreached > UNREACHED
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
            unreached: unreached(&to_target, size).max(unreached(&to_mesh, size)),
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
    let exceeds = drape.overlap().mesh_exceeds;
    let is_left_out = |row: usize, hit: &SurfacePoint| {
        let corners = &triangulation.triangles()[row];
        corners.iter().all(|&v| attraction[v] == 0.0)
            || exceeds && target.is_on_boundary(&hit.location)
    };
    counted(&target.closest_points(&middles), is_left_out)
}

/// Distances of places of the target from the mesh, and the share of them that was left out.
fn to_mesh(pair: &Pair, drape: &Drape, x: &Positions) -> (Vec<f64>, f64) {
    let target = pair.target.draped_over();
    let triangulation = pair.source.triangulation();
    let samples = target.sample(N_SAMPLES, &mut SeededRng::new(0));
    let points: Vec<Point3> = samples.iter().map(|s| s.point).collect();
    let bvh = TriangleBvh::new(triangulation.corners(x).collect());
    let exceeds = drape.overlap().target_exceeds;
    let is_left_out = |_, hit: &SurfacePoint| {
        let corners = &triangulation.triangles()[hit.location.row() as usize];
        exceeds && corners.iter().any(|&v| triangulation.is_boundary_vertex(v))
    };
    counted(&bvh.closest_points(&points), is_left_out)
}

/// Distances of the places that are not left out, and the share of those that are.
fn counted(
    hits: &[SurfacePoint],
    is_left_out: impl Fn(usize, &SurfacePoint) -> bool,
) -> (Vec<f64>, f64) {
    let kept = hits.iter().enumerate();
    let kept = kept.filter(|(row, hit)| !is_left_out(*row, hit));
    let distances: Vec<f64> = kept.map(|(_, hit)| hit.distance_squared.sqrt()).collect();
    let share = 1.0 - distances.len() as f64 / hits.len().max(1) as f64;
    (distances, share)
}

/// Share of the distances that are farther than [`FAR`]; 0 of none.
fn unreached(distances: &[f64], size: f64) -> f64 {
    let n_far = distances.iter().filter(|d| **d > FAR * size).count();
    n_far as f64 / distances.len().max(1) as f64
}

/// Mean of the largest distances; 0 of none.
fn worst_mean(mut distances: Vec<f64>) -> f64 {
    let n = (distances.len() as f64 * WORST).ceil() as usize;
    distances.sort_by(|a, b| b.total_cmp(a));
    distances.truncate(n);
    distances.iter().sum::<f64>() / n.max(1) as f64
}
