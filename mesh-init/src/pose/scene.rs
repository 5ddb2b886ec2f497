//! Two surfaces that are brought nearest to each other by closest-point iteration.

use mesh_core::sampling::{TrianglePlace, TriangleSampler};
use mesh_core::{
    Location, NormalSign, Positions, TargetSurface, TriangleBvh, Triangulation, UnitFrame, Vector3,
};
use nalgebra::{Matrix3, SymmetricEigen};
use rand::seq::SliceRandom;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::PoseInput;
use crate::affine::{least_squares, PointPair, WeightedPair};

/// Samples of each surface.
pub(super) const N_FINE: usize = 1500;
/// Share of the distances that counts, each way: the farthest belong to parts that the other shape lacks.
const TRIMMED: f64 = 0.85;
/// A pair whose normals oppose costs as much more as one this far apart, in longest sides of the target's box.
const NORMAL_COST: f64 = 0.05;
/// How near the last, affine map stays to a similarity: squared length in boxes of longest side 1.
const AFFINE_PRIOR: f64 = 0.02;
/// A landmark counts as much as this share of the samples.
const LANDMARK_SHARE: f64 = 0.25;

/// A map between unit boxes, `p ↦ linear · p + shift`, and what it costs.
#[derive(Clone, Debug)]
pub(super) struct Candidate {
    pub(super) linear: Matrix3<f64>,
    pub(super) shift: Vector3,
    pub(super) cost: f64,
}

impl Candidate {
    pub(super) fn turned(linear: Matrix3<f64>) -> Self {
        Self {
            linear,
            shift: Vector3::zeros(),
            cost: f64::INFINITY,
        }
    }

    /// The angle between the rotations of two maps, in radians.
    pub(super) fn angle_to(&self, other: &Self) -> f64 {
        let [a, b] = [self, other].map(|c| mesh_core::nearest_rotation(&c.linear));
        let turn = a.transpose() * b;
        let axis = Vector3::new(
            turn[(2, 1)] - turn[(1, 2)],
            turn[(0, 2)] - turn[(2, 0)],
            turn[(1, 0)] - turn[(0, 1)],
        );
        axis.norm().atan2(turn.trace() - 1.0)
    }
}

/// A place with its normal, where there is one.
#[derive(Clone, Copy)]
struct Place {
    point: Vector3,
    normal: Option<Vector3>,
}

/// Both surfaces and their samples, in boxes of longest side 1. Samples come shuffled, so that the first few are spread
/// over all of a surface.
pub(super) struct Scene<'a> {
    target: &'a dyn TargetSurface,
    frames: [UnitFrame; 2],
    source_bvh: TriangleBvh,
    source: Vec<Place>,
    samples: Vec<Place>,
    landmarks: Vec<[Vector3; 2]>,
    is_oriented: bool,
}

/// A matched pair: source, target, distance with the cost of normals, whether normals agree.
struct Matched {
    pair: [Vector3; 2],
    cost: f64,
}

impl<'a> Scene<'a> {
    pub(super) fn new(input: &PoseInput<'a>) -> Option<Self> {
        let bounds = [
            mesh_core::Aabb::of(input.rest.iter()),
            input.target.bounds(),
        ];
        if bounds.iter().any(|b| b.longest_side() <= 0.0) || input.triangulation.is_empty() {
            return None;
        }
        let frames = bounds.map(UnitFrame::of);
        let unit: Positions = input.rest.map(|p| frames[0].to_unit(p));
        let mut rng = ChaCha8Rng::seed_from_u64(input.seed);
        let source = sample_source(input.triangulation, &unit, &mut rng);
        let mut samples = input.target.sample(N_FINE, &mut rng);
        samples.shuffle(&mut rng);
        let place = |s: &mesh_core::SurfaceSample| Place {
            point: frames[1].to_unit(&s.point).coords,
            normal: input.target.normal(&s.location),
        };
        let in_units = |p: &PointPair| {
            [
                frames[0].to_unit(&p.source).coords,
                frames[1].to_unit(&p.target).coords,
            ]
        };
        Some(Self {
            target: input.target,
            source_bvh: TriangleBvh::new(input.triangulation.corners(&unit).collect()),
            samples: samples.iter().map(place).collect(),
            landmarks: input.landmarks.iter().map(in_units).collect(),
            is_oriented: input.target.normal_sign() == NormalSign::Oriented,
            source,
            frames,
        })
    }

