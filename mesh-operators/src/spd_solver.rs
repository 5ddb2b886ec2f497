//! Sparse Cholesky for symmetric positive definite systems: factor once, solve many times.

use std::ops::{AddAssign, Mul, Range, SubAssign};
use std::sync::Arc;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltError, LltRegularization};
use faer::sparse::linalg::cholesky::{
    factorize_symbolic_cholesky, CholeskySymbolicParams, SymbolicCholesky, SymbolicCholeskyRaw,
    SymmetricOrdering,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Par, Side};
use nalgebra_sparse::pattern::SparsityPattern;
use nalgebra_sparse::CsrMatrix;

use crate::SolveError;

/// What one row of a right-hand side holds: a number (`f64`), or a vector (`Vector3`) whose components are solved side
/// by side.
pub trait SolveValue: Copy + Default + AddAssign + SubAssign + Mul<f64, Output = Self> {}

impl<T: Copy + Default + AddAssign + SubAssign + Mul<f64, Output = T>> SolveValue for T {}

/// Cholesky factor `P A Pᵀ = L Lᵀ` of a sparse symmetric positive definite matrix.
///
/// `P` is an approximate minimum degree ordering; the factor is faer's, sequential, so that its bits do not depend on
/// the number of threads. Solves walk the factor once for all components of a [`SolveValue`].
///
/// ```
/// use mesh_operators::mesh_core::{Vector3, VertexId};
/// use mesh_operators::{uniform_laplacian, CsrMatrix, SpdSolver};
/// let [a, b] = [0, 1].map(VertexId::new);
/// let smooth = CsrMatrix::identity(2) + uniform_laplacian(2, [[a, b]]); // [2 −1; −1 2]
/// let solver = SpdSolver::new(&smooth)?;
/// let x = solver.solve(&[3.0, 0.0]);
/// assert!((x[0] - 2.0).abs() < 1e-12 && (x[1] - 1.0).abs() < 1e-12);
/// let x = solver.solve(&[Vector3::new(3., 0., 1.), Vector3::new(0., 3., 1.)]);
/// assert!((x[0] - Vector3::new(2., 1., 1.)).norm() < 1e-12);
/// # Ok::<(), mesh_operators::SolveError>(())
/// ```
#[derive(Clone, Debug)]
pub struct SpdSolver {
    pattern: SparsityPattern,
    structure: Arc<Structure>,
    values: Vec<f64>,
}

/// What a factorisation knows before it sees the values.
#[derive(Debug)]
struct Structure {
    symbolic: SymbolicCholesky<u32>,
    row_offsets: Vec<u32>,
    col_indices: Vec<u32>,
    blocks: Vec<Block>,
    longest_tail: usize,
}

/// Neighbouring columns of `L` with the same rows below them.
///
/// Their values lie column by column: first the square triangle, then one value per row of the tail.
#[derive(Clone, Debug)]
struct Block {
    columns: Range<usize>,
    tail: Range<usize>,
    first_value: usize,
}

impl SpdSolver {
    /// Factors `a`, of which only the upper triangle is read.
    ///
    /// # Errors
    /// `a` is not square, not positive definite, or too large.
    pub fn new(a: &CsrMatrix<f64>) -> Result<Self, SolveError> {
        let mut solver = Self {
            pattern: a.pattern().clone(),
            structure: Arc::new(Structure::new(a)?),
            values: Vec::new(),
        };
        solver.refactor(a)?;
        Ok(solver)
    }

    /// Factors other values on the same non-zeros, without the ordering; on an error the solver must not be used.
    ///
    /// # Errors
    /// The non-zeros are not those of the first matrix, or `a` is not positive definite.
    pub fn refactor(&mut self, a: &CsrMatrix<f64>) -> Result<(), SolveError> {
        if *a.pattern() != self.pattern {
            return Err(SolveError::PatternChanged);
        }
        self.structure.factor(a, &mut self.values)
    }

    /// How many unknowns there are.
    pub fn n_rows(&self) -> usize {
        self.structure.symbolic.nrows()
    }

    /// How many values the factor holds.
    pub fn n_values(&self) -> usize {
        self.values.len()
    }

    /// `A⁻¹ rhs`; where its rows are vectors, all their components in one pass.
    ///
    /// # Panics
    /// If there is not one value for each row.
    pub fn solve<T: SolveValue>(&self, rhs: &[T]) -> Vec<T> {
        let mut x = rhs.to_vec();
        self.solve_in_place(&mut x, &mut Vec::new());
        x
    }

