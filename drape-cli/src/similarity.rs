//! The turn, scale and shift that best carry points to points.

use mesh_core::{Point3, Vector3};
use nalgebra::Matrix3;

/// A pair of places that belong together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Match {
    pub(crate) from: Point3,
    pub(crate) to: Point3,
}

/// `p ↦ b̄ + s R (p − ā)`
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Similarity {
    /// R: a rotation, or a reflection if [`fit_or_mirror`] found that better.
    pub(crate) turn: Matrix3<f64>,
    scale: f64,
    from: Vector3,
    to: Vector3,
}

/// The similarity of least squared error: `R = U diag(1, 1, det U Vᵀ) Vᵀ` with `U S Vᵀ = Σ (b − b̄)(a − ā)ᵀ`.
///
/// Source: Umeyama 1991, Eq. 40–43. Degenerate input: points in one place give scale 0; no point gives the identity.
pub(crate) fn fit(matches: &[Match]) -> Similarity {
    solve(matches, |u, v_t| (u * v_t).determinant().signum())
}

/// As [`fit`], a mirror image allowed.
pub(crate) fn fit_or_mirror(matches: &[Match]) -> Similarity {
    solve(matches, |_, _| 1.0)
}

fn solve(matches: &[Match], sign: impl Fn(&Matrix3<f64>, &Matrix3<f64>) -> f64) -> Similarity {
    let n = matches.len().max(1) as f64;
    let from = matches.iter().map(|m| m.from.coords).sum::<Vector3>() / n;
    let to = matches.iter().map(|m| m.to.coords).sum::<Vector3>() / n;
    let centered = matches
        .iter()
        .map(|m| (m.from.coords - from, m.to.coords - to));
    let moment: Matrix3<f64> = centered.clone().map(|(a, b)| b * a.transpose()).sum();
    let spread: f64 = centered.map(|(a, _)| a.norm_squared()).sum();

    let svd = moment.svd(true, true);
    let (turn, trace) = match (svd.u, svd.v_t) {
        (Some(u), Some(v_t)) => {
            let signs = Vector3::new(1.0, 1.0, sign(&u, &v_t));
            (
                u * Matrix3::from_diagonal(&signs) * v_t,
                svd.singular_values.dot(&signs),
            )
        }
        _ => (Matrix3::identity(), 0.0),
    };
    let scale = if spread > 0.0 { trace / spread } else { 0.0 };
    Similarity {
        turn,
        scale,
        from,
        to,
    }
}

impl Similarity {
    pub(crate) fn apply(&self, p: &Point3) -> Point3 {
        Point3::from(self.to + self.turn * (p.coords - self.from) * self.scale)
    }

    /// Whether it turns left into right.
    pub(crate) fn is_mirror(&self) -> bool {
        self.turn.determinant() < 0.0
    }

    /// How far `m` is missed.
    pub(crate) fn miss(&self, m: &Match) -> f64 {
        (self.apply(&m.from) - m.to).norm()
    }

    /// Root of the mean squared miss.
    pub(crate) fn rms(&self, matches: &[Match]) -> f64 {
        let sum: f64 = matches.iter().map(|m| self.miss(m).powi(2)).sum();
        (sum / matches.len().max(1) as f64).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;

    fn matches(map: impl Fn(&Point3) -> Point3) -> Vec<Match> {
        let prism = mesh_core::shapes::prism(5).positions;
        prism
            .iter()
            .map(|p| Match {
                from: *p,
                to: map(p),
            })
            .collect()
    }

    #[test]
    fn a_similarity_is_recovered() {
        let turn = Rotation3::from_euler_angles(0.3, -1.2, 2.0);
        let matches = matches(|p| turn * p * 7.0 + Vector3::new(1.0, 2.0, 3.0));
        let fitted = fit(&matches);
        assert!((fitted.turn - turn.matrix()).norm() < 1e-9);
        assert!(fitted.rms(&matches) < 1e-9 && !fitted.is_mirror());
    }

    #[test]
    fn a_mirror_image_is_seen() {
        let matches = matches(|p| Point3::new(-p.x, p.y, p.z));
        assert!(fit_or_mirror(&matches).is_mirror());
        assert!(fit_or_mirror(&matches).rms(&matches) < 1e-9);
        assert!(!fit(&matches).is_mirror() && fit(&matches).rms(&matches) > 0.1);
    }

    #[test]
    fn no_point_and_one_point_are_finite() {
        for matches in [&matches(|p| *p)[..0], &matches(|p| *p)[..1]] {
            let fitted = fit(matches);
            assert!(fitted.rms(matches) < 1e-12);
            assert!(fitted.turn.iter().all(|x| x.is_finite()));
        }
    }
}
