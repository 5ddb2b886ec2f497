//! The rotation nearest to a matrix.

use nalgebra::Matrix3;

use crate::Vector3;

/// Rotation `R` that maximises `tr(Rᵀ S)`: `R = U diag(1, 1, det(U Vᵀ)) Vᵀ` for `S = U Σ Vᵀ`.
///
/// Never a reflection. Degenerate input: where `S` leaves an axis open, any rotation that fits the others; the
/// identity for zero. Source: Kabsch 1976; only the two larger singular vectors are needed, those of `Sᵀ S`.
pub fn nearest_rotation(s: &Matrix3<f64>) -> Matrix3<f64> {
    let (v1, v2) = larger_eigenvectors(s.transpose() * s);
    let Some(u1) = (s * v1).try_normalize(f64::MIN_POSITIVE) else {
        return Matrix3::identity();
    };
    let across = |w: Vector3| (w - u1 * u1.dot(&w)).try_normalize(f64::MIN_POSITIVE);
    let u2 = across(s * v2).or_else(|| across(Vector3::ith(u1.iamin(), 1.0)));
    let Some(u2) = u2 else {
        return Matrix3::identity();
    };
    u1 * v1.transpose() + u2 * v2.transpose() + u1.cross(&u2) * v1.cross(&v2).transpose()
}

/// Unit eigenvectors of the two larger eigenvalues of a symmetric matrix, by Jacobi rotations.
fn larger_eigenvectors(mut a: Matrix3<f64>) -> (Vector3, Vector3) {
    let mut v = Matrix3::identity();
    let size = a.norm_squared();
    for _ in 0..8 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if a[(p, q)] * a[(p, q)] <= 1e-32 * size {
                continue;
            }
            let theta = 0.5 * (a[(q, q)] - a[(p, p)]) / a[(p, q)];
            let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
            let cos = 1.0 / (t * t + 1.0).sqrt();
            let sin = t * cos;
            rotate(&mut a, &mut v, (p, q), (cos, sin));
        }
        let off = a[(0, 1)].powi(2) + a[(0, 2)].powi(2) + a[(1, 2)].powi(2);
        if off <= 1e-31 * size {
            break;
        }
    }
    let smallest = (0..3).fold(0, |s, k| if a[(k, k)] < a[(s, s)] { k } else { s });
    let (k, l) = ((smallest + 1) % 3, (smallest + 2) % 3);
    let (large, small) = if a[(k, k)] >= a[(l, l)] {
        (k, l)
    } else {
        (l, k)
    };
    (v.column(large).into(), v.column(small).into())
}

/// `a ← Jᵀ a J`, `v ← v J` for a rotation J in the plane (p, q).
fn rotate(
    a: &mut Matrix3<f64>,
    v: &mut Matrix3<f64>,
    (p, q): (usize, usize),
    (cos, sin): (f64, f64),
) {
    for k in 0..3 {
        let (kp, kq) = (a[(k, p)], a[(k, q)]);
        a[(k, p)] = cos * kp - sin * kq;
        a[(k, q)] = sin * kp + cos * kq;
    }
    for k in 0..3 {
        let (pk, qk) = (a[(p, k)], a[(q, k)]);
        a[(p, k)] = cos * pk - sin * qk;
        a[(q, k)] = sin * pk + cos * qk;
        let (kp, kq) = (v[(k, p)], v[(k, q)]);
        v[(k, p)] = cos * kp - sin * kq;
        v[(k, q)] = sin * kp + cos * kq;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;

    #[test]
    fn rotations_stay_and_reflections_turn() {
        let r = Rotation3::from_euler_angles(0.3, -1.2, 2.0).into_inner();
        assert!((nearest_rotation(&(r * 4.0)) - r).norm() < 1e-14);
        let mirrored = r * Matrix3::from_diagonal(&Vector3::new(3.0, 2.0, -1.0));
        assert!((nearest_rotation(&mirrored) - r).norm() < 1e-14);
        assert_eq!(nearest_rotation(&Matrix3::zeros()).determinant(), 1.0);
    }
}
