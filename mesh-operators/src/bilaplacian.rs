//! The operator whose minimisers bend as little as they can, and products with it.

use mesh_core::VertexData;
use nalgebra_sparse::CsrMatrix;

use crate::SolveValue;

/// A vertex counts as at least this share of the mean mass, so that `M⁻¹` exists.
const MIN_MASS: f64 = 1e-6;

/// Laplacian per unit of area: `M⁻¹ L`.
///
/// `l`: N × N; `mass`: N. Row `i` of its product with positions is twice the mean curvature normal at vertex `i`.
/// Degenerate input: a mass below 1e-6 of the mean counts as that much (as 1 where all are 0).
///
/// # Panics
/// If `l` is not N × N.
pub fn pointwise_laplacian(l: &CsrMatrix<f64>, mass: &VertexData<f64>) -> CsrMatrix<f64> {
    assert!(
        l.nrows() == mass.len() && l.ncols() == mass.len(),
        "one mass per row of the Laplacian"
    );
    let mean = mass.iter().sum::<f64>() / mass.len().max(1) as f64;
    let floor = if mean > 0.0 { MIN_MASS * mean } else { 1.0 };

    let mut pointwise = l.clone();
    for (mut row, &m) in pointwise.row_iter_mut().zip(mass) {
        row.values_mut()
            .iter_mut()
            .for_each(|value| *value /= m.max(floor));
    }
    pointwise
}

/// Bi-Laplacian, integrated: `L M⁻¹ L`.
///
/// `l`: N × N, symmetric; `mass`: N. Positive semi-definite. Degenerate input: as [`pointwise_laplacian`].
/// Source: Jacobson et al. 2010, mixed finite elements, lumped mass.
///
/// # Panics
/// If `l` is not N × N.
pub fn bilaplacian(l: &CsrMatrix<f64>, mass: &VertexData<f64>) -> CsrMatrix<f64> {
    l * &pointwise_laplacian(l, mass)
}

/// `a · x`, one value for each row of `a`.
///
/// # Panics
/// If `x` has not one value for each column of `a`.
pub fn multiply<T: SolveValue>(a: &CsrMatrix<f64>, x: &[T]) -> Vec<T> {
    assert_eq!(a.ncols(), x.len(), "one value for each column");
    let product = |row: nalgebra_sparse::csr::CsrRow<'_, f64>| {
        let terms = row.col_indices().iter().zip(row.values());
        terms.fold(T::default(), |mut sum, (&j, &value)| {
            sum += x[j] * value;
            sum
        })
    };
    a.row_iter().map(product).collect()
}
