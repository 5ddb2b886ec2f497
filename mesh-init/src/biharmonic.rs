//! The smoothest displacement through given ones.

use mesh_core::{Positions, Triangulation, Vector3, VertexData, VertexId};
use mesh_operators::{
    bilaplacian, cotan_laplacian, uniform_laplacian, voronoi_mass, CsrMatrix, FixedSolve,
    FixedSolveScratch, SolveError,
};

use crate::reach::held_and_unreached;

/// Displacement field that takes the values of `held` and bends least in between.
///
/// `min Σ_i m_i |(M⁻¹ L d)_i|²`, `d` given at the vertices of `held`: zero keeps its place.
///
/// One entry per vertex of `x`; zero on pieces without a held vertex. Units of `x`; invariant to rigid motion
/// and uniform scale. Where degenerate triangles leave the cotangent system numerically singular, neighbours count
/// evenly instead. Source: Mesh Draping, Correspondence Setup, after Jacobson et al. 2010.
///
/// # Errors
/// The surface is so degenerate that it does not determine a field.
pub fn biharmonic_displacement(
    triangulation: &Triangulation,
    x: &Positions,
    held: &[(VertexId, Vector3)],
) -> Result<VertexData<Vector3>, SolveError> {
    let (rows, values): (Vec<VertexId>, Vec<Vector3>) = held.iter().copied().unzip();
    Ok(BiharmonicSolver::new(triangulation, x, &rows)?.solve(&values))
}

/// [`biharmonic_displacement`] for displacements that change, of vertices that stay the same: the system is factored
/// once, each solve is a back-substitution.
#[derive(Clone, Debug)]
pub struct BiharmonicSolver {
    held: Vec<VertexId>,
    solve: FixedSolve,
}

impl BiharmonicSolver {
    /// Factors the system for a shape and the vertices whose displacements will be given; they may repeat.
    ///
    /// # Errors
    /// The surface is so degenerate that it does not determine a field.
    pub fn new(
        triangulation: &Triangulation,
        x: &Positions,
        held: &[VertexId],
    ) -> Result<Self, SolveError> {
        let rows = held_and_unreached(triangulation, held);
        let mass = voronoi_mass(triangulation, x);
        let bending = bilaplacian(&cotan_laplacian(triangulation, x), &mass);
        let solve = FixedSolve::new(&bending, &rows).or_else(|_| {
            let even = even_laplacian(triangulation, x.len());
            FixedSolve::new(&bilaplacian(&even, &VertexData::new(x.len(), 1.0)), &rows)
        })?;
        Ok(Self {
            held: held.to_vec(),
            solve,
        })
    }

    /// The field with displacement `values[k]` at the k-th held vertex; of a vertex that is there twice the last counts.
    ///
    /// # Panics
    /// If there is not one displacement for each held vertex.
    pub fn solve(&self, values: &[Vector3]) -> VertexData<Vector3> {
        assert_eq!(
            values.len(),
            self.held.len(),
            "one displacement for each held vertex"
        );
        let n = self.solve.free().len() + self.solve.held().len();
        let mut d = VertexData::new(n, Vector3::zeros());
        for (&v, &value) in self.held.iter().zip(values) {
            d[v] = value;
        }
        self.solve
            .solve_in_place(d.as_mut_slice(), &mut FixedSolveScratch::default());
        d
    }
}

/// The Laplacian that counts the sides of triangles and sees no shape.
fn even_laplacian(triangulation: &Triangulation, n: usize) -> CsrMatrix<f64> {
    let sides = triangulation
        .triangles()
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    uniform_laplacian(n, sides)
}
