//! Poisson's equation `−Δu = f` on a closed and on an open surface, with one number per vertex.
#![allow(clippy::print_stdout, reason = "an example tells what it found")]

use std::error::Error;

use mesh_operators::mesh_core::{shapes, Positions, Triangulation, VertexId};
use mesh_operators::{cotan_laplacian, voronoi_mass, FixedSolve, FixedSolveScratch, SolveError};

fn main() -> Result<(), Box<dyn Error>> {
    // On the unit sphere −Δ(xy) = 6 xy: the solution for f = 6 xy is xy, once its value at one vertex is fixed.
    let (mesh, x) = shapes::icosphere(5).into_halfedge()?;
    let sphere = Triangulation::new(&mesh, &x);
    let exact: Vec<f64> = x.iter().map(|p| p.x * p.y).collect();
    let f: Vec<f64> = exact.iter().map(|u| 6.0 * u).collect();
    let u = poisson(&sphere, &x, &f, &[VertexId::new(0)], &exact)?;
    report("sphere", &u, &exact, 1e-2);

    // On a sheet of 40 × 40 quads, held at its boundary: −Δu = −4 for u = x² + y².
    let (mesh, x) = shapes::open_grid(40, 40).into_halfedge()?;
    let sheet = Triangulation::new(&mesh, &x);
    let exact: Vec<f64> = x.iter().map(|p| p.x * p.x + p.y * p.y).collect();
    let boundary: Vec<VertexId> = sheet
        .vertices()
        .filter(|&v| sheet.is_boundary_vertex(v))
        .collect();
    let u = poisson(&sheet, &x, &vec![-4.0; x.len()], &boundary, &exact)?;
    report("sheet", &u, &exact, 1e-9);
    Ok(())
}

/// The function with `−Δu = f`, one value per vertex, that has the values of `known` at the vertices of `held`.
fn poisson(
    surface: &Triangulation,
    x: &Positions,
    f: &[f64],
    held: &[VertexId],
    known: &[f64],
) -> Result<Vec<f64>, SolveError> {
    // The Laplacian is integrated, so the right-hand side is, too: f times the area of each vertex.
    let mass = voronoi_mass(surface, x);
    let b: Vec<f64> = f.iter().zip(&mass).map(|(f, m)| f * m).collect();
    let solve = FixedSolve::new(&cotan_laplacian(surface, x), held)?;
    let mut u = known.to_vec();
    solve.solve_with_in_place(&mut u, &b, &mut FixedSolveScratch::default());
    Ok(u)
}

fn report(name: &str, u: &[f64], exact: &[f64], allowed: f64) {
    let largest = exact.iter().fold(0.0, |m: f64, e| m.max(e.abs()));
    let off = u.iter().zip(exact).map(|(u, e)| (u - e).abs() / largest);
    let most = off.fold(0.0, f64::max);
    println!("{name}: {} vertices, off by at most {most:.1e}", u.len());
    assert!(most < allowed, "{name}: {most}");
}
