//! From faces to half-edges, triangles and a coarse stand-in, and back into a file; by the number of faces.
#![allow(missing_docs, reason = "criterion's macros make items without docs")]

use criterion::{criterion_group, criterion_main, BatchSize, BenchmarkId, Criterion, Throughput};
use mesh_core::io::MeshFile;
use mesh_core::{shapes, Positions, Proxy, Triangulation};

/// Vertices of the stand-in.
const N_COARSE: usize = 1000;

fn connectivity(c: &mut Criterion) {
    let mut group = c.benchmark_group("connectivity");
    group.sample_size(10);
    for n in [13, 41, 129, 408] {
        let soup = shapes::quad_sphere(n);
        let n_faces = soup.faces.len();
        group.throughput(Throughput::Elements(n_faces as u64));
        group.bench_function(BenchmarkId::new("half_edges", n_faces), |b| {
            b.iter_batched(
                || soup.clone(),
                |s| s.into_halfedge(),
                BatchSize::LargeInput,
            );
        });
        let (mesh, rest) = soup.into_halfedge().expect("a sphere is a mesh");
        group.bench_function(BenchmarkId::new("triangulation", n_faces), |b| {
            b.iter(|| Triangulation::new(&mesh, &rest));
        });
        let triangulation = Triangulation::new(&mesh, &rest);
        if rest.len() > N_COARSE {
            let proxy = Proxy::new(&triangulation, &rest, N_COARSE, &[]);
            let x: Positions = proxy.soup().positions.iter().copied().collect();
            group.bench_function(BenchmarkId::new("carry", n_faces), |b| {
                b.iter(|| proxy.carry(&rest, &x));
            });
            if n_faces < 500_000 {
                group.bench_function(BenchmarkId::new("proxy", n_faces), |b| {
                    b.iter(|| Proxy::new(&triangulation, &rest, N_COARSE, &[]));
                });
            }
        }
    }
    group.finish();
}

/// Bytes per second of each writer.
fn save(c: &mut Criterion) {
    let mut group = c.benchmark_group("save_mesh");
    group.sample_size(10);
    for n in [13, 129] {
        let soup = shapes::quad_sphere(n);
        let mut text = String::new();
        for p in &soup.positions {
            text += &format!("v {:.6} {:.6} {:.6}\n", p.x, p.y, p.z);
        }
        for f in &soup.faces {
            text += &format!("f {} {} {} {}\n", f[0] + 1, f[1] + 1, f[2] + 1, f[3] + 1);
        }
        let file = MeshFile::from_bytes("a.obj", text.into_bytes()).expect("the text is right");
        let x: Positions = soup.positions.iter().map(|p| p * 1.01).collect();
        for name in ["a.obj", "a.ply", "a.off"] {
            let n_bytes = file.to_bytes(name, &x).expect("positions are finite").len();
            group.throughput(Throughput::Bytes(n_bytes as u64));
            group.bench_function(BenchmarkId::new(name, soup.faces.len()), |b| {
                b.iter(|| file.to_bytes(name, &x));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, connectivity, save);
criterion_main!(benches);
