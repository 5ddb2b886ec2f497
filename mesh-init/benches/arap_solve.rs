//! One local and one global step as rigid as possible, the system factored before.
#![allow(missing_docs, reason = "criterion's macros make items without docs")]

use criterion::{criterion_group, criterion_main, BenchmarkId, Criterion, Throughput};
use mesh_core::{shapes, Triangulation, VertexId};
use mesh_init::{ArapScratch, ArapSolver};

fn step(c: &mut Criterion) {
    let mut group = c.benchmark_group("arap_solve");
    group.sample_size(10);
    for n in [13, 41, 129] {
        let (mesh, rest) = shapes::quad_sphere(n)
            .into_halfedge()
            .expect("a sphere is a mesh");
        let triangulation = Triangulation::new(&mesh, &rest);
        let held: Vec<VertexId> = mesh.vertices().step_by(rest.len() / 16).collect();
        let solver = ArapSolver::new(&triangulation, &rest, &held).expect("the sphere is held");
        let mut x = rest.clone();
        x[held[0]].x += 0.5;
        let mut scratch = ArapScratch::default();
        group.throughput(Throughput::Elements(rest.len() as u64));
        group.bench_function(BenchmarkId::from_parameter(rest.len()), |b| {
            b.iter(|| solver.step(&mut x, &mut scratch));
        });
    }
}

criterion_group!(benches, step);
criterion_main!(benches);