    /// Replaces `x` by `A⁻¹ x`. `scratch` grows on the first call and allocates nothing afterwards.
    ///
    /// # Panics
    /// If there is not one value for each row.
    pub fn solve_in_place<T: SolveValue>(&self, x: &mut [T], scratch: &mut Vec<T>) {
        let n = self.n_rows();
        assert_eq!(x.len(), n, "one value for each row");
        scratch.resize(n + self.structure.longest_tail, T::default());
        let (y, tail) = scratch.split_at_mut(n);

        let order = self.structure.order();
        for (y, &row) in y.iter_mut().zip(order) {
            *y = x[row as usize];
        }
        self.solve_lower(y, tail);
        self.solve_upper(y, tail);
        for (y, &row) in y.iter().zip(order) {
            x[row as usize] = *y;
        }
    }

    /// `y ← L⁻¹ y`
    fn solve_lower<T: SolveValue>(&self, y: &mut [T], tail: &mut [T]) {
        for block in &self.structure.blocks {
            let rows = self.structure.tail_rows(block);
            let columns = self.columns(block, rows.len());
            if let ([diagonal], [column]) = (columns.triangle(0), columns.panel::<1>(0)) {
                let pivot = y[block.columns.start] * (1.0 / diagonal);
                y[block.columns.start] = pivot;
                for (&row, &l) in rows.iter().zip(column) {
                    y[row as usize] -= pivot * l;
                }
                continue;
            }
            let head = &mut y[block.columns.clone()];
            for k in 0..head.len() {
                let triangle = columns.triangle(k);
                head[k] = head[k] * (1.0 / triangle[k]);
                let pivot = head[k];
                for (value, &l) in head[k + 1..].iter_mut().zip(&triangle[k + 1..]) {
                    *value -= pivot * l;
                }
            }

            let sums = &mut tail[..rows.len()];
            sums.fill(T::default());
            let mut k = 0;
            while k + PANEL <= head.len() {
                add_products(sums, &head[k..], columns.panel::<PANEL>(k));
                k += PANEL;
            }
            for k in k..head.len() {
                add_products(sums, &head[k..], columns.panel::<1>(k));
            }
            for (&row, &sum) in rows.iter().zip(&*sums) {
                y[row as usize] -= sum;
            }
        }
    }

    /// `y ← L⁻ᵀ y`
    fn solve_upper<T: SolveValue>(&self, y: &mut [T], tail: &mut [T]) {
        for block in self.structure.blocks.iter().rev() {
            let rows = self.structure.tail_rows(block);
            let columns = self.columns(block, rows.len());
            if let ([diagonal], [column]) = (columns.triangle(0), columns.panel::<1>(0)) {
                let mut value = y[block.columns.start];
                for (&row, &l) in rows.iter().zip(column) {
                    value -= y[row as usize] * l;
                }
                y[block.columns.start] = value * (1.0 / diagonal);
                continue;
            }
            let below = &mut tail[..rows.len()];
            for (value, &row) in below.iter_mut().zip(rows) {
                *value = y[row as usize];
            }

            let head = &mut y[block.columns.clone()];
            let mut k = 0;
            while k + PANEL <= head.len() {
                subtract_dots(&mut head[k..], below, columns.panel::<PANEL>(k));
                k += PANEL;
            }
            for k in k..head.len() {
                subtract_dots(&mut head[k..], below, columns.panel::<1>(k));
            }
            for k in (0..head.len()).rev() {
                let triangle = columns.triangle(k);
                let mut value = head[k];
                for (&known, &l) in head[k + 1..].iter().zip(&triangle[k + 1..]) {
                    value -= known * l;
                }
                head[k] = value * (1.0 / triangle[k]);
            }
        }
    }

    fn columns(&self, block: &Block, n_tail: usize) -> Columns<'_> {
        let width = block.columns.len();
        let height = width + n_tail;
        Columns {
            values: &self.values[block.first_value..][..width * height],
            width,
            height,
        }
    }
}

/// How many columns of a block are walked side by side: so many sums stay in registers.
const PANEL: usize = 4;

/// The columns of a block.
struct Columns<'a> {
    values: &'a [f64],
    width: usize,
    height: usize,
}

impl<'a> Columns<'a> {
    /// The part of column `k` in the square triangle, from the top of the square.
    fn triangle(&self, k: usize) -> &'a [f64] {
        &self.values[k * self.height..][..self.width]
    }

    /// The parts of columns `k`, `k + 1`, … below the square.
    fn panel<const N: usize>(&self, k: usize) -> [&'a [f64]; N] {
        std::array::from_fn(|i| &self.values[(k + i) * self.height..][self.width..self.height])
    }
}

/// `sums += Σ_k pivots_k column_k`
fn add_products<T: SolveValue, const N: usize>(sums: &mut [T], pivots: &[T], columns: [&[f64]; N]) {
    let columns = columns.map(|column| &column[..sums.len()]);
    let pivots: [T; N] = std::array::from_fn(|k| pivots[k]);
    for (i, sum) in sums.iter_mut().enumerate() {
        let mut value = *sum;
        for k in 0..N {
            value += pivots[k] * columns[k][i];
        }
        *sum = value;
    }
}

