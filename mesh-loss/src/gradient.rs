//! Derivatives of a triangle's area, normal and corner angles that several terms share.

use mesh_core::measure::area_vector;
use mesh_core::{Point3, Vector3};

/// Area, unit normal and dA/d(corner) of a triangle; none when degenerate.
pub(crate) struct AreaGradient {
    pub(crate) area: f64,
    pub(crate) corners: [Vector3; 3],
}

/// `∂A/∂a = ½ n × (c − b)`, and cyclically.
#[inline]
pub(crate) fn area_gradient([a, b, c]: [Point3; 3]) -> Option<AreaGradient> {
    let doubled = area_vector([a, b, c]);
    let length = doubled.norm();
    if length <= f64::MIN_POSITIVE {
        return None;
    }
    let n = doubled / (2.0 * length);
    Some(AreaGradient {
        area: 0.5 * length,
        corners: [n.cross(&(c - b)), n.cross(&(a - c)), n.cross(&(b - a))],
    })
}

/// Gradient at the corners from the gradient `g` with respect to the unit normal `n = N/|N|`.
///
/// `∂L/∂N = (g − (g·n) n) / |N|`; with `N = (b − a) × (c − a)`, `∂L/∂b = (c − a) × ∂L/∂N`,
/// `∂L/∂c = ∂L/∂N × (b − a)` and `∂L/∂a = −∂L/∂b − ∂L/∂c`.
#[inline]
pub(crate) fn pull_back_normal([a, b, c]: [Point3; 3], g: &Vector3) -> [Vector3; 3] {
    let doubled = area_vector([a, b, c]);
    let length = doubled.norm();
    if length <= f64::MIN_POSITIVE {
        return [Vector3::zeros(); 3];
    }
    let n = doubled / length;
    pull_back_area_vector([a, b, c], &((g - n * g.dot(&n)) / length))
}

/// Gradient at the corners from the gradient `g` with respect to `N = (b − a) × (c − a)`.
#[inline]
pub(crate) fn pull_back_area_vector([a, b, c]: [Point3; 3], g: &Vector3) -> [Vector3; 3] {
    let at_b = (c - a).cross(g);
    let at_c = g.cross(&(b - a));
    [-at_b - at_c, at_b, at_c]
}
