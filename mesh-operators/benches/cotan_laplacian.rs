//! Assembly of the cotangent Laplacian.
#![allow(missing_docs, reason = "criterion's macros make items without docs")]

use criterion::{criterion_group, criterion_main, BenchmarkId, Criterion, Throughput};
use mesh_core::{shapes, Triangulation};
use mesh_operators::cotan_laplacian;

fn assemble(c: &mut Criterion) {
    let mut group = c.benchmark_group("cotan_laplacian");
    group.sample_size(10);
    for n in [13, 41, 129] {
        let (mesh, rest) = shapes::quad_sphere(n)
            .into_halfedge()
            .expect("a sphere is a mesh");
        let triangulation = Triangulation::new(&mesh, &rest);
        group.throughput(Throughput::Elements(rest.len() as u64));
        group.bench_function(BenchmarkId::from_parameter(rest.len()), |b| {
            b.iter(|| cotan_laplacian(&triangulation, &rest));
        });
    }
}

criterion_group!(benches, assemble);
criterion_main!(benches);
