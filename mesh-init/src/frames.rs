//! Turn and scale of what is around each vertex, smoothed over the surface.

use mesh_core::{nearest_rotation, Positions, Triangulation, Vector3, VertexData};
use mesh_operators::{CsrMatrix, SolveError, SpdSolver};
use nalgebra::Matrix3;
use nalgebra_sparse::CooMatrix;

use crate::cells::Cells;

/// A neighbourhood grows or shrinks at most this much.
const MAX_SCALE: f64 = 3.0;
/// Vertices of less area than this share of the mean count as so large, so that the smoothing is definite.
const LEAST_MASS: f64 = 1e-6;

/// The frames `F_i = s_i R_i` that carry the surroundings of each vertex from a rest shape to another.
///
/// They come from the covariances of the cells, smoothed over a radius `r` by `(M + r² L)⁻¹`, so that small features ride
/// along instead of folding.
#[derive(Clone, Debug)]
pub(crate) struct SmoothFrames {
    cells: Cells,
    smoother: SpdSolver,
    rest_squares: Vec<f64>,
}

impl SmoothFrames {
    /// For a rest shape, its Laplacian and the area of each vertex; `radius` is in its units.
    pub(crate) fn new(
        triangulation: &Triangulation,
        rest: &Positions,
        laplacian: &CsrMatrix<f64>,
        mass: &VertexData<f64>,
        radius: f64,
    ) -> Result<Self, SolveError> {
        let cells = Cells::new(triangulation, rest);
        let masses = diagonal(positive(mass).into_iter());
        let smoother = SpdSolver::new(&(masses + laplacian * radius.powi(2)))?;
        let mut rest_squares = cells.rest_squares(rest.len()).into_vec();
        smoother.solve_in_place(&mut rest_squares, &mut Vec::new());
        Ok(Self {
            cells,
            smoother,
            rest_squares,
        })
    }

    /// `δ(F)`: the Laplacian of the rest shape, transformed by the frames at `x`.
    pub(crate) fn turned_laplacian(&self, x: &Positions) -> Vec<Vector3> {
        self.cells.transformed_laplacian(&self.at(x))
    }

    /// Rotation times scale of the neighbourhood of each vertex at `x`.
    fn at(&self, x: &Positions) -> VertexData<Matrix3<f64>> {
        let mut covariances = self.cells.covariances(x).into_vec();
        self.smoother
            .solve_in_place(&mut covariances, &mut Vec::new());
        let frame = |(s, &squares): (&Matrix3<f64>, &f64)| {
            let rotation = nearest_rotation(s);
            let scale = (rotation.transpose() * s).trace() / squares;
            let bounded = scale.clamp(1.0 / MAX_SCALE, MAX_SCALE);
            rotation * if bounded.is_finite() { bounded } else { 1.0 }
        };
        covariances
            .iter()
            .zip(&self.rest_squares)
            .map(frame)
            .collect()
    }
}

/// The area of each vertex, > 0 where a vertex has none.
pub(crate) fn positive(mass: &VertexData<f64>) -> Vec<f64> {
    let mean = mass.iter().sum::<f64>() / mass.len().max(1) as f64;
    mass.iter()
        .map(|m| m.max(LEAST_MASS * mean).max(f64::MIN_POSITIVE))
        .collect()
}

pub(crate) fn diagonal(values: impl Iterator<Item = f64>) -> CsrMatrix<f64> {
    let values: Vec<f64> = values.collect();
    let rows: Vec<usize> = (0..values.len()).collect();
    let matrix =
        CooMatrix::try_from_triplets(values.len(), values.len(), rows.clone(), rows, values);
    CsrMatrix::from(&matrix.expect("the diagonal lies in the matrix"))
}