/// `heads_k −= column_k · known`
fn subtract_dots<T: SolveValue, const N: usize>(
    heads: &mut [T],
    known: &[T],
    columns: [&[f64]; N],
) {
    let columns = columns.map(|column| &column[..known.len()]);
    let mut dots = [T::default(); N];
    for (i, &known) in known.iter().enumerate() {
        for k in 0..N {
            dots[k] += known * columns[k][i];
        }
    }
    for (head, dot) in heads.iter_mut().zip(dots) {
        *head -= dot;
    }
}

impl Structure {
    fn new(a: &CsrMatrix<f64>) -> Result<Self, SolveError> {
        if a.nrows() != a.ncols() {
            return Err(SolveError::NotSquare {
                n_rows: a.nrows(),
                n_columns: a.ncols(),
            });
        }
        let too_large = || SolveError::TooLarge { n_rows: a.nrows() };
        let small = |indices: &[usize]| {
            indices
                .iter()
                .map(|&i| u32::try_from(i))
                .collect::<Result<Vec<u32>, _>>()
        };
        let row_offsets = small(a.row_offsets()).map_err(|_| too_large())?;
        let col_indices = small(a.col_indices()).map_err(|_| too_large())?;
        let symbolic = factorize_symbolic_cholesky(
            columns(a.nrows(), &row_offsets, &col_indices),
            Side::Lower,
            SymmetricOrdering::Amd,
            CholeskySymbolicParams::default(),
        )
        .map_err(|_| too_large())?;
        let blocks = blocks(&symbolic);
        Ok(Self {
            longest_tail: blocks.iter().map(|b| b.tail.len()).max().unwrap_or(0),
            blocks,
            symbolic,
            row_offsets,
            col_indices,
        })
    }

    fn factor(&self, a: &CsrMatrix<f64>, values: &mut Vec<f64>) -> Result<(), SolveError> {
        let row_of = |entry: usize| a.row_offsets().partition_point(|&start| start <= entry) - 1;
        if let Some(entry) = a.values().iter().position(|v| !v.is_finite()) {
            return Err(SolveError::NotPositiveDefinite { row: row_of(entry) });
        }
        let n_rows = a.nrows();
        let matrix = SparseColMatRef::new(
            columns(n_rows, &self.row_offsets, &self.col_indices),
            a.values(),
        );
        let scratch = self
            .symbolic
            .factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let mut memory =
            MemBuffer::try_new(scratch).map_err(|_| SolveError::TooLarge { n_rows })?;
        values.resize(self.symbolic.len_val(), 0.0);
        let factored = self.symbolic.factorize_numeric_llt(
            values,
            matrix,
            Side::Lower,
            LltRegularization::default(),
            Par::Seq,
            MemStack::new(&mut memory),
            Default::default(),
        );
        match factored {
            Ok(_) => Ok(()),
            Err(LltError::NonPositivePivot { index }) => Err(SolveError::NotPositiveDefinite {
                row: self.order().get(index).map_or(index, |&row| row as usize),
            }),
        }
    }

    /// The row of `A` at each place of the factor.
    fn order(&self) -> &[u32] {
        self.symbolic.perm().map_or(&[], |p| p.arrays().0)
    }

    /// The rows below the square triangle of a block, in the factor's order.
    fn tail_rows(&self, block: &Block) -> &[u32] {
        let rows = match self.symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(factor) => factor.row_idx(),
            SymbolicCholeskyRaw::Supernodal(factor) => factor.row_idx(),
        };
        &rows[block.tail.clone()]
    }
}

/// A symmetric matrix in rows is the same matrix in columns.
fn columns<'a>(
    n: usize,
    row_offsets: &'a [u32],
    col_indices: &'a [u32],
) -> SymbolicSparseColMatRef<'a, u32> {
    SymbolicSparseColMatRef::new_checked(n, n, row_offsets, None, col_indices)
}

fn blocks(symbolic: &SymbolicCholesky<u32>) -> Vec<Block> {
    match symbolic.raw() {
        SymbolicCholeskyRaw::Simplicial(factor) => factor
            .col_ptr()
            .windows(2)
            .enumerate()
            .map(|(column, ends)| Block {
                columns: column..column + 1,
                tail: ends[0] as usize + 1..ends[1] as usize,
                first_value: ends[0] as usize,
            })
            .collect(),
        SymbolicCholeskyRaw::Supernodal(factor) => (0..factor.n_supernodes())
            .map(|s| {
                let first_row = factor.col_ptr_for_row_idx()[s] as usize;
                Block {
                    columns: factor.supernode_begin()[s] as usize
                        ..factor.supernode_end()[s] as usize,
                    tail: first_row..first_row + factor.nnz_per_super()[s] as usize,
                    first_value: factor.col_ptr_for_val()[s] as usize,
                }
            })
            .collect(),
    }
}
