//! How far a place is from every landmark along its surface: where it is on the body, however the body stands.

use mesh_core::{Landmark, VertexId};
use rayon::prelude::*;

use super::graph::SampleGraph;
use super::ways::{LandmarkWays, Ways};
use super::GuideInput;

/// Landmarks nearer than this share of the longest side count alike.
const NEAR: f64 = 0.1;
/// The same where ratios of lengths are carried from landmarks to places.
const NEAR_RATIO: f64 = 0.02;
/// Ratios of lengths beyond this, up or down, are those of a path through a crack or a touch.
const LARGEST_RATIO: f64 = 5.0;
/// How much the median ratio counts beside those of landmarks at one longest side.
const MEDIAN_WEIGHT: f64 = 0.5;
/// A distance that is off by more than this, in longest sides, counts no more: the surfaces are joined otherwise there.
const LARGEST_MISFIT: f32 = 0.5;

/// Squared misfits of every vertex of a source with every sample of a target, in squared longest sides of the target:
/// `m(v, t) = Σₖ wₖ(v) (ĝₖ(v) − gₖ(t))²`
///
/// gₖ(t) is the distance along the target from sample t to landmark k. What it should be, ĝₖ(v), is the distance from v to
/// k along the source, times how much longer ways to k are on the target: a mean of that ratio over the other landmarks,
/// the nearer to v the more. Near landmarks count most, `wₖ ~ pₖ (ĝₖ + NEAR)⁻²` with pₖ the landmark's [pull](Landmark::pull), normalised to sum
/// to 1. Without a landmark
/// all is 0.
pub(super) struct Misfits {
    n_samples: usize,
    rows: Vec<f32>,
}

impl Misfits {
    /// `size` is the longest side of the target.
    pub(super) fn new(input: &GuideInput<'_>, graph: &SampleGraph, size: f64) -> Self {
        let n_samples = graph.points.len();
        let ways = Ways::new(input, graph);
        let ratios = Ratios::new(&ways.between(input.landmarks, graph), input.landmarks);
        let found = |t: usize| ways.on_target.iter().map(move |d| (d[t] / size) as f32);
        let found: Vec<f32> = (0..n_samples).flat_map(found).collect();
        let rows = input.rest.ids().collect::<Vec<VertexId>>();
        let rows = rows.into_par_iter().flat_map_iter(|v| {
            let to_landmarks: Vec<f64> = ways.on_source.iter().map(|d| d[v]).collect();
            let expected = ratios.expected(&to_landmarks, size);
            let found = &found;
            (0..n_samples).map(move |t| {
                let n = expected.len();
                misfit(&expected, &found[t * n..(t + 1) * n])
            })
        });
        Self {
            rows: rows.collect(),
            n_samples,
        }
    }

    /// Of vertex `v` with each sample.
    pub(super) fn of(&self, v: usize) -> &[f32] {
        &self.rows[v * self.n_samples..(v + 1) * self.n_samples]
    }
}

/// How much longer a way is on the target.
struct Ratios {
    /// From one landmark (row) to another (column), as a logarithm; none where no way leads.
    between: Vec<Vec<Option<f64>>>,
    /// The logarithm of the middle one.
    median: f64,
    /// What each landmark counts.
    pulls: Vec<f64>,
}

impl Ratios {
    fn new(ways: &LandmarkWays, landmarks: &[Landmark]) -> Self {
        let ratio = |i: usize, j: usize| {
            let ratio = ways.on_target[j][i] / ways.on_source[j][i];
            let is_way = i != j && ratio.is_finite() && ratio > 0.0;
            is_way.then(|| ratio.clamp(1.0 / LARGEST_RATIO, LARGEST_RATIO).ln())
        };
        let n = ways.on_source.len();
        let between: Vec<Vec<Option<f64>>> = (0..n)
            .map(|i| (0..n).map(|j| ratio(i, j)).collect())
            .collect();
        let mut all: Vec<f64> = between.iter().flatten().flatten().copied().collect();
        all.sort_by(f64::total_cmp);
        Self {
            median: all.get(all.len() / 2).copied().unwrap_or(0.0),
            between,
            pulls: landmarks.iter().map(Landmark::pull).collect(),
        }
    }

    /// What the distances of a place to each landmark should be on the target, in longest sides, and how much each counts,
    /// summing to 1 where any does; `on_source` are those along the source, `size` is the longest side of the target.
    fn expected(&self, on_source: &[f64], size: f64) -> Vec<(f32, f32)> {
        let distance = |k: usize| on_source[k] * self.median.exp() / size;
        let n = self.between.len();
        let nearness: Vec<f64> = (0..n)
            .map(|k| self.pulls[k] * (distance(k) + NEAR_RATIO).powi(-2))
            .collect();
        let of_landmark = |k: usize| {
            let (mut sum, mut total) = (self.median * MEDIAN_WEIGHT, MEDIAN_WEIGHT);
            for (i, near) in nearness.iter().enumerate() {
                if let Some(ratio) = self.between[i][k] {
                    sum += near * ratio;
                    total += near;
                }
            }
            let length = on_source[k] * (sum / total).exp() / size;
            if length.is_finite() {
                let weight = self.pulls[k] * (length + NEAR).powi(-2);
                (length as f32, weight as f32)
            } else {
                (0.0, 0.0)
            }
        };
        let mut expected: Vec<(f32, f32)> = (0..n).map(of_landmark).collect();
        let total: f32 = expected.iter().map(|e| e.1).sum();
        if total > 0.0 {
            expected.iter_mut().for_each(|e| e.1 /= total);
        }
        expected
    }
}

fn misfit(expected: &[(f32, f32)], found: &[f32]) -> f32 {
    let of_landmark = |(&(length, weight), found): (&(f32, f32), &f32)| {
        // A sample that no way leads to is infinitely far.
        weight * (length - found).abs().min(LARGEST_MISFIT).powi(2)
    };
    expected.iter().zip(found).map(of_landmark).sum()
}
