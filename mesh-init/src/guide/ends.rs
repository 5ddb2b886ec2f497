//! Ends of parts that no landmark marks: tips of tails, ears, feet, fingers; and which of them belong together.

use mesh_core::{Landmark, Positions, Triangulation, VertexId};
use mesh_operators::geodesic_distance_unfolded;

use super::graph::SampleGraph;
use super::signature::Ratios;
use super::ways::Ways;

/// Nothing within this distance of an end is farther from everything, in longest sides. Landmarks nearer than this mark it.
const RADIUS: f64 = 0.1;
/// Ends nearer to each other than this are one.
const APART: f64 = 2.0 * RADIUS;
/// Places that are far from each other, from which it is told what is far from everything.
const N_BASES: usize = 24;
/// By how much of each step away from an end all ways become shorter, at least: 1 at the tip of a thread, 0 on a plane.
const SHARPNESS: f64 = 0.5;
/// What a squared difference of length counts beside one in where the landmarks are.
const LONGER: f64 = 0.05;
/// Ends whose misfit is larger are no pair, in squared longest sides.
const LARGEST_MISFIT: f64 = 0.04;
/// Every other pair with one of the two ends must be worse by this factor.
const DISTINCT: f64 = 3.0;
/// Added to misfits before they are compared, in squared longest sides.
const RESOLUTION: f64 = 1e-3;
/// Lengths that differ by less than this share of the longest side are equal, so that rounding chooses nothing.
const EQUAL: f64 = 1e-9;

/// Places of a shape and the ways along it.
trait Shape {
    /// Lengths of the shortest ways from a place to all; infinite where none leads.
    fn distances_from(&self, place: usize) -> Vec<f64>;

    /// The places beside a place.
    fn beside(&self, place: usize) -> Vec<usize>;
}

struct Source<'a> {
    triangulation: &'a Triangulation,
    rest: &'a Positions,
    rings: Vec<Vec<usize>>,
}

impl Shape for Source<'_> {
    fn distances_from(&self, place: usize) -> Vec<f64> {
        let from = [VertexId::new(place)];
        let distance = geodesic_distance_unfolded(self.triangulation, self.rest, &from);
        distance.iter().copied().collect()
    }

    fn beside(&self, place: usize) -> Vec<usize> {
        self.rings[place].clone()
    }
}

impl Shape for SampleGraph {
    fn distances_from(&self, place: usize) -> Vec<f64> {
        self.distances(&self.points[place])
    }

    fn beside(&self, place: usize) -> Vec<usize> {
        self.neighbours(place).collect()
    }
}

/// What ends are looked for between; the source is as large as the target.
pub(super) struct Ends<'a> {
    pub(super) triangulation: &'a Triangulation,
    pub(super) rest: &'a Positions,
    pub(super) graph: &'a SampleGraph,
    pub(super) landmarks: &'a [Landmark],
    pub(super) ways: &'a Ways,
    /// The longest side of the target.
    pub(super) size: f64,
}

impl Ends<'_> {
    /// Pairs of ends as landmarks, where the ways from the landmarks leave no doubt which belong together; none without
    /// landmarks.
    ///
    /// The misfit of ends v and t is `Σₖ wₖ (rₖ − r̄)² + LONGER r̄²` with `rₖ` how much farther t is from landmark k than v
    /// should be, and `r̄ = Σₖ wₖ rₖ`: where a part is longer on one shape than on the other, its end is farther from all
    /// landmarks by as much. `wₖ` is normalised to sum to 1.
    pub(super) fn pairs(&self) -> Vec<Landmark> {
        let on_source: Vec<Vec<f64>> = self
            .ways
            .on_source
            .iter()
            .map(|d| d.iter().copied().collect())
            .collect();
        let from = Remoteness::new(&self.source(), &on_source, self.size).ends();
        let to = Remoteness::new(self.graph, &self.ways.on_target, self.size).ends();
        let ratios = Ratios::new(
            &self.ways.between(self.landmarks, self.graph),
            self.landmarks,
        );
        let expected = from.iter().map(|&v| {
            let to_landmarks: Vec<f64> = on_source.iter().map(|d| d[v]).collect();
            ratios.expected(&to_landmarks, self.size)
        });
        let misfits: Vec<Vec<f64>> = expected
            .map(|expected| to.iter().map(|&t| self.misfit(&expected, t)).collect())
            .collect();
        let pairs = from.iter().enumerate().flat_map(|(i, &v)| {
            let (misfits, graph) = (&misfits, self.graph);
            let is_pair = move |j: &usize| is_distinct(misfits, i, *j);
            let found = (0..to.len()).filter(is_pair).collect::<Vec<usize>>();
            let pair = |j: usize| Landmark::new(VertexId::new(v), graph.points[to[j]]);
            found.into_iter().map(pair).collect::<Vec<Landmark>>()
        });
        pairs.collect()
    }

    fn source(&self) -> Source<'_> {
        let mut rings = vec![Vec::new(); self.rest.len()];
        for [a, b] in self.triangulation.edges() {
            rings[a.index()].push(b.index());
            rings[b.index()].push(a.index());
        }
        Source {
            triangulation: self.triangulation,
            rest: self.rest,
            rings,
        }
    }

    /// `expected` are the lengths of the ways to each landmark in longest sides, and how much each counts for a place
    /// beside it; the end of a part is far from all, so that they count more alike here.
    fn misfit(&self, expected: &[(f32, f32)], t: usize) -> f64 {
        let residual = |(to_landmark, (length, weight)): (&Vec<f64>, &(f32, f32))| {
            let longer = to_landmark[t] / self.size - f64::from(*length);
            (longer.clamp(-1.0, 1.0), f64::from(*weight).sqrt())
        };
        let residuals: Vec<(f64, f64)> = self
            .ways
            .on_target
            .iter()
            .zip(expected)
            .map(residual)
            .collect();
        let total: f64 = residuals.iter().map(|(_, w)| w).sum();
        let mean = residuals.iter().map(|(r, w)| w * r).sum::<f64>() / total;
        let spread: f64 = residuals.iter().map(|(r, w)| w * (r - mean).powi(2)).sum();
        spread / total + LONGER * mean * mean
    }
}

