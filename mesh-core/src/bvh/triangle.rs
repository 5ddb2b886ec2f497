//! The closest point of one triangle.

use crate::Point3;

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
/// It is the projection onto the plane if that lies inside, else the closest of the closest points of the sides. With
/// `n = (b − a) × (c − a)`, the weights of the projection are `v = ((q − a) × (c − a))·n / |n|²`,
/// `w = ((b − a) × (q − a))·n / |n|²`, `u = 1 − v − w`.
///
/// Everything is relative to the corners, so accuracy does not suffer far from the origin. Degenerate input: of a flat
/// triangle the sides are what counts; a side of length 0 is a point.
#[inline]
pub fn closest_point_on_triangle(query: &Point3, corners: &[Point3; 3]) -> TrianglePoint {
    let Candidates {
        squared,
        inside: [v, w],
        along: [on_ab, on_ac, on_bc],
    } = Candidates::new(query, corners);
    let distance_squared = least(squared);
    let barycentric = match squared.map(|d| d == distance_squared) {
        [true, ..] => [1.0 - v - w, v, w],
        [_, true, ..] => [1.0 - on_ab, on_ab, 0.0],
        [_, _, true, _] => [1.0 - on_ac, 0.0, on_ac],
        _ => [0.0, 1.0 - on_bc, on_bc],
    };
    TrianglePoint {
        barycentric,
        distance_squared,
    }
}

/// What [`closest_point_on_triangle`] gives as the squared distance, to the bit.
#[inline(always)]
pub(super) fn squared_distance_to_triangle(query: &Point3, corners: &[Point3; 3]) -> f64 {
    least(Candidates::new(query, corners).squared)
}

/// The places that can be closest: the projection and one on each side.
struct Candidates {
    /// Squared distances: of the projection, or infinite where it lies outside; of those on ab, ac, bc.
    squared: [f64; 4],
    /// Weights of b and c at the projection.
    inside: [f64; 2],
    /// Where on ab, ac and bc, from 0 to 1.
    along: [f64; 3],
}

impl Candidates {
    /// All of them without a branch: which one wins is hard to foretell, and a wrong guess costs more than they do.
    #[inline(always)]
    fn new(query: &Point3, &[a, b, c]: &[Point3; 3]) -> Self {
        let (ab, ac, bc) = (b - a, c - a, c - b);
        let (aq, bq) = (query - a, query - b);
        let n = ab.cross(&ac);
        let n_squared = n.norm_squared();
        let v = aq.cross(&ac).dot(&n) / n_squared;
        let w = ab.cross(&aq).dot(&n) / n_squared;
        let along = [
            share(aq.dot(&ab), ab.norm_squared()),
            share(aq.dot(&ac), ac.norm_squared()),
            share(bq.dot(&bc), bc.norm_squared()),
        ];
        let is_inside = (1.0 - v - w >= 0.0) & (v >= 0.0) & (w >= 0.0);
        let projected = (aq - ab * v - ac * w).norm_squared();
        let squared = [
            if is_inside { projected } else { f64::INFINITY },
            (aq - ab * along[0]).norm_squared(),
            (aq - ac * along[1]).norm_squared(),
            (bq - bc * along[2]).norm_squared(),
        ];
        Self {
            squared,
            inside: [v, w],
            along,
        }
    }
}

#[inline(always)]
fn least([a, b, c, d]: [f64; 4]) -> f64 {
    let smaller = |a: f64, b: f64| if a < b { a } else { b };
    smaller(smaller(a, b), smaller(c, d))
}

/// How far along a side the closest point lies, between 0 and 1.
#[inline(always)]
fn share(along: f64, length_squared: f64) -> f64 {
    if along > 0.0 {
        (along / length_squared).min(1.0)
    } else {
        0.0
    }
}
