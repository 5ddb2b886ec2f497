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
    let rows: Vec<VertexId> = held.iter().map(|&(v, _)| v).collect();
    let rows = held_and_unreached(triangulation, x.len(), &rows);
    let mass = voronoi_mass(triangulation, x);
    let solve = FixedSolve::new(
        &bilaplacian(&cotan_laplacian(triangulation, x), &mass),
        &rows,
    )
    .or_else(|_| {
        let even = even_laplacian(triangulation, x.len());
        FixedSolve::new(&bilaplacian(&even, &VertexData::new(x.len(), 1.0)), &rows)
    })?;
    let mut d = VertexData::new(x.len(), Vector3::zeros());
    for &(v, value) in held {
        d[v] = value;
    }
    solve.solve_in_place(d.as_mut_slice(), &mut FixedSolveScratch::default());
    Ok(d)
}

/// The Laplacian that counts the sides of triangles and sees no shape.
fn even_laplacian(triangulation: &Triangulation, n: usize) -> CsrMatrix<f64> {
    let sides = triangulation
        .triangles()
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    uniform_laplacian(n, sides)
}