/// Whether the pair of row `i` and column `j` fits, and better by far than all others with one of the two.
fn is_distinct(misfits: &[Vec<f64>], i: usize, j: usize) -> bool {
    let limit = DISTINCT * (misfits[i][j] + RESOLUTION);
    let in_row = misfits[i].iter().enumerate().filter(|(k, _)| *k != j);
    let in_column = misfits.iter().enumerate().filter(|(k, _)| *k != i);
    let mut others = in_row
        .map(|(_, m)| *m)
        .chain(in_column.map(|(_, row)| row[j]));
    misfits[i][j] < LARGEST_MISFIT && others.all(|m| m + RESOLUTION > limit)
}

/// How far each place of a shape is from everything.
struct Remoteness<'a, S: Shape + ?Sized> {
    shape: &'a S,
    /// Distances from each landmark.
    to_landmarks: &'a [Vec<f64>],
    /// Mean distance from the landmarks and from places far from each other; 0 where no way leads to a landmark.
    mean: Vec<f64>,
    size: f64,
}

impl<'a, S: Shape + ?Sized> Remoteness<'a, S> {
    fn new(shape: &'a S, to_landmarks: &'a [Vec<f64>], size: f64) -> Self {
        let n = to_landmarks.first().map_or(0, Vec::len);
        let (mut sum, mut count, mut nearest) =
            (vec![0.0; n], vec![0usize; n], vec![f64::INFINITY; n]);
        let mut add = |distances: &[f64], nearest: &mut [f64]| {
            for (v, &d) in distances.iter().enumerate().filter(|(_, d)| d.is_finite()) {
                sum[v] += d;
                count[v] += 1;
                nearest[v] = nearest[v].min(rounded(d, size));
            }
        };
        to_landmarks.iter().for_each(|d| add(d, &mut nearest));
        for _ in 0..N_BASES {
            let reached = (0..n).filter(|&v| nearest[v].is_finite());
            let Some(far) = reached.max_by(|&a, &b| nearest[a].total_cmp(&nearest[b])) else {
                break;
            };
            add(&shape.distances_from(far), &mut nearest);
        }
        let mean = sum
            .iter()
            .zip(&count)
            .map(|(sum, &n)| rounded(sum / n.max(1) as f64, size));
        Self {
            shape,
            to_landmarks,
            mean: mean.collect(),
            size,
        }
    }

    /// Places that are farther from everything than all around, where a part ends, and that no landmark marks; the most
    /// remote first.
    fn ends(&self) -> Vec<usize> {
        let peaks = (0..self.mean.len()).filter(|&v| self.is_peak(v));
        let mut ends: Vec<(usize, Vec<f64>)> = peaks
            .map(|v| (v, self.shape.distances_from(v)))
            .filter(|(v, around)| self.is_end(*v, around))
            .collect();
        ends.sort_by(|(a, _), (b, _)| self.mean[*b].total_cmp(&self.mean[*a]));
        let mut kept: Vec<usize> = Vec::new();
        for (v, around) in ends {
            if kept.iter().all(|&u| around[u] > APART * self.size) {
                kept.push(v);
            }
        }
        kept
    }

    /// Whether nothing beside a place is more remote, and it is a way from all landmarks.
    fn is_peak(&self, v: usize) -> bool {
        let is_way = |d: &Vec<f64>| d[v] > RADIUS * self.size;
        self.mean[v] > 0.0
            && self.to_landmarks.iter().all(is_way)
            && self
                .shape
                .beside(v)
                .iter()
                .all(|&u| self.mean[u] <= self.mean[v])
    }

    /// Whether nothing around a place is more remote, and it is sharp.
    fn is_end(&self, v: usize, around: &[f64]) -> bool {
        let radius = RADIUS * self.size;
        let near = (0..around.len()).filter(|&u| u != v && around[u] <= radius);
        let lower: Vec<(f64, f64)> = near
            .map(|u| (around[u], self.mean[v] - self.mean[u]))
            .collect();
        let slopes = lower
            .iter()
            .filter(|(d, _)| *d > 0.5 * radius)
            .map(|(d, lower)| lower / d);
        let (n, sum) = slopes.fold((0usize, 0.0), |(n, sum), slope| (n + 1, sum + slope));
        lower.iter().all(|(_, lower)| *lower >= 0.0) && n > 0 && sum >= SHARPNESS * n as f64
    }
}

/// A length in steps of [`EQUAL`], as a length.
fn rounded(length: f64, size: f64) -> f64 {
    let step = EQUAL * size;
    (length / step).round() * step
}