    /// All maps to start from: principal axes over principal axes, and axes of the files over each other.
    pub(super) fn starts(&self) -> Vec<Candidate> {
        let (from, to) = (Moments::of(&self.source), Moments::of(&self.samples));
        let scale = to.radius / from.radius;
        let mut starts = Vec::with_capacity(48);
        for turn in axis_rotations() {
            for rotation in [turn, to.axes * turn * from.axes.transpose()] {
                let linear = rotation * scale;
                starts.push(Candidate {
                    linear,
                    shift: to.mean - linear * from.mean,
                    cost: f64::INFINITY,
                });
            }
        }
        starts
    }

    /// Closest-point iteration over similarities.
    pub(super) fn refined(&self, mut at: Candidate, n_steps: usize, n_samples: usize) -> Candidate {
        for _ in 0..n_steps {
            let (matched, _) = self.trimmed(&at, n_samples);
            if let Some(next) = self.fitted(&matched, f64::INFINITY) {
                at = next;
            }
        }
        at.cost = self.trimmed(&at, n_samples).1;
        at
    }

    /// Closest-point iteration over affine maps, where it lowers the cost.
    pub(super) fn stretched(&self, best: Candidate, n_steps: usize) -> Candidate {
        let mut at = best.clone();
        for _ in 0..n_steps {
            let (matched, _) = self.trimmed(&at, N_FINE);
            if let Some(next) = self.fitted(&matched, AFFINE_PRIOR) {
                at = next;
            }
        }
        at.cost = self.trimmed(&at, N_FINE).1;
        if at.cost < best.cost && at.linear.determinant() > 0.0 {
            at
        } else {
            best
        }
    }

    fn fitted(&self, matched: &[Matched], prior: f64) -> Option<Candidate> {
        let weight = LANDMARK_SHARE * matched.len() as f64;
        let surfaces = matched.iter().map(|m| WeightedPair {
            source: m.pair[0],
            target: m.pair[1],
            weight: 1.0,
        });
        let marks = self.landmarks.iter().map(|&[source, target]| WeightedPair {
            source,
            target,
            weight,
        });
        let (linear, shift) = least_squares(surfaces.chain(marks), prior);
        let is_sound = linear.iter().all(|x| x.is_finite()) && linear.determinant() > 1e-9;
        is_sound.then_some(Candidate {
            linear,
            shift,
            cost: f64::INFINITY,
        })
    }

    /// The nearer pairs of both directions, and the mean of their costs.
    fn trimmed(&self, at: &Candidate, n: usize) -> (Vec<Matched>, f64) {
        let Some(back) = at.linear.try_inverse() else {
            return (Vec::new(), f64::INFINITY);
        };
        let scale = at.linear.determinant().abs().cbrt();
        let forth = self.source.iter().take(n).map(|s| {
            let moved = at.linear * s.point + at.shift;
            let hit = self
                .target
                .closest_point(&self.frames[1].from_unit(&moved.into()));
            let point = self.frames[1].to_unit(&hit.point).coords;
            let normals = [
                s.normal.map(|n| at.linear * n),
                self.target.normal(&hit.location),
            ];
            Matched {
                pair: [s.point, point],
                cost: (moved - point).norm() + self.opposed(normals),
            }
        });
        let to_source = self.samples.iter().take(n).filter_map(|t| {
            let moved = back * (t.point - at.shift);
            let hit = self.source_bvh.closest_point(&moved.into())?;
            let normal = match hit.location {
                Location::Triangle { index, .. } => {
                    mesh_core::measure::triangle_normal(self.source_bvh.triangle(index))
                }
                Location::Point { .. } => None,
            };
            let normals = [normal.map(|n| at.linear * n), t.normal];
            Some(Matched {
                pair: [hit.point.coords, t.point],
                cost: (moved - hit.point.coords).norm() * scale + self.opposed(normals),
            })
        });
        let (mut all, mut cost) = (Vec::with_capacity(2 * n), 0.0);
        for mut way in [forth.collect::<Vec<_>>(), to_source.collect()] {
            way.sort_by(|a, b| a.cost.total_cmp(&b.cost));
            way.truncate((TRIMMED * way.len() as f64).ceil() as usize);
            cost += 0.5 * way.iter().map(|m| m.cost).sum::<f64>() / way.len().max(1) as f64;
            all.extend(way);
        }
        let missed = self
            .landmarks
            .iter()
            .map(|[from, to]| LANDMARK_SHARE * (at.linear * from + at.shift - to).norm());
        (all, cost + missed.sum::<f64>())
    }

