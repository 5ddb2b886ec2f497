//! How a source stands in the target's coordinates, found without landmarks or with one or two.

mod query_surface;
mod registration;

use mesh_core::{Point3, Positions, TargetSurface, Triangulation, Vector3};
use nalgebra::Matrix3;
use rayon::prelude::*;

use crate::affine::PointPair;
use registration::{Candidate, Registration, N_FINE};

/// Samples of each surface while all poses are tried.
const N_COARSE: usize = 250;
/// Steps of closest-point iteration with the coarse samples, and with the fine ones.
const COARSE_STEPS: usize = 12;
const FINE_STEPS: usize = 80;
/// How many of the poses tried are refined.
const N_REFINED: usize = 6;
/// Poses that turn the source by less than this (25°) from each other are one.
const SAME_TURN: f64 = 0.436;
/// Another pose whose cost is below this many times that of the best makes it ambiguous.
const NEARLY_AS_GOOD: f64 = 1.25;
/// A pose near the way the files stand is taken if its cost is below this many times that of the best.
const AS_GOOD: f64 = 1.1;
/// Costs that differ by less than this, in longest sides, are equal: samples tell no better.
const TIE: f64 = 0.002;

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
/// the files stand is taken. Of surfaces with very many triangles, closest points are those of discs at random places
/// until the poses that are left are compared.
pub fn find_pose(input: PoseInput<'_>) -> Option<Pose> {
    let registration = Registration::new(&input)?;
    let mut tried: Vec<Candidate> = registration
        .starts()
        .into_par_iter()
        .map(|start| registration.refined(start, COARSE_STEPS, N_COARSE))
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
        .map(|c| registration.refined(c, FINE_STEPS, N_FINE))
        .map(|c| registration.judged(registration.stretched(c, FINE_STEPS)))
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
    let (matrix, translation) = registration.with_units(best);
    Some(Pose {
        matrix,
        translation,
        cost: best.cost,
        turn_deg: best.angle_to(&as_given).to_degrees(),
        rival,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh_core::{shapes, TriangleSoup};
    use nalgebra::Rotation3;

    /// A ball with a long nose, a hump and no symmetry.
    fn lump(n: usize) -> mesh_core::PolygonSoup {
        let mut soup = shapes::quad_sphere(n);
        for p in &mut soup.positions {
            let bump = |at: [f64; 3], height: f64| {
                height * (-(*p - Point3::from(at)).norm_squared() * 4.0).exp()
            };
            let radius = 1.0 + bump([1.0, 0.0, 0.0], 1.2) + bump([0.0, 0.6, 0.8], 1.0);
            *p = Point3::new(1.4 * p.x * radius, 0.8 * p.y * radius, p.z * radius);
        }
        soup
    }

    /// The pose of a lump on its image, and how far its farthest vertex is off.
    fn pose(n: usize, map: impl Fn(&Point3) -> Point3) -> (Pose, f64) {
        let (mesh, rest) = lump(n).into_halfedge().unwrap();
        let mut soup = lump(n);
        soup.positions.iter_mut().for_each(|p| *p = map(p));
        let target = TriangleSoup::new(soup).unwrap();
        let found = find_pose(PoseInput {
            triangulation: &Triangulation::new(&mesh, &rest),
            rest: &rest,
            target: &target,
            landmarks: &[],
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
            let (found, worst) = pose(10, |p| turn * p * 70.0 + Vector3::new(1e4, -2e3, 5.0));
            assert!(worst < 0.01, "{k}: {worst}");
            assert!(found.rival.is_none());
            assert!((found.turn_deg - turn.angle().to_degrees()).abs() < 2.0);
        }
    }

    /// More triangles than are searched one by one: discs stand for them.
    #[test]
    fn a_large_copy_is_found_as_well() {
        let turn = Rotation3::from_euler_angles(0.3, -1.2, 2.0);
        let (found, worst) = pose(60, |p| turn * p * 0.01);
        assert!(worst < 0.01, "{worst}");
        assert!(found.rival.is_none() && found.cost < 0.002, "{found:?}");
    }

    #[test]
    fn a_stretched_copy_is_stretched() {
        let (_, worst) = pose(10, |p| Point3::new(p.x, 1.15 * p.y, 0.9 * p.z));
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

        let end = PointPair::new(Point3::new(2.0, 0.0, 0.0), Point3::new(-2.0, 0.0, 0.0));
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
