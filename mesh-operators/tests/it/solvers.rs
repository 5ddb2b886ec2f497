use mesh_core::{shapes, Vector3, VertexId};
use mesh_operators::{
    bilaplacian, cotan_laplacian, multiply, uniform_laplacian, voronoi_mass, CsrMatrix, FixedSolve,
    FixedSolveScratch, SolveError, SpdSolver,
};
use proptest::prelude::*;

use crate::shapes as all_shapes;

/// `I + 5 L`, the smoothing operator that draping solves with.
fn smoothing(s: &all_shapes::Shape) -> CsrMatrix<f64> {
    let edges = s.mesh.edges().map(|e| s.mesh.edge_vertices(e));
    CsrMatrix::identity(s.rest.len()) + uniform_laplacian(s.rest.len(), edges) * 5.0
}

fn wave(n: usize) -> Vec<Vector3> {
    (0..n)
        .map(|i| {
            Vector3::new(
                (i as f64).sin(),
                (1.3 * i as f64).cos(),
                1.0 / (1.0 + i as f64),
            )
        })
        .collect()
}

/// Small systems keep one column a block, large ones get wide blocks: both must solve.
#[test]
fn solution_gives_back_the_right_hand_side() {
    let mut shapes = all_shapes::all();
    shapes.push(all_shapes::shape(
        "large quad sphere",
        shapes::quad_sphere(30),
    ));
    for s in shapes {
        let stiff = {
            let l = cotan_laplacian(&s.triangulation, &s.rest);
            CsrMatrix::identity(s.rest.len())
                + bilaplacian(&l, &voronoi_mass(&s.triangulation, &s.rest)) * 1e-3
        };
        for a in [smoothing(&s), stiff] {
            let x = wave(s.rest.len());
            let solved = SpdSolver::new(&a).unwrap().solve(&multiply(&a, &x));
            for (got, expected) in solved.iter().zip(&x) {
                assert!((got - expected).norm() < 1e-9, "{}", s.name);
            }
        }
    }
}

#[test]
fn components_solve_as_numbers_do() {
    let s = all_shapes::shape("icosphere", shapes::icosphere(3));
    let solver = SpdSolver::new(&smoothing(&s)).unwrap();
    let b = wave(s.rest.len());
    let all = solver.solve(&b);
    for axis in 0..3 {
        let column: Vec<f64> = b.iter().map(|v| v[axis]).collect();
        for (one, three) in solver.solve(&column).iter().zip(&all) {
            assert!((one - three[axis]).abs() < 1e-14);
        }
    }
}

#[test]
fn refactoring_equals_factoring_anew() {
    let s = all_shapes::shape("quad sphere", shapes::quad_sphere(6));
    let first = smoothing(&s);
    let second = first.clone() * 3.0;
    let mut solver = SpdSolver::new(&first).unwrap();
    solver.refactor(&second).unwrap();
    let b = wave(s.rest.len());
    assert_eq!(solver.solve(&b), SpdSolver::new(&second).unwrap().solve(&b));
    let other = CsrMatrix::identity(s.rest.len());
    assert_eq!(solver.refactor(&other), Err(SolveError::PatternChanged));
}

#[test]
fn what_cannot_be_solved_is_an_error() {
    let s = all_shapes::shape("icosphere", shapes::icosphere(1));
    let l = cotan_laplacian(&s.triangulation, &s.rest);
    let negative = l.clone() * -1.0;
    assert!(matches!(
        SpdSolver::new(&negative),
        Err(SolveError::NotPositiveDefinite { .. })
    ));
    let mut broken = smoothing(&s);
    broken.values_mut()[3] = f64::NAN;
    assert!(matches!(
        SpdSolver::new(&broken),
        Err(SolveError::NotPositiveDefinite { row: 0 })
    ));
    let wide = CsrMatrix::zeros(2, 3);
    assert!(matches!(
        SpdSolver::new(&wide),
        Err(SolveError::NotSquare { .. })
    ));
    assert_eq!(SpdSolver::new(&CsrMatrix::zeros(0, 0)).unwrap().n_rows(), 0);
}

#[test]
fn held_rows_keep_their_values_and_the_rest_is_stationary() {
    for s in all_shapes::all() {
        let l = cotan_laplacian(&s.triangulation, &s.rest);
        let held = [0, 3].map(VertexId::new);
        let solve = FixedSolve::new(&l, &held).unwrap();
        let boundary = [Vector3::new(1., 2., 3.), Vector3::new(-1., 0.5, 0.)];
        let mut x = wave(s.rest.len());
        let b = wave(s.rest.len());
        for (v, value) in held.iter().zip(boundary) {
            x[v.index()] = value;
        }
        solve.solve_with_in_place(&mut x, &b, &mut FixedSolveScratch::default());
        for (v, value) in held.iter().zip(boundary) {
            assert_eq!(x[v.index()], value, "{}", s.name);
        }
        let lx = multiply(&l, &x);
        for &v in solve.free() {
            assert!((lx[v.index()] - b[v.index()]).norm() < 1e-9, "{}", s.name);
        }
    }
}

/// `−Δu = f` on a sphere has one solution of mean 0; for a linear function as `f` it is `f / 2`, for `Δ` has the eigenvalue
/// −2 there. On an open sheet the boundary is held, and with `f = 0` a linear function stays.
#[test]
fn poisson_problems_have_numbers_for_unknowns() {
    let s = all_shapes::shape("icosphere", shapes::icosphere(4));
    let (l, mass) = (
        cotan_laplacian(&s.triangulation, &s.rest),
        voronoi_mass(&s.triangulation, &s.rest),
    );
    let f: Vec<f64> = s.rest.iter().map(|p| p.x - 2.0 * p.z).collect();
    let b: Vec<f64> = f.iter().zip(&mass).map(|(f, m)| f * m).collect();
    let held = VertexId::new(0);
    let mut u = vec![0.0; f.len()];
    u[held.index()] = f[held.index()] / 2.0;
    FixedSolve::new(&l, &[held]).unwrap().solve_with_in_place(
        &mut u,
        &b,
        &mut FixedSolveScratch::default(),
    );
    for (u, f) in u.iter().zip(&f) {
        assert!((u - f / 2.0).abs() < 5e-3, "{u} {f}");
    }
    let residual = multiply(&l, &u);
    for v in s.mesh.vertices().filter(|&v| v != held) {
        assert!((residual[v.index()] - b[v.index()]).abs() < 1e-12);
    }
}

#[test]
fn everything_held_leaves_nothing_to_solve() {
    let s = all_shapes::shape("tetrahedron", shapes::tetrahedron());
    let l = cotan_laplacian(&s.triangulation, &s.rest);
    let all: Vec<VertexId> = s.mesh.vertices().collect();
    let mut x = wave(4);
    FixedSolve::new(&l, &all)
        .unwrap()
        .solve_in_place(&mut x, &mut FixedSolveScratch::default());
    assert_eq!(x, wave(4));
}

proptest! {
    #[test]
    fn random_positive_definite_systems(
        entries in proptest::collection::vec((0usize..20, 0usize..20, 0.1..2.0f64), 0..60),
    ) {
        let weights = entries.iter().map(|&(i, j, _)| [i, j].map(VertexId::new));
        let a = CsrMatrix::identity(20) + uniform_laplacian(20, weights);
        let x = wave(20);
        let solved = SpdSolver::new(&a).unwrap().solve(&multiply(&a, &x));
        for (got, expected) in solved.iter().zip(&x) {
            prop_assert!((got - expected).norm() < 1e-11);
        }
    }
}
