//! A fully connected layer, forward and backward, for many points at once.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};

/// `y = Wᵀ x + b`.
#[derive(Clone, PartialEq, Debug, Default)]
pub(crate) struct Layer {
    /// Entry `[i · n_outputs + o]` weighs input i in output o.
    pub(crate) weight: Vec<f32>,
    /// One entry per output.
    pub(crate) bias: Vec<f32>,
}

impl Layer {
    /// How many inputs it has.
    pub(crate) fn n_inputs(&self) -> usize {
        self.weight.len() / self.n_outputs()
    }

    /// How many outputs it has.
    pub(crate) fn n_outputs(&self) -> usize {
        self.bias.len()
    }

    /// Wᵀ, one row per output.
    pub(super) fn transposed(&self) -> MatRef<'_, f32> {
        MatRef::from_column_major_slice(&self.weight, self.n_outputs(), self.n_inputs())
    }

    /// y = Wᵀ x + b for every column x of `input`; one column of `output` each.
    pub(super) fn forward(&self, input: MatRef<'_, f32>, output: &mut [f32]) {
        for column in output.chunks_mut(self.n_outputs()) {
            column.copy_from_slice(&self.bias);
        }
        let view = MatMut::from_column_major_slice_mut(output, self.n_outputs(), input.ncols());
        matmul(view, Accum::Add, self.transposed(), input, 1.0, Par::Seq);
    }
}

#[cfg(feature = "network")]
impl Layer {
    /// `y = a (Wᵀ x + b)` from now on.
    pub(super) fn scale(&mut self, a: f32) {
        let entries = self.weight.iter_mut().chain(&mut self.bias);
        entries.for_each(|entry| *entry *= a);
    }

    /// Adds dL/dW = x (dL/dy)ᵀ and dL/db = Σ dL/dy.
    pub(super) fn add_gradient(&self, sum: &mut Self, input: MatRef<'_, f32>, by_output: &[f32]) {
        let view =
            MatMut::from_column_major_slice_mut(&mut sum.weight, self.n_outputs(), self.n_inputs());
        let by_output_view = columns(by_output, input.ncols(), self.n_outputs());
        matmul(
            view,
            Accum::Add,
            by_output_view,
            input.transpose(),
            1.0,
            Par::Seq,
        );
        for column in by_output.chunks(self.n_outputs()) {
            sum.bias.iter_mut().zip(column).for_each(|(b, d)| *b += d);
        }
    }

    /// dL/dx = W dL/dy.
    pub(super) fn pull_back(&self, by_output: &[f32], by_input: &mut Vec<f32>) {
        let n = by_output.len() / self.n_outputs();
        by_input.resize(n * self.n_inputs(), 0.0);
        matmul(
            MatMut::from_column_major_slice_mut(by_input, self.n_inputs(), n),
            Accum::Replace,
            self.transposed().transpose(),
            columns(by_output, n, self.n_outputs()),
            1.0,
            Par::Seq,
        );
    }
}

/// The rectifier that stands between layers: `max(y, 0)`.
pub(super) fn relu(activation: &mut [f32]) {
    activation.iter_mut().for_each(|y| *y = y.max(0.0));
}

/// dL/d(input of the ReLU) from `by_output` and what left it: 0 where that is 0.
#[cfg(feature = "network")]
pub(super) fn pull_back_relu(by_output: &mut [f32], activation: &[f32]) {
    for (d, &activation) in by_output.iter_mut().zip(activation) {
        *d = if activation > 0.0 { *d } else { 0.0 };
    }
}

/// The first `n_rows` rows of a matrix of `n_columns` columns.
pub(super) fn columns(entries: &[f32], n_columns: usize, n_rows: usize) -> MatRef<'_, f32> {
    MatRef::from_column_major_slice_with_stride(
        entries,
        n_rows,
        n_columns,
        entries.len() / n_columns,
    )
}
