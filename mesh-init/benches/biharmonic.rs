//! A biharmonic displacement field through sixteen given displacements.
#![allow(missing_docs, reason = "criterion's macros make items without docs")]

use criterion::{criterion_group, criterion_main, BenchmarkId, Criterion, Throughput};
use mesh_core::{shapes, Triangulation, Vector3};
use mesh_init::{biharmonic_displacement, BiharmonicSolver};

fn field(c: &mut Criterion) {
    let mut group = c.benchmark_group("biharmonic");
    group.sample_size(10);
    for n in [13, 41, 129] {
        let (mesh, rest) = shapes::quad_sphere(n)
            .into_halfedge()
            .expect("a sphere is a mesh");
        let triangulation = Triangulation::new(&mesh, &rest);
        let held: Vec<_> = mesh
            .vertices()
            .step_by(rest.len() / 16)
            .map(|v| (v, Vector3::repeat(v.index() as f64)))
            .collect();
        group.throughput(Throughput::Elements(rest.len() as u64));
        group.bench_function(BenchmarkId::from_parameter(rest.len()), |b| {
            b.iter(|| {
                biharmonic_displacement(&triangulation, &rest, &held).expect("every piece is held")
            });
        });
        let (rows, values): (Vec<_>, Vec<_>) = held.iter().copied().unzip();
        let solver = BiharmonicSolver::new(&triangulation, &rest, &rows).expect("it is held");
        group.bench_function(BenchmarkId::new("again", rest.len()), |b| {
            b.iter(|| solver.solve(&values));
        });
    }
}

criterion_group!(benches, field);
criterion_main!(benches);
