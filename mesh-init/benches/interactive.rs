//! Landmarks dragged on dense shapes, which are deformed by a stand-in of 3 000 vertices, and on ones without.
#![allow(missing_docs, reason = "criterion's macros make items without docs")]

use criterion::{criterion_group, criterion_main, BenchmarkId, Criterion, Throughput};
use mesh_core::{shapes, HalfedgeMesh, Landmark, Point3, Positions, Triangulation, UnitFrame};
use mesh_init::{InitConfig, InteractiveInit};

const STAND_IN: usize = 3000;

/// A lopsided ball and sixteen landmarks that bend it.
fn scene(n: usize) -> (HalfedgeMesh, Positions, Vec<Landmark>) {
    let (mesh, ball) = shapes::quad_sphere(n)
        .into_halfedge()
        .expect("a sphere is a mesh");
    let bump = |p: &Point3| 1.0 + 0.3 * (2.0 * p.x + p.y).sin() + 0.2 * (3.0 * p.z).cos();
    let rest = ball.map(|p| p * bump(p));
    let bent = |p: &Point3| Point3::new(1.6 * p.x, p.y + 0.2 * p.x * p.x, p.z);
    let marks = mesh
        .vertices()
        .step_by(rest.len() / 16)
        .take(16)
        .map(|v| Landmark::new(v, bent(&rest[v])));
    let marks = marks.collect();
    (mesh, rest, marks)
}

fn drag(c: &mut Criterion) {
    let mut group = c.benchmark_group("interactive");
    group.sample_size(10);
    for n in [41, 91, 183] {
        let (mesh, rest, marks) = scene(n);
        let triangulation = Triangulation::new(&mesh, &rest);
        let frame = UnitFrame::principal(rest.as_slice());
        let prepare = |config| {
            InteractiveInit::new(&triangulation, &rest, STAND_IN, config)
                .expect("the sphere has a stand-in")
        };
        group.throughput(Throughput::Elements(rest.len() as u64));
        group.bench_function(BenchmarkId::new("prepared", rest.len()), |b| {
            b.iter(|| prepare(InitConfig::standard()));
        });

        let mut init = prepare(InitConfig::standard());
        let mut solve = |marks: &[Landmark]| init.solve(marks, frame).expect("it is determined");
        let mut turn = 0_usize;
        group.bench_function(BenchmarkId::new("dragged", rest.len()), |b| {
            let mut dragged = marks.clone();
            b.iter(|| {
                turn += 1;
                dragged[3].target.x = marks[3].target.x + 0.01 * (turn % 8) as f64;
                solve(&dragged)
            });
        });
        group.bench_function(BenchmarkId::new("added", rest.len()), |b| {
            b.iter(|| {
                turn += 1;
                solve(&marks[..marks.len() - turn % 2])
            });
        });

        let mut init = InteractiveInit::new(&triangulation, &rest, usize::MAX, InitConfig::paper())
            .expect("it is its own stand-in");
        group.bench_function(BenchmarkId::new("dragged_exactly", rest.len()), |b| {
            let mut dragged = marks.clone();
            b.iter(|| {
                turn += 1;
                dragged[3].target.x = marks[3].target.x + 0.01 * (turn % 8) as f64;
                init.adjust(&dragged, &rest).expect("it is determined")
            });
        });
    }
}

criterion_group!(benches, drag);
criterion_main!(benches);
