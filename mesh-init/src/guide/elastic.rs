//! A surface that is drawn to goals and keeps its shape as well as it can.

use mesh_core::{Point3, Positions, Triangulation, Vector3, VertexData};
use mesh_operators::{
    cotan_laplacian, multiply, pointwise_laplacian, voronoi_mass, CsrMatrix, SolveError, SpdSolver,
};

use super::GuideConfig;
use crate::frames::{diagonal, positive, SmoothFrames};

/// The surface of [`crate::SimilarSolver`], with goals for all its vertices that change from solve to solve:
/// `(L + b² L M⁻¹ L + W) x = (I + b² L M⁻¹) δ(F) + W g`
pub(super) struct Elastic {
    frames: SmoothFrames,
    mass: VertexData<f64>,
    bending: CsrMatrix<f64>,
    stiffness: CsrMatrix<f64>,
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
        let laplacian = cotan_laplacian(triangulation, rest);
        let mass = VertexData::from(positive(&voronoi_mass(triangulation, rest)));
        let radius = config.frame_radius * size;
        let frames = SmoothFrames::new(triangulation, rest, &laplacian, &mass, radius)?;
        let bending = pointwise_laplacian(&laplacian, &mass).transpose()
            * (config.bending_length * size).powi(2);
        let stiffness = &laplacian + &(&bending * &laplacian);
        let masses = diagonal(mass.iter().copied());
        let solver = SpdSolver::new(&(&stiffness + masses * size.powi(-2)))?;
        Ok(Self {
            frames,
            mass,
            bending,
            stiffness,
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
            let delta = self.frames.turned_laplacian(x);
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
}

/// Where a vertex is drawn, and how strongly; 1 is about as strong as the surface's own pull.
#[derive(Clone, Copy, Debug)]
pub(super) struct Goal {
    pub(super) point: Point3,
    pub(super) weight: f64,
}
