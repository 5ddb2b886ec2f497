//! The closest point of one triangle.

use crate::Point3;

/// Where the sine of a triangle's angle is below this, weights of the projection lose more than half their digits.
const FLAT: f64 = 1e-7;

/// A place on a triangle, found from a query point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrianglePoint {
    /// Weights of the corners, each ≥ 0, summing to 1.
    pub barycentric: [f64; 3],
    /// Squared distance to the query.
    pub distance_squared: f64,
}

impl TrianglePoint {
    /// The place in space, on the triangle with these corners.
    pub fn point(&self, corners: &[Point3; 3]) -> Point3 {
        let [u, v, w] = self.barycentric;
        let [a, b, c] = corners;
        Point3::from(a.coords * u + b.coords * v + c.coords * w)
    }
}

/// The point of a triangle closest to `query`.
///
/// With `n = (b − a) × (c − a)`, the weights of the projection onto the plane are
/// `v = ((q − a) × (c − a))·n / |n|²`, `w = ((b − a) × (q − a))·n / |n|²`, `u = 1 − v − w`. Where one is negative the
/// closest point is on a side whose weight is negative, for a triangle is convex.
///
/// Everything is relative to the corner `a`, so accuracy does not suffer far from the origin. Degenerate input: of a
/// nearly flat triangle all sides are measured, too; a side of length 0 is a point.
#[inline]
pub fn closest_point_on_triangle(query: &Point3, &[a, b, c]: &[Point3; 3]) -> TrianglePoint {
    let (ab, ac, aq) = (b - a, c - a, query - a);
    let n = ab.cross(&ac);
    let n_squared = n.norm_squared();
    let on_plane = aq.cross(&ac).dot(&n);
    let (v, w) = (on_plane / n_squared, ab.cross(&aq).dot(&n) / n_squared);
    let u = 1.0 - v - w;

    let (ab_squared, ac_squared) = (ab.norm_squared(), ac.norm_squared());
    let is_flat = n_squared <= (FLAT * ab_squared.max(ac_squared)).powi(2);
    let mut best = TrianglePoint {
        barycentric: [1.0, 0.0, 0.0],
        distance_squared: aq.norm_squared(),
    };
    let mut consider = |[u, v, w]: [f64; 3]| {
        let distance_squared = (aq - ab * v - ac * w).norm_squared();
        if distance_squared < best.distance_squared {
            best = TrianglePoint {
                barycentric: [u, v, w],
                distance_squared,
            };
        }
    };
    if u >= 0.0 && v >= 0.0 && w >= 0.0 {
        consider([u, v, w]);
    }
    if is_flat || w < 0.0 {
        let v = share(aq.dot(&ab), ab_squared);
        consider([1.0 - v, v, 0.0]);
    }
    if is_flat || v < 0.0 {
        let w = share(aq.dot(&ac), ac_squared);
        consider([1.0 - w, 0.0, w]);
    }
    if is_flat || u < 0.0 {
        let bc = c - b;
        let w = share((query - b).dot(&bc), bc.norm_squared());
        consider([0.0, 1.0 - w, w]);
    }
    best
}

/// How far along a side the closest point lies, between 0 and 1.
fn share(along: f64, length_squared: f64) -> f64 {
    if length_squared > 0.0 {
        (along / length_squared).clamp(0.0, 1.0)
    } else {
        0.0
    }
}
