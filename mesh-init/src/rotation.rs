//! The rotation nearest to a matrix.

use nalgebra::Matrix3;

/// Rotation `R` that maximises `tr(Rᵀ S)`: `R = U diag(1, 1, det(U Vᵀ)) Vᵀ` for `S = U Σ Vᵀ`.
///
/// Never a reflection. Degenerate input: where `S` leaves an axis open, any rotation that fits the others; the
/// identity for zero. Source: Kabsch 1976.
pub(crate) fn nearest_rotation(s: &Matrix3<f64>) -> Matrix3<f64> {
    let svd = s.svd(true, true);
    let (Some(mut u), Some(v_t)) = (svd.u, svd.v_t) else {
        return Matrix3::identity();
    };
    if (u * v_t).determinant() < 0.0 {
        let smallest = svd.singular_values.imin();
        u.column_mut(smallest).neg_mut();
    }
    u * v_t
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Rotation3, Vector3};

    #[test]
    fn rotations_stay_and_reflections_turn() {
        let r = Rotation3::from_euler_angles(0.3, -1.2, 2.0).into_inner();
        assert!((nearest_rotation(&(r * 4.0)) - r).norm() < 1e-14);
        let mirrored = r * Matrix3::from_diagonal(&Vector3::new(3.0, 2.0, -1.0));
        assert!((nearest_rotation(&mirrored) - r).norm() < 1e-14);
        assert_eq!(nearest_rotation(&Matrix3::zeros()).determinant(), 1.0);
    }
}
