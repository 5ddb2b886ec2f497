//! Where a ray meets one triangle.

use crate::{Location, Point3, Vector3};

/// Where a ray first meets a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHit {
    /// Distance from the origin of the ray, in lengths of its direction.
    pub distance: f64,
    /// The place in space.
    pub point: Point3,
    /// The triangle and the place on it.
    pub location: Location,
}

impl RayHit {
    /// Whether `self` is nearer, or as near and on a lower row.
    pub(super) fn is_before(&self, other: &Self) -> bool {
        self.distance < other.distance
            || (self.distance == other.distance && self.row() < other.row())
    }

    fn row(&self) -> u32 {
        match self.location {
            Location::Triangle { index, .. } | Location::Point { index } => index,
        }
    }
}

/// A ray with the shear that turns it into the z axis.
///
/// Source: Woop, Benthin & Wald 2013, "Watertight ray/triangle intersection".
pub(super) struct Ray {
    origin: Point3,
    axes: [usize; 3],
    shear: [f64; 3],
}

impl Ray {
    /// None for a direction of zero length.
    pub(super) fn new(origin: &Point3, direction: &Vector3) -> Option<Self> {
        let z = direction.iamax();
        let mut axes = [(z + 1) % 3, (z + 2) % 3, z];
        if direction[z] < 0.0 {
            axes.swap(0, 1);
        }
        let [x, y, _] = axes;
        (direction[z] != 0.0).then(|| Self {
            origin: *origin,
            axes,
            shear: [
                direction[x] / direction[z],
                direction[y] / direction[z],
                1.0 / direction[z],
            ],
        })
    }

    /// The hit of the triangle in row `index`, at or after the origin.
    pub(super) fn hit(&self, corners: &[Point3; 3], index: u32) -> Option<RayHit> {
        let [x, y, z] = self.axes;
        let [sx, sy, sz] = self.shear;
        let relative = corners.map(|p| p - self.origin);
        let [a, b, c] = relative.map(|p| [p[x] - sx * p[z], p[y] - sy * p[z]]);

        let weights = [cross(c, b), cross(a, c), cross(b, a)];
        let has_outside = weights.iter().any(|&w| w < 0.0) && weights.iter().any(|&w| w > 0.0);
        let total: f64 = weights.iter().sum();
        if has_outside || total == 0.0 {
            return None;
        }

        let barycentric = weights.map(|w| w / total);
        let distance = (0..3)
            .map(|k| barycentric[k] * sz * relative[k][z])
            .sum::<f64>();
        (distance >= 0.0).then(|| RayHit {
            distance,
            point: Point3::from(
                (0..3)
                    .map(|k| corners[k].coords * barycentric[k])
                    .sum::<Vector3>(),
            ),
            location: Location::Triangle { index, barycentric },
        })
    }
}

fn cross(p: [f64; 2], q: [f64; 2]) -> f64 {
    p[0] * q[1] - p[1] * q[0]
}
