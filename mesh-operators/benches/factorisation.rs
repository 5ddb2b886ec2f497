//! Sparse Cholesky of a smoothing operator and of a bi-Laplacian, and solves with three components.
#![allow(missing_docs, reason = "criterion's macros make items without docs")]

use criterion::{criterion_group, criterion_main, BenchmarkId, Criterion, Throughput};
use mesh_core::{shapes, Triangulation, Vector3};
use mesh_operators::{
    bilaplacian, cotan_laplacian, uniform_laplacian, voronoi_mass, CsrMatrix, SpdSolver,
};

fn systems(n: usize) -> [(&'static str, CsrMatrix<f64>); 2] {
    let (mesh, rest) = shapes::quad_sphere(n)
        .into_halfedge()
        .expect("a sphere is a mesh");
    let triangulation = Triangulation::new(&mesh, &rest);
    let edges = mesh.edges().map(|e| mesh.edge_vertices(e));
    let bend = bilaplacian(
        &cotan_laplacian(&triangulation, &rest),
        &voronoi_mass(&triangulation, &rest),
    );
    let identity = CsrMatrix::identity(rest.len());
    [
        (
            "smoothing",
            &identity + uniform_laplacian(rest.len(), edges) * 5.0,
        ),
        ("bilaplacian", &identity + bend),
    ]
}

fn factor(c: &mut Criterion) {
    let mut group = c.benchmark_group("factorisation");
    group.sample_size(10);
    for n in [13, 41, 129] {
        for (kind, a) in systems(n) {
            group.throughput(Throughput::Elements(a.nrows() as u64));
            group.bench_function(BenchmarkId::new(kind, a.nrows()), |b| {
                b.iter(|| SpdSolver::new(&a).expect("positive definite"));
            });
        }
    }
}

fn solve(c: &mut Criterion) {
    let mut group = c.benchmark_group("solve");
    for n in [13, 41, 129] {
        for (kind, a) in systems(n) {
            let solver = SpdSolver::new(&a).expect("positive definite");
            let mut x = vec![Vector3::new(1.0, 2.0, 3.0); a.nrows()];
            let mut scratch = Vec::new();
            group.throughput(Throughput::Elements(a.nrows() as u64));
            group.bench_function(BenchmarkId::new(kind, a.nrows()), |b| {
                b.iter(|| solver.solve_in_place(&mut x, &mut scratch));
            });
        }
    }
}

criterion_group!(benches, factor, solve);
criterion_main!(benches);
