//! Deformation as rigid as possible.

use mesh_core::{Point3, Positions, Triangulation, Vector3, VertexData, VertexId};
use mesh_operators::{cotan_laplacian, FixedSolve, FixedSolveScratch, SolveError};
use nalgebra::Matrix3;

use crate::cells::Cells;
use crate::reach::held_and_unreached;
use mesh_core::nearest_rotation;

/// A solve ends when a step lowers the energy by less than this share of it.
const MIN_GAIN: f64 = 1e-5;
/// A solve ends after this many steps.
const MAX_STEPS: usize = 200;

/// As-rigid-as-possible deformation of a surface whose held vertices are moved.
///
/// `E(x) = ⅓ Σ_i min_R Σ_e w_e |e − R e₀|²`, `e` over the sides of all triangles around vertex `i`, at rest `e₀`
///
/// The energy is ≥ 0, in squared units of the rest positions, zero for a rigid motion, and never rises from step
/// to step. Pieces without a held vertex stay where the guess has
/// them. Source: Sorkine and Alexa 2007, with
/// the cells of Chao et al. 2010 ("spokes and rims"), whose energy cannot fall below zero on obtuse triangles.
///
/// ```
/// use mesh_core::{shapes, Triangulation, Vector3, VertexId};
/// use mesh_init::ArapSolver;
/// let (mesh, rest) = shapes::icosphere(1).into_halfedge()?;
/// let held = [0, 3].map(VertexId::new);
/// let solver = ArapSolver::new(&Triangulation::new(&mesh, &rest), &rest, &held)?;
/// let shift = Vector3::new(0.0, 0.0, 2.0);
/// let moved = solver.solve(&held.map(|v| rest[v] + shift), &rest);
/// assert!((moved[VertexId::new(7)] - rest[VertexId::new(7)] - shift).norm() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct ArapSolver {
    cells: Cells,
    held: Vec<VertexId>,
    solve: FixedSolve,
}

impl ArapSolver {
    /// Factors the system for a rest shape and the vertices that will be held.
    ///
    /// # Errors
    /// The surface is so degenerate that it does not determine a deformation.
    pub fn new(
        triangulation: &Triangulation,
        rest: &Positions,
        held: &[VertexId],
    ) -> Result<Self, SolveError> {
        let stay = held_and_unreached(triangulation, rest.len(), held);
        Ok(Self {
            cells: Cells::new(triangulation, rest),
            solve: FixedSolve::new(&cotan_laplacian(triangulation, rest), &stay)?,
            held: held.to_vec(),
        })
    }

    /// The deformed positions, with `targets[k]` the place of the k-th held vertex, starting at `guess`.
    ///
    /// # Panics
    /// If there is not one target for each held vertex, or not one position for each vertex.
    pub fn solve(&self, targets: &[Point3], guess: &Positions) -> Positions {
        assert_eq!(
            targets.len(),
            self.held.len(),
            "one target for each held vertex"
        );
        let mut x = guess.clone();
        for (&v, &target) in self.held.iter().zip(targets) {
            x[v] = target;
        }
        let mut room = ArapScratch::default();
        let mut energy = self.step(&mut x, &mut room);
        for _ in 1..MAX_STEPS {
            let lower = self.step(&mut x, &mut room);
            if energy - lower <= MIN_GAIN * energy {
                break;
            }
            energy = lower;
        }
        x
    }

    /// One local and one global step on `x`, whose held vertices stay; returns the energy before it.
    pub fn step(&self, x: &mut Positions, scratch: &mut ArapScratch) -> f64 {
        let rotations = self.rotations(x);
        let energy = self.cells.energy(x, &rotations);
        let delta = self.cells.carried_laplacian(&rotations);
        scratch.x.clear();
        scratch.x.extend(x.iter().map(|p| p.coords));
        self.solve
            .solve_with_in_place(&mut scratch.x, &delta, &mut scratch.solve);
        for (p, &coords) in x.iter_mut().zip(&scratch.x) {
            *p = Point3::from(coords);
        }
        energy
    }

    /// The energy at `x`.
    pub fn energy(&self, x: &Positions) -> f64 {
        self.cells.energy(x, &self.rotations(x))
    }

    fn rotations(&self, x: &Positions) -> VertexData<Matrix3<f64>> {
        self.cells.covariances(x).map(nearest_rotation)
    }
}

/// Room that the steps of an [`ArapSolver`] share.
#[derive(Clone, Debug, Default)]
pub struct ArapScratch {
    x: Vec<Vector3>,
    solve: FixedSolveScratch<Vector3>,
}
