use mesh_core::measure::triangle_area;
use mesh_core::{shapes, Point3, VertexId};
use mesh_operators::{
    barycentric_mass, bilaplacian, cotan_laplacian, uniform_laplacian, voronoi_mass, CsrMatrix,
};
use nalgebra::{DMatrix, DVector};

use crate::shapes as all_shapes;

/// Largest entry, the scale that rounding is measured against.
fn scale(a: &CsrMatrix<f64>) -> f64 {
    a.values().iter().fold(0.0, |m: f64, v| m.max(v.abs()))
}

#[test]
fn constants_are_harmonic_and_matrices_symmetric_positive_semi_definite() {
    for s in all_shapes::all() {
        let cotan = cotan_laplacian(&s.triangulation, &s.rest);
        let uniform = uniform_laplacian(
            s.rest.len(),
            s.mesh.edges().map(|e| s.mesh.edge_vertices(e)),
        );
        let bend = bilaplacian(&cotan, &voronoi_mass(&s.triangulation, &s.rest));
        for (kind, a) in [
            ("cotan", cotan),
            ("uniform", uniform),
            ("bilaplacian", bend),
        ] {
            let dense = DMatrix::from(&a);
            let tolerance = 1e-13 * scale(&a) * a.nrows() as f64;
            let ones = DVector::repeat(a.nrows(), 1.0);
            assert!((&dense * ones).amax() <= tolerance, "{kind} of {}", s.name);
            assert!(
                (&dense - dense.transpose()).amax() <= tolerance,
                "{kind} of {}",
                s.name
            );
            let smallest = dense.symmetric_eigenvalues().min();
            assert!(smallest >= -tolerance, "{kind} of {}: {smallest}", s.name);
        }
    }
}

#[test]
fn linear_functions_are_harmonic_inside_a_flat_grid() {
    let mut s = all_shapes::shape("grid", shapes::open_grid(6, 5));
    // Shear and stretch the flat sheet, so that its triangles are obtuse and of several sizes.
    for p in s.rest.iter_mut() {
        *p = Point3::new(p.x + 1.7 * p.y, p.y, 0.3 * p.x)
            + nalgebra::vector![0.1 * p.x * p.x, 0.0, 0.03 * p.x * p.x];
    }
    let l = cotan_laplacian(&s.triangulation, &s.rest);
    for axis in 0..3 {
        let f = DVector::from_iterator(s.rest.len(), s.rest.iter().map(|p| p[axis]));
        let lf = DMatrix::from(&l) * &f;
        for v in s.mesh.vertices().filter(|&v| !s.mesh.is_boundary_vertex(v)) {
            assert!(
                lf[v.index()].abs() < 1e-12 * scale(&l) * f.amax(),
                "vertex {v}, axis {axis}"
            );
        }
    }
}

#[test]
fn masses_sum_to_the_area() {
    for s in all_shapes::all() {
        let area: f64 = s.triangulation.corners(&s.rest).map(triangle_area).sum();
        for mass in [
            voronoi_mass(&s.triangulation, &s.rest),
            barycentric_mass(&s.triangulation, &s.rest),
        ] {
            assert!(mass.iter().all(|&m| m > 0.0), "{}", s.name);
            let sum: f64 = mass.iter().sum();
            assert!(
                (sum - area).abs() < 1e-12 * area,
                "{}: {sum} {area}",
                s.name
            );
        }
    }
}

#[test]
fn cotan_laplacian_ignores_uniform_scale() {
    for s in all_shapes::all() {
        let small = cotan_laplacian(&s.triangulation, &s.rest);
        let large = cotan_laplacian(&s.triangulation, &s.rest.map(|p| p * 1000.0));
        for (a, b) in small.values().iter().zip(large.values()) {
            assert!((a - b).abs() < 1e-10 * scale(&small), "{}", s.name);
        }
    }
}

#[test]
fn collapsed_faces_leave_the_operators_finite_and_the_vertices_tied() {
    let mut s = all_shapes::shape("grid", shapes::open_grid(4, 4));
    let corner = s.rest[VertexId::new(6)];
    for v in [7, 11, 12] {
        s.rest[VertexId::new(v)] = corner;
    }
    let l = cotan_laplacian(&s.triangulation, &s.rest);
    let bend = bilaplacian(&l, &voronoi_mass(&s.triangulation, &s.rest));
    assert!(l
        .values()
        .iter()
        .chain(bend.values())
        .all(|v| v.is_finite()));
    let eigenvalues = DMatrix::from(&l).symmetric_eigenvalues();
    let zeros = eigenvalues.iter().filter(|&&e| e < 1e-9).count();
    assert_eq!(zeros, 1, "one connected piece has one constant");
}
