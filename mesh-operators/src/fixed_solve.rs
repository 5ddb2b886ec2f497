//! Minimising a quadratic form with some rows held at given values.

use mesh_core::VertexId;
use nalgebra_sparse::{CooMatrix, CsrMatrix};

use crate::{SolveError, SolveValue, SpdSolver};

/// Minimiser of `½ xᵀ A x − bᵀ x` where some rows of `x` are held: `A_ff x_f = b_f − A_fh x_h`.
///
/// The free block is factored once; held values and `b` may change with every solve. The rows of `x` and `b` are
/// numbers or vectors ([`SolveValue`]). With the integrated Laplacian as `A` and the mass of each vertex times `f` as
/// `b`, it solves Poisson's equation `−Δx = f`.
///
/// ```
/// use mesh_operators::mesh_core::{shapes, Triangulation, VertexId};
/// use mesh_operators::{cotan_laplacian, FixedSolve, FixedSolveScratch};
/// let (mesh, x) = shapes::open_grid(4, 4).into_halfedge()?;
/// let laplacian = cotan_laplacian(&Triangulation::new(&mesh, &x), &x);
/// let boundary: Vec<VertexId> = mesh.vertices().filter(|&v| mesh.is_boundary_vertex(v)).collect();
/// // The harmonic function that is x + 2 y on the boundary is x + 2 y inside.
/// let expected: Vec<f64> = x.iter().map(|p| p.x + 2.0 * p.y).collect();
/// let mut u = vec![0.0; x.len()];
/// for v in &boundary {
///     u[v.index()] = expected[v.index()];
/// }
/// FixedSolve::new(&laplacian, &boundary)?.solve_in_place(&mut u, &mut FixedSolveScratch::default());
/// assert!(u.iter().zip(&expected).all(|(u, e)| (u - e).abs() < 1e-12));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct FixedSolve {
    free: Vec<VertexId>,
    held: Vec<VertexId>,
    coupling: CsrMatrix<f64>,
    solver: SpdSolver,
}

impl FixedSolve {
    /// Factors the free block of `a` (N × N, symmetric positive semi-definite); `held` may repeat a row.
    ///
    /// # Errors
    /// Nothing holds some connected part of `a`, so that its free block is singular; or `a` is not square.
    ///
    /// # Panics
    /// If a held row is not there.
    pub fn new(a: &CsrMatrix<f64>, held: &[VertexId]) -> Result<Self, SolveError> {
        let mut is_held = vec![false; a.nrows()];
        for v in held {
            is_held[v.index()] = true;
        }
        let (held, free): (Vec<VertexId>, Vec<VertexId>) = (0..a.nrows())
            .map(VertexId::new)
            .partition(|v| is_held[v.index()]);
        let mut place = vec![0; a.nrows()];
        for part in [&held, &free] {
            for (i, v) in part.iter().enumerate() {
                place[v.index()] = i;
            }
        }

        let mut free_block = CooMatrix::new(free.len(), free.len());
        let mut coupling = CooMatrix::new(free.len(), held.len());
        for (i, v) in free.iter().enumerate() {
            let row = a.row(v.index());
            for (&j, &value) in row.col_indices().iter().zip(row.values()) {
                if is_held[j] {
                    coupling.push(i, place[j], value);
                } else {
                    free_block.push(i, place[j], value);
                }
            }
        }
        let solver =
            SpdSolver::new(&CsrMatrix::from(&free_block)).map_err(|error| match error {
                // Of an indefinite block the solver may name the row past the last.
                SolveError::NotPositiveDefinite { row } => SolveError::NotPositiveDefinite {
                    row: free.get(row).or(free.last()).map_or(row, |v| v.index()),
                },
                other => other,
            })?;
        Ok(Self {
            coupling: CsrMatrix::from(&coupling),
            free,
            held,
            solver,
        })
    }

    /// The rows that are solved for, in order.
    pub fn free(&self) -> &[VertexId] {
        &self.free
    }

    /// The rows that keep their values, in order.
    pub fn held(&self) -> &[VertexId] {
        &self.held
    }

    /// Replaces the free rows of `x` by the minimiser of `xᵀ A x` for the held ones in it.
    ///
    /// # Panics
    /// If `x` has not N rows.
    pub fn solve_in_place<T: SolveValue>(&self, x: &mut [T], scratch: &mut FixedSolveScratch<T>) {
        self.solve(x, |_| T::default(), scratch);
    }

    /// Replaces the free rows of `x` by the minimiser of `½ xᵀ A x − bᵀ x` for the held ones in it.
    ///
    /// # Panics
    /// If `x` and `b` have not N rows.
    pub fn solve_with_in_place<T: SolveValue>(
        &self,
        x: &mut [T],
        b: &[T],
        scratch: &mut FixedSolveScratch<T>,
    ) {
        assert_eq!(x.len(), b.len(), "one right-hand side for each row");
        self.solve(x, |v| b[v.index()], scratch);
    }

    fn solve<T: SolveValue>(
        &self,
        x: &mut [T],
        b: impl Fn(VertexId) -> T,
        scratch: &mut FixedSolveScratch<T>,
    ) {
        assert_eq!(
            x.len(),
            self.free.len() + self.held.len(),
            "one value for each row"
        );
        let FixedSolveScratch { rhs, solver } = scratch;
        rhs.clear();
        rhs.extend(
            self.free
                .iter()
                .zip(self.coupling.row_iter())
                .map(|(&v, row)| {
                    let terms = row.col_indices().iter().zip(row.values());
                    terms.fold(b(v), |mut sum, (&j, &value)| {
                        sum -= x[self.held[j].index()] * value;
                        sum
                    })
                }),
        );
        self.solver.solve_in_place(rhs, solver);
        for (v, value) in self.free.iter().zip(rhs) {
            x[v.index()] = *value;
        }
    }
}

/// Room that repeated solves share, so that they allocate nothing.
#[derive(Clone, Debug, Default)]
pub struct FixedSolveScratch<T> {
    rhs: Vec<T>,
    solver: Vec<T>,
}
