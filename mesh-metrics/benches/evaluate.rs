//! All figures about one result, by the number of faces of source and target.

use criterion::{criterion_group, criterion_main, BenchmarkId, Criterion, Throughput};
use mesh_core::{shapes, TriangleSoup, Triangulation};
use mesh_metrics::{evaluate, EvaluationConfig, EvaluationInput};

fn evaluate_a_sphere(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("evaluate");
    group.sample_size(10);
    for n in [13, 41, 129] {
        let (mesh, rest) = shapes::quad_sphere(n)
            .into_halfedge()
            .expect("the shape is sound");
        let target = TriangleSoup::new(shapes::quad_sphere(n + 3)).expect("the shape is sound");
        let draped = rest.map(|p| p * (1.0 + 0.1 * (5.0 * p.x).sin()));
        let triangulation = Triangulation::new(&mesh, &rest);
        let input = EvaluationInput {
            triangulation: &triangulation,
            rest: &rest,
            draped: &draped,
            target: &target,
            landmarks: &[],
            truth: Some(&rest),
        };
        let config = EvaluationConfig {
            n_samples: 10_000,
            seed: 0,
        };
        group.throughput(Throughput::Elements(mesh.n_faces() as u64));
        group.bench_function(BenchmarkId::from_parameter(mesh.n_faces()), |bencher| {
            bencher.iter(|| evaluate(input, &config));
        });
    }
    group.finish();
}

criterion_group!(benches, evaluate_a_sphere);
criterion_main!(benches);
