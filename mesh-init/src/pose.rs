//! How a source stands in the target's coordinates, found without landmarks or with one or two.

use mesh_core::{
    Location, NormalSign, Point3, Positions, TargetSurface, TriangleBvh, Triangulation, UnitFrame,
    Vector3,
};
use nalgebra::{Matrix3, SymmetricEigen};
use rand::seq::SliceRandom;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use crate::affine::{least_squares, PointPair, WeightedPair};

/// Samples of each surface while all poses are tried, and at the end.
const N_COARSE: usize = 250;
const N_FINE: usize = 1500;
/// Steps of closest-point iteration with the coarse samples, and with the fine ones.
const COARSE_STEPS: usize = 12;
const FINE_STEPS: usize = 80;
/// How many of the poses tried are refined.
const N_REFINED: usize = 6;
/// Share of the distances that counts, each way: the farthest belong to parts that the other shape lacks.
const TRIMMED: f64 = 0.85;
/// A pair whose normals oppose costs as much more as one this far apart, in longest sides of the target's box.
const NORMAL_COST: f64 = 0.05;
/// How near the last, affine map stays to a similarity: squared length in boxes of longest side 1.
const AFFINE_PRIOR: f64 = 0.02;
/// Poses that turn the source by less than this (25°) from each other are one.
const SAME_TURN: f64 = 0.436;
/// Another pose whose cost is below this many times that of the best makes it ambiguous.
const NEARLY_AS_GOOD: f64 = 1.25;
/// A pose near the way the files stand is taken if its cost is below this many times that of the best.
const AS_GOOD: f64 = 1.1;
/// Costs that differ by less than this, in longest sides, are equal: samples tell no better.
const TIE: f64 = 0.002;
/// A landmark counts as much as this share of the samples.
const LANDMARK_SHARE: f64 = 0.25;

/// What a pose is found from.
#[derive(Clone, Copy)]
pub struct PoseInput<'a> {
    /// The source's polygons as triangles.
    pub triangulation: &'a Triangulation,
    /// The source's shape.
    pub rest: &'a Positions,
    /// The shape to bring it to.
    pub target: &'a dyn TargetSurface,
    /// Places that belong together, if any are known.
    pub landmarks: &'a [PointPair],
    /// Seed of the samples.
    pub seed: u64,
}

/// A map of the source into the target's coordinates: `p ↦ matrix · p + translation`.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// Rotation, scale and a little stretch.
    pub matrix: Matrix3<f64>,
    /// Where the origin goes.
    pub translation: Vector3,
    /// Trimmed mean distance between the surfaces, both ways, with what opposing normals cost; in longest sides of the
    /// target's box.
    pub cost: f64,
    /// By how much the source turns, in degrees, from the way its file stands.
    pub turn_deg: f64,
    /// The best pose that turns the source otherwise, where it is nearly as good: by how many degrees it differs, and
    /// its cost.
    pub rival: Option<(f64, f64)>,
}

impl Pose {
    /// Where the map takes `p`.
    pub fn apply(&self, p: &Point3) -> Point3 {
        Point3::from(self.matrix * p.coords + self.translation)
    }
}

/// The pose in which the surfaces lie nearest to each other; none where either has no extent.
///
/// Tried are the rotations that lay the principal axes over each other and those that turn the axes of the files into
/// each other, 24 of each. Each is refined by a trimmed closest-point iteration over similarities, both ways; the best few
/// with more samples and then over affine maps. Never mirrors. Of poses that are equally good the one nearest to the way
/// the files stand is taken.
pub fn find_pose(input: PoseInput<'_>) -> Option<Pose> {
    let scene = Scene::new(&input)?;
    let mut tried: Vec<Candidate> = scene
        .starts()
        .into_par_iter()
        .map(|start| scene.refined(start, COARSE_STEPS, N_COARSE))
        .collect();
    tried.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let mut different: Vec<Candidate> = Vec::new();
    for candidate in tried {
        if different.len() < N_REFINED
            && different.iter().all(|d| d.angle_to(&candidate) > SAME_TURN)
        {
            different.push(candidate);
        }
    }
    let mut refined: Vec<Candidate> = different
        .into_par_iter()
        .map(|c| scene.stretched(scene.refined(c, FINE_STEPS, N_FINE)))
        .collect();
    refined.sort_by(|a, b| a.cost.total_cmp(&b.cost));

    let least = refined.first()?.cost;
    let as_given = Candidate::turned(Matrix3::identity());
    let best = refined
        .iter()
        .filter(|c| c.cost <= AS_GOOD * least + TIE)
        .min_by(|a, b| a.angle_to(&as_given).total_cmp(&b.angle_to(&as_given)))?;
    let rival = refined
        .iter()
        .find(|c| c.angle_to(best) > SAME_TURN && c.cost < NEARLY_AS_GOOD * best.cost + TIE)
        .map(|c| (c.angle_to(best).to_degrees(), c.cost));
    let (matrix, translation) = scene.with_units(best);
    Some(Pose {
        matrix,
        translation,
        cost: best.cost,
        turn_deg: best.angle_to(&as_given).to_degrees(),
        rival,
    })
}

/// A map between unit boxes, `p ↦ linear · p + shift`, and what it costs.
#[derive(Clone, Debug)]
struct Candidate {
    linear: Matrix3<f64>,
    shift: Vector3,
    cost: f64,
}

impl Candidate {
    fn turned(linear: Matrix3<f64>) -> Self {
        Self {
            linear,
            shift: Vector3::zeros(),
            cost: f64::INFINITY,
        }
    }

