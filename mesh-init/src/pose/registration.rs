//! Two surfaces that are brought nearest to each other by closest-point iteration.

use mesh_core::sampling::SeededRng;
use mesh_core::{NormalSign, Positions, TriangleBvh, UnitFrame, Vector3};
use nalgebra::{Matrix3, SymmetricEigen};

use super::query_surface::{
    in_discs, sample_source, sample_target, Detail, ExactSurface, Place, QuerySurface, LARGE,
    N_DISCS,
};
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

    /// Whether both are the same map, to the bit.
    fn is_at(&self, other: &Self) -> bool {
        self.linear == other.linear && self.shift == other.shift
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

/// Where the closest point to each sample was found last, so that it is found sooner.
#[derive(Default)]
struct Hits {
    /// Rows of the target, for samples of the source, and of the source, for samples of the target.
    target: Vec<u32>,
    source: Vec<u32>,
}

/// Both surfaces and their samples, in boxes of longest side 1. Samples come shuffled, so that the first few are spread
/// over all of a surface.
pub(super) struct Registration<'a> {
    target: QuerySurface<'a>,
    frames: [UnitFrame; 2],
    from: QuerySurface<'a>,
    source: Vec<Place>,
    samples: Vec<Place>,
    /// Places, and what they count.
    landmarks: Vec<([Vector3; 2], f64)>,
    is_oriented: bool,
}

/// A matched pair: source, target, distance with the cost of normals, whether normals agree.
struct Matched {
    pair: [Vector3; 2],
    cost: f64,
}

impl<'a> Registration<'a> {
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
        let mut rng = SeededRng::new(input.seed);
        let source = sample_source(input.triangulation, &unit, N_FINE, &mut rng);
        let samples = sample_target(input.target, &frames[1], N_FINE, &mut rng);
        let in_units = |p: &PointPair| {
            let places = [
                frames[0].to_unit(&p.source).coords,
                frames[1].to_unit(&p.target).coords,
            ];
            (places, p.weight)
        };
        let triangles = input.triangulation;
        let is_large = [triangles.len(), input.target.vertices().len()].map(|n| n > LARGE);
        let discs = [
            is_large[0].then(|| sample_source(triangles, &unit, N_DISCS, &mut rng)),
            is_large[1].then(|| sample_target(input.target, &frames[1], N_DISCS, &mut rng)),
        ];
        let [of_source, of_target] = discs.map(|places| places.and_then(|p| in_discs(&p)));
        Some(Self {
            target: QuerySurface {
                exact: ExactSurface::Target(input.target, frames[1]),
                discs: of_target,
            },
            from: QuerySurface {
                exact: ExactSurface::Source(TriangleBvh::new(
                    input.triangulation.corners(&unit).collect(),
                )),
                discs: of_source,
            },
            samples,
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
    pub(super) fn refined(&self, at: Candidate, n_steps: usize, n_samples: usize) -> Candidate {
        self.iterated(at, n_steps, n_samples, f64::INFINITY)
    }

    /// Closest-point iteration over affine maps, where it lowers the cost.
    pub(super) fn stretched(&self, best: Candidate, n_steps: usize) -> Candidate {
        let at = self.iterated(best.clone(), n_steps, N_FINE, AFFINE_PRIOR);
        if at.cost < best.cost && at.linear.determinant() > 0.0 {
            at
        } else {
            best
        }
    }

    /// With the cost that the surfaces themselves give it, where discs stood for them.
    pub(super) fn judged(&self, mut at: Candidate) -> Candidate {
        if self.from.discs.is_some() || self.target.discs.is_some() {
            let mut hits = Hits::default();
            at.cost = self.trimmed(&at, N_FINE, &mut hits, Detail::Exact).1;
        }
        at
    }

    /// At most `n_steps` of closest-point iteration, drawn to a similarity by `prior`, until nothing moves any more.
    fn iterated(
        &self,
        mut at: Candidate,
        n_steps: usize,
        n_samples: usize,
        prior: f64,
    ) -> Candidate {
        let mut hits = Hits::default();
        for _ in 0..n_steps {
            let (matched, _) = self.trimmed(&at, n_samples, &mut hits, Detail::Discs);
            let Some(next) = self.fitted(&matched, prior) else {
                // From here on every step would be this one.
                break;
            };
            let is_settled = next.is_at(&at);
            at = next;
            if is_settled {
                break;
            }
        }
        at.cost = self.trimmed(&at, n_samples, &mut hits, Detail::Discs).1;
        at
    }

    fn fitted(&self, matched: &[Matched], prior: f64) -> Option<Candidate> {
        let weight = LANDMARK_SHARE * matched.len() as f64;
        let surfaces = matched.iter().map(|m| WeightedPair {
            source: m.pair[0],
            target: m.pair[1],
            weight: 1.0,
        });
        let marks = self
            .landmarks
            .iter()
            .map(|&([source, target], own)| WeightedPair {
                source,
                target,
                weight: weight * own,
            });
        let (linear, shift) = least_squares(surfaces.chain(marks), prior);
        let is_sound = linear.iter().all(|x| x.is_finite()) && linear.determinant() > 1e-9;
        is_sound.then_some(Candidate {
            linear,
            shift,
            cost: f64::INFINITY,
        })
    }

    /// The nearer pairs of both directions, and the mean of their costs. `hits` are those of nearly the same map.
    fn trimmed(
        &self,
        at: &Candidate,
        n: usize,
        hits: &mut Hits,
        detail: Detail,
    ) -> (Vec<Matched>, f64) {
        let Some(back) = at.linear.try_inverse() else {
            return (Vec::new(), f64::INFINITY);
        };
        let scale = at.linear.determinant().abs().cbrt();
        hits.target.resize(n, u32::MAX);
        hits.source.resize(n, u32::MAX);
        let forth = self.source.iter().zip(&mut hits.target);
        let forth = forth.filter_map(|(s, hint)| {
            let moved = at.linear * s.point + at.shift;
            let hit = self.target.closest(&moved, hint, detail)?;
            let normals = [s.normal.map(|n| at.linear * n), hit.normal];
            Some(Matched {
                pair: [s.point, hit.point],
                cost: (moved - hit.point).norm() + self.opposed(normals),
            })
        });
        let to_source = self.samples.iter().zip(&mut hits.source);
        let to_source = to_source.filter_map(|(t, hint)| {
            let moved = back * (t.point - at.shift);
            let hit = self.from.closest(&moved, hint, detail)?;
            let normals = [hit.normal.map(|n| at.linear * n), t.normal];
            Some(Matched {
                pair: [hit.point, t.point],
                cost: (moved - hit.point).norm() * scale + self.opposed(normals),
            })
        });
        let (mut all, mut cost) = (Vec::with_capacity(2 * n), 0.0);
        for mut way in [forth.collect::<Vec<_>>(), to_source.collect()] {
            way.sort_by(|a, b| a.cost.total_cmp(&b.cost));
            way.truncate((TRIMMED * way.len() as f64).ceil() as usize);
            cost += 0.5 * way.iter().map(|m| m.cost).sum::<f64>() / way.len().max(1) as f64;
            all.extend(way);
        }
        let missed = self.landmarks.iter().map(|([from, to], own)| {
            LANDMARK_SHARE * own * (at.linear * from + at.shift - to).norm()
        });
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