    /// What disagreeing normals cost.
    fn opposed(&self, [a, b]: [Option<Vector3>; 2]) -> f64 {
        let unit = a.and_then(|a| a.try_normalize(f64::MIN_POSITIVE));
        let Some(agreement) = unit.zip(b).map(|(a, b)| a.dot(&b)) else {
            return 0.0;
        };
        let agreement = if self.is_oriented {
            agreement
        } else {
            agreement.abs()
        };
        NORMAL_COST * 0.5 * (1.0 - agreement)
    }

    pub(super) fn with_units(&self, map: &Candidate) -> (Matrix3<f64>, Vector3) {
        let [from, to] = &self.frames;
        let matrix = map.linear * (to.scale / from.scale);
        let shift = map.shift * to.scale + to.center.coords;
        (matrix, shift - matrix * from.center.coords)
    }
}

/// Mean, principal axes (a rotation) and root mean squared distance from the mean.
struct Moments {
    mean: Vector3,
    axes: Matrix3<f64>,
    radius: f64,
}

impl Moments {
    fn of(places: &[Place]) -> Self {
        let n = places.len().max(1) as f64;
        let mean = places.iter().map(|p| p.point).sum::<Vector3>() / n;
        let spread = places
            .iter()
            .map(|p| (p.point - mean) * (p.point - mean).transpose())
            .sum::<Matrix3<f64>>()
            / n;
        let eigen = SymmetricEigen::new(spread);
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
        let columns = order.map(|k| eigen.eigenvectors.column(k).into_owned());
        let mut axes = Matrix3::from_columns(&columns);
        if axes.determinant() < 0.0 {
            axes.column_mut(2).neg_mut();
        }
        Self {
            mean,
            axes,
            radius: spread.trace().max(f64::MIN_POSITIVE).sqrt(),
        }
    }
}

/// The 24 rotations that turn the axes into each other, the identity first.
fn axis_rotations() -> Vec<Matrix3<f64>> {
    let mut rotations = Vec::with_capacity(24);
    for order in [
        [0, 1, 2],
        [1, 2, 0],
        [2, 0, 1],
        [0, 2, 1],
        [2, 1, 0],
        [1, 0, 2],
    ] {
        for signs in 0..8 {
            let mut turn = Matrix3::zeros();
            for (row, &column) in order.iter().enumerate() {
                turn[(row, column)] = if signs & (1 << row) == 0 { 1.0 } else { -1.0 };
            }
            if turn.determinant() > 0.0 {
                rotations.push(turn);
            }
        }
    }
    rotations
}

/// Random places of the source, uniform by area.
fn sample_source(triangulation: &Triangulation, x: &Positions, rng: &mut ChaCha8Rng) -> Vec<Place> {
    let areas = triangulation
        .corners(x)
        .map(mesh_core::measure::triangle_area);
    let places = TriangleSampler::new(areas).sample(N_FINE, rng);
    let place = |(t, w): TrianglePlace| {
        let corners = triangulation.triangles()[t].map(|v| x[v]);
        Place {
            point: corners.iter().zip(w).map(|(p, w)| p.coords * w).sum(),
            normal: mesh_core::measure::triangle_normal(corners),
        }
    };
    let mut source: Vec<Place> = places.into_iter().map(place).collect();
    source.shuffle(rng);
    source
}
