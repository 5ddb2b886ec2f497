//! What can go wrong in a solve.

/// Why a linear system could not be solved.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SolveError {
    /// The matrix has more columns than rows, or the other way round.
    #[error("a {n_rows} × {n_columns} matrix was given where a square one is needed")]
    NotSquare {
        /// How many rows it has.
        n_rows: usize,
        /// How many columns it has.
        n_columns: usize,
    },
    /// A pivot of the factorisation is not positive: the matrix is singular, indefinite or not finite.
    #[error("the system is not positive definite at row {row}; hold at least one vertex of every connected piece")]
    NotPositiveDefinite {
        /// The row of the matrix at which the factorisation stopped.
        row: usize,
    },
    /// The matrix given to a refactorisation has other non-zeros than the first one.
    #[error("the non-zeros of the matrix have moved; factor it anew instead of refactoring")]
    PatternChanged,
    /// The matrix has more entries than 32 bits can count, or memory is short.
    #[error("a matrix of {n_rows} rows is too large to factor here")]
    TooLarge {
        /// How many rows it has.
        n_rows: usize,
    },
    /// The centres of a displacement field do not determine it.
    #[error("the displacement field over {n_centres} centres is singular")]
    SingularField {
        /// How many centres it has.
        n_centres: usize,
    },
}
