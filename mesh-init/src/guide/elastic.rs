//! A surface that is drawn to goals and keeps its shape as well as it can.

use mesh_core::{nearest_rotation, Point3, Positions, Triangulation, Vector3, VertexData};
use mesh_operators::{
    cotan_laplacian, multiply, pointwise_laplacian, voronoi_mass, CsrMatrix, SolveError, SpdSolver,
};
use nalgebra::Matrix3;

use super::GuideConfig;
use crate::cells::Cells;
use crate::similar::diagonal;

/// A neighbourhood grows or shrinks at most this much.
const MAX_SCALE: f64 = 3.0;

/// The surface of [`crate::SimilarSolver`], with goals for all its vertices that change from solve to solve:
/// `(L + b² L M⁻¹ L + W) x = (I + b² L M⁻¹) δ(F) + W g`
pub(super) struct Elastic {
    cells: Cells,
    mass: VertexData<f64>,
    bending: CsrMatrix<f64>,
    stiffness: CsrMatrix<f64>,
    smoother: SpdSolver,
    rest_squares: Vec<f64>,
    solver: SpdSolver,
}

impl Elastic {
    /// For a rest shape in the target's coordinates; `size` is the longest side of the target.
    pub(super) fn new(
        triangulation: &Triangulation,
        rest: &Positions,
        size: f64,
        config: &GuideConfig,
    ) -> Result<Self, SolveError> {
        let n = rest.len();
        let laplacian = cotan_laplacian(triangulation, rest);
        let mass = voronoi_mass(triangulation, rest);
        let mean = mass.iter().sum::<f64>() / n.max(1) as f64;
        let mass = mass.map(|&m| m.max(1e-6 * mean).max(f64::MIN_POSITIVE));
        let cells = Cells::new(triangulation, rest);
        let radius = config.frame_radius * size;
        let masses = diagonal(mass.iter().copied());
        let smoother = SpdSolver::new(&(&masses + &laplacian * radius.powi(2)))?;
        let mut rest_squares = cells.rest_squares(n).into_vec();
        smoother.solve_in_place(&mut rest_squares, &mut Vec::new());
        let bending = pointwise_laplacian(&laplacian, &mass).transpose()
            * (config.bending_length * size).powi(2);
        let stiffness = &laplacian + &(&bending * &laplacian);
        let solver = SpdSolver::new(&(&stiffness + &masses * size.powi(-2)))?;
        Ok(Self {
            cells,
            mass,
            bending,
            stiffness,
            smoother,
            rest_squares,
            solver,
        })
    }

    /// The area that belongs to each vertex at rest.
    pub(super) fn mass(&self) -> &VertexData<f64> {
        &self.mass
    }

    /// `n_steps` steps of `x` towards the goals, each of its weight > 0.
    pub(super) fn draw(
        &mut self,
        x: &mut Positions,
        goals: &[Goal],
        n_steps: usize,
    ) -> Result<(), SolveError> {
        let weights = diagonal(goals.iter().map(|g| g.weight));
        self.solver.refactor(&(&self.stiffness + &weights))?;
        for _ in 0..n_steps {
            let delta = self.cells.transformed_laplacian(&self.frames(x));
            let mut right = multiply(&self.bending, &delta);
            for ((r, d), goal) in right.iter_mut().zip(&delta).zip(goals) {
                *r += d + goal.point.coords * goal.weight;
            }
            self.solver
                .solve_in_place(&mut right, &mut Vec::<Vector3>::new());
            x.iter_mut().zip(right).for_each(|(p, q)| *p = q.into());
        }
        Ok(())
    }

    /// Rotation times scale of the neighbourhood of each vertex.
    fn frames(&self, x: &Positions) -> VertexData<Matrix3<f64>> {
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

/// Where a vertex is drawn, and how strongly; 1 is about as strong as the surface's own pull.
#[derive(Clone, Copy, Debug)]
pub(super) struct Goal {
    pub(super) point: Point3,
    pub(super) weight: f64,
}
