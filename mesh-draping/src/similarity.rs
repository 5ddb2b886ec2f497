//! The turn, scale and shift that best carry points to points.

use mesh_core::{Point3, Vector3};
use mesh_init::PointPair;
use nalgebra::Matrix3;

/// `p ↦ b̄ + s R (p − ā)`
#[derive(Clone, Debug, PartialEq)]
pub struct Similarity {
    /// R: a rotation, or a reflection if [`Self::fit_or_mirror`] found that better.
    pub turn: Matrix3<f64>,
    scale: f64,
    from: Vector3,
    to: Vector3,
}

fn solve(pairs: &[PointPair], sign: impl Fn(&Matrix3<f64>, &Matrix3<f64>) -> f64) -> Similarity {
    let total: f64 = pairs.iter().map(|m| m.weight).sum();
    let total = if total > 0.0 { total } else { 1.0 };
    let from = pairs.iter().map(|m| m.source.coords * m.weight);
    let from = from.sum::<Vector3>() / total;
    let to = pairs.iter().map(|m| m.target.coords * m.weight);
    let to = to.sum::<Vector3>() / total;
    let centered = pairs
        .iter()
        .map(|m| (m.source.coords - from, m.target.coords - to, m.weight));
    let moments = centered.clone().map(|(a, b, w)| b * a.transpose() * w);
    let moment: Matrix3<f64> = moments.sum();
    let spread: f64 = centered.map(|(a, _, w)| a.norm_squared() * w).sum();

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
    /// The similarity of least squared error: `R = U diag(1, 1, det U Vᵀ) Vᵀ` with `U S Vᵀ = Σ w (b − b̄)(a − ā)ᵀ`, each pair
    /// counted by its weight w.
    ///
    /// Source: Umeyama 1991, Eq. 40–43. Degenerate input: points in one place give scale 0; no point gives the identity.
    pub fn fit(pairs: &[PointPair]) -> Self {
        solve(pairs, |u, v_t| (u * v_t).determinant().signum())
    }

    /// As [`Self::fit`], a mirror image allowed.
    pub fn fit_or_mirror(pairs: &[PointPair]) -> Self {
        solve(pairs, |_, _| 1.0)
    }

    /// Where the map takes a point.
    pub fn apply(&self, p: &Point3) -> Point3 {
        Point3::from(self.to + self.turn * (p.coords - self.from) * self.scale)
    }

    /// Whether it turns left into right.
    pub fn is_mirror(&self) -> bool {
        self.turn.determinant() < 0.0
    }

    /// How far from its target the map takes the source of `pair`.
    pub fn miss(&self, pair: &PointPair) -> f64 {
        (self.apply(&pair.source) - pair.target).norm()
    }

    /// Root of the mean squared miss over all pairs.
    pub fn rms(&self, pairs: &[PointPair]) -> f64 {
        let sum: f64 = pairs.iter().map(|m| self.miss(m).powi(2)).sum();
        (sum / pairs.len().max(1) as f64).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;

    fn pairs(map: impl Fn(&Point3) -> Point3) -> Vec<PointPair> {
        let prism = mesh_core::shapes::prism(5).positions;
        prism.iter().map(|p| PointPair::new(*p, map(p))).collect()
    }

    #[test]
    fn a_similarity_is_recovered() {
        let turn = Rotation3::from_euler_angles(0.3, -1.2, 2.0);
        let pairs = pairs(|p| turn * p * 7.0 + Vector3::new(1.0, 2.0, 3.0));
        let fitted = Similarity::fit(&pairs);
        assert!((fitted.turn - turn.matrix()).norm() < 1e-9);
        assert!(fitted.rms(&pairs) < 1e-9 && !fitted.is_mirror());
    }

    #[test]
    fn a_mirror_image_is_seen() {
        let pairs = pairs(|p| Point3::new(-p.x, p.y, p.z));
        assert!(Similarity::fit_or_mirror(&pairs).is_mirror());
        assert!(Similarity::fit_or_mirror(&pairs).rms(&pairs) < 1e-9);
        assert!(!Similarity::fit(&pairs).is_mirror() && Similarity::fit(&pairs).rms(&pairs) > 0.1);
    }

    #[test]
    fn a_pair_of_weight_two_counts_as_two_pairs() {
        let pairs = pairs(|p| Point3::new(p.x + p.y * p.y, 1.5 * p.y, p.z - 0.3 * p.x));
        let twice: Vec<PointPair> = pairs.iter().chain(&pairs[..2]).copied().collect();
        let mut weighted = pairs.clone();
        weighted[..2].iter_mut().for_each(|p| p.weight = 2.0);
        let (one, other) = (Similarity::fit(&twice), Similarity::fit(&weighted));
        for pair in &pairs {
            assert!((one.apply(&pair.source) - other.apply(&pair.source)).norm() < 1e-9);
        }
    }

    #[test]
    fn no_point_and_one_point_are_finite() {
        for pairs in [&pairs(|p| *p)[..0], &pairs(|p| *p)[..1]] {
            let fitted = Similarity::fit(pairs);
            assert!(fitted.rms(pairs) < 1e-12);
            assert!(fitted.turn.iter().all(|x| x.is_finite()));
        }
    }
}
