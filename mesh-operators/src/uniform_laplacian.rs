//! The Laplacian that counts neighbours and sees no shape.

use mesh_core::VertexId;
use nalgebra_sparse::{CooMatrix, CsrMatrix};

/// Combinatorial Laplacian of a graph of `n` vertices.
///
/// `L = D − A`: the number of neighbours on the diagonal, −1 for each of them.
///
/// Positive semi-definite, `n` × `n`. An edge given twice, in either direction, counts once; an edge from a vertex
/// to itself counts nothing; a vertex without edges has a zero row.
///
/// # Panics
/// If an edge names a vertex that is not there.
pub fn uniform_laplacian(
    n: usize,
    edges: impl IntoIterator<Item = [VertexId; 2]>,
) -> CsrMatrix<f64> {
    let mut unique: Vec<[VertexId; 2]> = edges
        .into_iter()
        .filter(|[a, b]| a != b)
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    unique.sort_unstable();
    unique.dedup();
    laplacian(n, unique.into_iter().map(|edge| (edge, 1.0)))
}

/// `L_ij = −w_ij`, `L_ii = Σ_j w_ij`, with every diagonal entry stored; weights of one edge add up.
pub(crate) fn laplacian(
    n: usize,
    weights: impl Iterator<Item = ([VertexId; 2], f64)>,
) -> CsrMatrix<f64> {
    let mut entries = CooMatrix::new(n, n);
    let mut diagonal = vec![0.0; n];
    for ([a, b], w) in weights {
        let (i, j) = (a.index(), b.index());
        entries.push(i, j, -w);
        entries.push(j, i, -w);
        diagonal[i] += w;
        diagonal[j] += w;
    }
    for (i, &d) in diagonal.iter().enumerate() {
        entries.push(i, i, d);
    }
    CsrMatrix::from(&entries)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn path_of_three() {
        let [a, b, c] = [0, 1, 2].map(VertexId::new);
        let l = uniform_laplacian(4, [[a, b], [b, c], [c, b], [c, c]]);
        let dense = nalgebra::DMatrix::from(&l);
        #[rustfmt::skip]
        let expected = nalgebra::DMatrix::from_row_slice(4, 4, &[
            1., -1., 0., 0.,
            -1., 2., -1., 0.,
            0., -1., 1., 0.,
            0., 0., 0., 0.,
        ]);
        assert_eq!(dense, expected);
    }
}
