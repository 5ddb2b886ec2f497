//! One iteration of the default preset: sampling, closest points, all terms, two solves.

use std::sync::Arc;

use criterion::{criterion_group, criterion_main, BenchmarkId, Criterion, Throughput};
use mesh_core::{shapes, Point3, TargetSurface, TriangleSoup, Triangulation};
use neural_drape::{Drape, DrapeConfig, DrapeInput};

fn drape_step(c: &mut Criterion) {
    let mut group = c.benchmark_group("drape_step");
    group.sample_size(20);
    for side in [13, 41, 130] {
        let (mesh, rest) = shapes::quad_sphere(side)
            .into_halfedge()
            .expect("a sphere is a mesh");
        let triangulation = Arc::new(Triangulation::new(&mesh, &rest));
        let rest = Arc::new(rest);
        let mut soup = shapes::icosphere(5);
        for p in &mut soup.positions {
            *p = Point3::new(p.x, 0.7 * p.y, 0.5 * p.z);
        }
        let target: Arc<dyn TargetSurface> =
            Arc::new(TriangleSoup::new(soup).expect("an ellipsoid is a target"));
        let input = DrapeInput {
            triangulation: &triangulation,
            rest: &rest,
            initial: &rest,
            target: &target,
            landmarks: &[],
        };
        let mut config = DrapeConfig::standard();
        config.stages[0].n_iterations = 500_000_000;
        let mut drape = Drape::new(input, config).expect("the preset is in range");
        group.throughput(Throughput::Elements(rest.len() as u64));
        group.bench_function(BenchmarkId::from_parameter(rest.len()), |b| {
            b.iter(|| drape.step().expect("the run stays finite"));
        });
    }
    group.finish();
}

criterion_group!(benches, drape_step);
criterion_main!(benches);
