//! Closest points on triangles: build, refit, and queries of several kinds.

use std::hint::black_box;

use criterion::{criterion_group, criterion_main, BenchmarkId, Criterion, Throughput};
use mesh_core::sampling::SeededRng;
use mesh_core::{shapes, Location, Point3, SurfacePoint, TriangleBvh};

const N_QUERIES: usize = 10_000;

/// A sphere with bumps of all directions: a plain one makes all of it equally far from its middle.
fn triangles(n_splits: usize) -> Vec<[Point3; 3]> {
    let soup = shapes::icosphere(n_splits);
    let bump = |p: &Point3| {
        p * (1.0 + 0.2 * (5.0 * p.x).sin() * (4.0 * p.y).cos() + 0.1 * (7.0 * p.z).sin())
    };
    let positions: Vec<Point3> = soup.positions.iter().map(bump).collect();
    let corners = |f: &Vec<u32>| [f[0], f[1], f[2]].map(|v| positions[v as usize]);
    soup.faces.iter().map(corners).collect()
}

/// Anywhere in the box of the shape.
fn uniform_queries() -> Vec<Point3> {
    let mut rng = SeededRng::new(1);
    (0..N_QUERIES)
        .map(|_| Point3::from([(); 3].map(|()| rng.uniform_in(-1.2..1.2))))
        .collect()
}

/// Close to the surface, neighbours in sequence: the vertices of a mesh that is almost draped.
fn near_queries(triangles: &[[Point3; 3]]) -> Vec<Point3> {
    let mut rng = SeededRng::new(2);
    let n = triangles.len().min(N_QUERIES);
    (0..N_QUERIES)
        .map(|k| triangles[k * n / N_QUERIES][0] * rng.uniform_in(0.98..1.02))
        .collect()
}

fn query(
    c: &mut Criterion,
    kind: &str,
    search: impl Fn(&TriangleBvh, &Point3, u32) -> Option<SurfacePoint>,
) {
    let mut group = c.benchmark_group(format!("closest_point/{kind}"));
    group.throughput(Throughput::Elements(N_QUERIES as u64));
    for n_splits in [3, 5, 6, 8] {
        let triangles = triangles(n_splits);
        let bvh = TriangleBvh::new(triangles.clone());
        let queries = if kind == "uniform" {
            uniform_queries()
        } else {
            near_queries(&triangles)
        };
        group.bench_function(BenchmarkId::from_parameter(triangles.len()), |b| {
            b.iter(|| {
                let mut hint = 0;
                for q in &queries {
                    let closest = search(&bvh, black_box(q), hint);
                    if let Some(Location::Triangle { index, .. }) = closest.map(|p| p.location) {
                        hint = index;
                    }
                    black_box(closest);
                }
            })
        });
    }
    group.finish();
}

fn queries(c: &mut Criterion) {
    query(c, "uniform", |bvh, q, _| bvh.closest_point(q));
    query(c, "near", |bvh, q, _| bvh.closest_point(q));
    query(c, "near_from_hint", |bvh, q, hint| {
        bvh.closest_point_from(q, hint)
    });
}

fn hierarchy(c: &mut Criterion) {
    let mut group = c.benchmark_group("triangle_bvh");
    for n_splits in [3, 5, 6, 8] {
        let triangles = triangles(n_splits);
        group.throughput(Throughput::Elements(triangles.len() as u64));
        group.sample_size(10);
        group.bench_function(BenchmarkId::new("build", triangles.len()), |b| {
            b.iter(|| TriangleBvh::new(black_box(triangles.clone())))
        });
        let mut bvh = TriangleBvh::new(triangles.clone());
        group.bench_function(BenchmarkId::new("refit", triangles.len()), |b| {
            b.iter(|| bvh.refit(black_box(&triangles).iter().copied()))
        });
    }
    group.finish();
}

criterion_group!(benches, queries, hierarchy);
criterion_main!(benches);
