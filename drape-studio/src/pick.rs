//! From a ray in a view to a place on a shape.

use mesh_core::{Location, Point3, TriangleBvh, UnitFrame, Vector3};
use rayon::prelude::*;
use serde::Deserialize;

/// A ray in the frame of a view: that of the shape's box, its longest side 1.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Ray {
    pub(crate) origin: [f64; 3],
    pub(crate) direction: [f64; 3],
    /// How far beside the ray a point still counts, per unit of distance along it.
    pub(crate) spread: f64,
}

/// How much farther than the first point of a cloud, in longest sides of its box, a better aimed one may lie.
const CLOUD_DEPTH: f64 = 0.02;

impl Ray {
    /// Origin and direction in the coordinates of the file; none for a ray that is none.
    fn in_file(&self, frame: &UnitFrame) -> Option<(Point3, Vector3)> {
        let origin = frame.from_unit(&Point3::from(self.origin));
        let direction = Vector3::from(self.direction).try_normalize(1e-12)?;
        let is_finite = origin
            .coords
            .iter()
            .chain(&direction)
            .all(|c| c.is_finite());
        is_finite.then_some((origin, direction))
    }
}

/// Rays around one that misses, in two rings.
const N_AROUND: usize = 8;

/// Where the ray first meets the triangles; where it just misses them, the nearest place beside it.
pub(crate) fn first_hit(bvh: &TriangleBvh, frame: &UnitFrame, ray: &Ray) -> Option<Location> {
    let (origin, direction) = ray.in_file(frame)?;
    if let Some(hit) = bvh.first_hit(&origin, &direction) {
        return Some(hit.location);
    }
    let aside = direction.cross(&if direction.x.abs() < 0.7 {
        Vector3::x()
    } else {
        Vector3::y()
    });
    let (u, v) = (aside, direction.cross(&aside));
    [0.5, 1.0].into_iter().find_map(|ring| {
        let beside = (0..N_AROUND).filter_map(|k| {
            let (sin, cos) = (std::f64::consts::TAU * k as f64 / N_AROUND as f64).sin_cos();
            let reach = ring * ray.spread.clamp(0.0, 1.0);
            bvh.first_hit(&origin, &(direction + (u * cos + v * sin) * reach))
        });
        let nearest = beside.min_by(|a, b| a.distance.total_cmp(&b.distance))?;
        Some(nearest.location)
    })
}

/// The point of a cloud that a user means: of those near the ray and in front, the one nearest to it.
pub(crate) fn front_point(points: &[Point3], frame: &UnitFrame, ray: &Ray) -> Option<Point3> {
    let (origin, direction) = ray.in_file(frame)?;
    let spread = ray.spread.clamp(0.0, 1.0);
    let aimed: Vec<(f64, f64, usize)> = points
        .par_iter()
        .enumerate()
        .filter_map(|(row, p)| {
            let along = (p - origin).dot(&direction);
            let beside = (p - origin - direction * along).norm();
            (along > 0.0 && beside <= spread * along).then_some((along, beside, row))
        })
        .collect();
    let first = aimed.iter().map(|a| a.0).fold(f64::INFINITY, f64::min);
    let front = aimed
        .iter()
        .filter(|a| a.0 <= first + CLOUD_DEPTH * frame.scale);
    front
        .min_by(|a, b| a.1.total_cmp(&b.1).then(a.2.cmp(&b.2)))
        .map(|&(_, _, row)| points[row])
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh_core::{shapes, Aabb};

    fn down(x: f64, y: f64) -> Ray {
        Ray {
            origin: [x, y, 5.0],
            direction: [0.0, 0.0, -1.0],
            spread: 0.01,
        }
    }

    #[test]
    fn a_cloud_is_picked_on_its_front() {
        let points = shapes::icosphere(4).positions;
        let frame = UnitFrame::of(Aabb::of(&points));
        let picked = front_point(&points, &frame, &down(0.1, -0.2)).unwrap();
        let aim = frame.from_unit(&Point3::new(0.1, -0.2, 0.0));
        // Neighbours of the sphere are 0.08 apart; 5 units away, the ray is 0.05 wide.
        assert!((picked.xy() - aim.xy()).norm() < 0.1, "{picked}");
        assert!(picked.z > 0.5);
        assert!(front_point(&points, &frame, &down(0.9, 0.9)).is_none());
    }

    #[test]
    fn a_tip_is_met_by_a_ray_just_beside_it() {
        let soup = shapes::icosphere(2);
        let corners = soup
            .faces
            .iter()
            .map(|f| [f[0], f[1], f[2]].map(|v| soup.positions[v as usize]));
        let bvh = TriangleBvh::new(corners.collect());
        let frame = UnitFrame::of(bvh.bounds());
        // The rim is at 0.5; 5 units away, the outer ring is 0.05 wide.
        assert!(first_hit(&bvh, &frame, &down(0.53, 0.0)).is_some());
        assert!(first_hit(&bvh, &frame, &down(0.57, 0.0)).is_none());
    }

    #[test]
    fn a_ray_without_direction_picks_nothing() {
        let points = shapes::icosphere(1).positions;
        let frame = UnitFrame::of(Aabb::of(&points));
        for direction in [[0.0; 3], [f64::NAN, 0.0, 1.0], [f64::INFINITY, 0.0, 0.0]] {
            let ray = Ray {
                direction,
                ..down(0.0, 0.0)
            };
            assert!(front_point(&points, &frame, &ray).is_none());
        }
    }
}
