//! The operator whose minimisers bend as little as they can.

use mesh_core::VertexData;
use nalgebra_sparse::CsrMatrix;

/// A vertex counts as at least this share of the mean mass, so that `M⁻¹` exists.
const MIN_MASS: f64 = 1e-6;

/// Bi-Laplacian, integrated: `L M⁻¹ L`.
///
/// `l`: N × N, symmetric; `mass`: N. Positive semi-definite. Degenerate input: a mass below 1e-6 of the mean counts
/// as that much (as 1 where all are 0). Source: Jacobson et al. 2010, mixed finite elements, lumped mass.
///
/// # Panics
/// If `l` is not N × N.
pub fn bilaplacian(l: &CsrMatrix<f64>, mass: &VertexData<f64>) -> CsrMatrix<f64> {
    assert!(
        l.nrows() == mass.len() && l.ncols() == mass.len(),
        "one mass per row of the Laplacian"
    );
    let mean = mass.iter().sum::<f64>() / mass.len().max(1) as f64;
    let floor = if mean > 0.0 { MIN_MASS * mean } else { 1.0 };

    let mut inverse_mass_l = l.clone();
    for (mut row, &m) in inverse_mass_l.row_iter_mut().zip(mass) {
        row.values_mut()
            .iter_mut()
            .for_each(|value| *value /= m.max(floor));
    }
    l * &inverse_mass_l
}