    /// The angle between the rotations of two maps, in radians.
    fn angle_to(&self, other: &Self) -> f64 {
        let [a, b] = [self, other].map(|c| crate::rotation::nearest_rotation(&c.linear));
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

/// Both surfaces and their samples, in boxes of longest side 1.
struct Scene<'a> {
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
    fn new(input: &PoseInput<'a>) -> Option<Self> {
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
        // They come in the order of the triangles; the coarse search takes the first few.
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
    fn starts(&self) -> Vec<Candidate> {
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
    fn refined(&self, mut at: Candidate, n_steps: usize, n_samples: usize) -> Candidate {
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
    fn stretched(&self, best: Candidate) -> Candidate {
        let mut at = best.clone();
        for _ in 0..FINE_STEPS {
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

    fn with_units(&self, map: &Candidate) -> (Matrix3<f64>, Vector3) {
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
    let mut total = 0.0;
    let cumulative: Vec<f64> = triangulation
        .corners(x)
        .map(|corners| {
            total += mesh_core::measure::triangle_area(corners);
            total
        })
        .collect();
    (0..N_FINE)
        .map(|_| {
            let at = rng.random::<f64>() * total;
            let t = cumulative
                .partition_point(|&c| c <= at)
                .min(triangulation.len() - 1);
            let (r, s) = (rng.random::<f64>().sqrt(), rng.random::<f64>());
            let corners = triangulation.triangles()[t].map(|v| x[v]);
            let [a, b, c] = corners.map(|p| p.coords);
            Place {
                point: a * (1.0 - r) + b * (r * (1.0 - s)) + c * (r * s),
                normal: mesh_core::measure::triangle_normal(corners),
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh_core::{shapes, TriangleSoup};
    use nalgebra::Rotation3;

    /// A ball with a long nose, a hump and no symmetry.
    fn lump() -> mesh_core::PolygonSoup {
        let mut soup = shapes::quad_sphere(10);
        for p in &mut soup.positions {
            let bump = |at: [f64; 3], height: f64| {
                height * (-(*p - Point3::from(at)).norm_squared() * 4.0).exp()
            };
            let radius = 1.0 + bump([1.0, 0.0, 0.0], 1.2) + bump([0.0, 0.6, 0.8], 1.0);
            *p = Point3::new(1.4 * p.x * radius, 0.8 * p.y * radius, p.z * radius);
        }
        soup
    }

    fn pose(map: impl Fn(&Point3) -> Point3, landmarks: &[PointPair]) -> (Pose, f64) {
        let (mesh, rest) = lump().into_halfedge().unwrap();
        let mut soup = lump();
        soup.positions.iter_mut().for_each(|p| *p = map(p));
        let target = TriangleSoup::new(soup).unwrap();
        let found = find_pose(PoseInput {
            triangulation: &Triangulation::new(&mesh, &rest),
            rest: &rest,
            target: &target,
            landmarks,
            seed: 0,
        })
        .unwrap();
        let side = target.bounds().longest_side();
        let miss = |p: &Point3| (found.apply(p) - map(p)).norm() / side;
        let worst = rest.iter().map(miss).fold(0.0, f64::max);
        (found, worst)
    }

    #[test]
    fn a_turned_scaled_copy_is_found() {
        for (k, angles) in [(0.3, -1.2, 2.0), (3.0, 0.1, -0.4), (0.0, 0.0, 0.0)]
            .into_iter()
            .enumerate()
        {
            let turn = Rotation3::from_euler_angles(angles.0, angles.1, angles.2);
            let (found, worst) = pose(|p| turn * p * 70.0 + Vector3::new(1e4, -2e3, 5.0), &[]);
            assert!(worst < 0.01, "{k}: {worst}");
            assert!(found.rival.is_none());
            assert!((found.turn_deg - turn.angle().to_degrees()).abs() < 2.0);
        }
    }

    #[test]
    fn a_stretched_copy_is_stretched() {
        let (_, worst) = pose(|p| Point3::new(p.x, 1.15 * p.y, 0.9 * p.z), &[]);
        // The prior holds some of the stretch back; the next best way to stand misses by 0.3.
        assert!(worst < 0.1, "{worst}");
    }

    #[test]
    fn a_symmetric_shape_has_a_rival_and_a_landmark_decides() {
        let mut soup = shapes::quad_sphere(8);
        for p in &mut soup.positions {
            *p = Point3::new(2.0 * p.x, 1.3 * p.y, p.z);
        }
        let (mesh, rest) = soup.clone().into_halfedge().unwrap();
        let target = TriangleSoup::new(soup).unwrap();
        let find = |landmarks: &[PointPair]| {
            find_pose(PoseInput {
                triangulation: &Triangulation::new(&mesh, &rest),
                rest: &rest,
                target: &target,
                landmarks,
                seed: 0,
            })
            .unwrap()
        };
        let free = find(&[]);
        assert!(free
            .rival
            .is_some_and(|(angle, _)| (angle - 180.0).abs() < 1.0));
        assert!(free.turn_deg < 1.0);

        let end = PointPair {
            source: Point3::new(2.0, 0.0, 0.0),
            target: Point3::new(-2.0, 0.0, 0.0),
        };
        let turned = find(&[end]);
        assert!((turned.apply(&end.source) - end.target).norm() < 0.05);
        assert!(turned.matrix.determinant() > 0.0);
    }

    #[test]
    fn shapes_without_extent_have_none() {
        let soup = mesh_core::PolygonSoup {
            positions: vec![Point3::origin(); 3],
            faces: vec![vec![0, 1, 2]],
        };
        let target = TriangleSoup::new(soup).unwrap();
        let (mesh, rest) = shapes::tetrahedron().into_halfedge().unwrap();
        let found = find_pose(PoseInput {
            triangulation: &Triangulation::new(&mesh, &rest),
            rest: &rest,
            target: &target,
            landmarks: &[],
            seed: 0,
        });
        assert!(found.is_none());
    }
}
