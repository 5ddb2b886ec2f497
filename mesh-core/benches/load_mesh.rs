//! Bytes per second of each reader, beside the crates that read the same formats.

use std::hint::black_box;
use std::io::Cursor;

use criterion::{criterion_group, criterion_main, BenchmarkId, Criterion, Throughput};
use mesh_core::io::MeshFile;
use mesh_core::{shapes, Positions};

/// An icosphere as OBJ text, with one texture coordinate per vertex.
fn obj(n_splits: usize) -> Vec<u8> {
    let soup = shapes::icosphere(n_splits);
    let mut text = String::new();
    for p in &soup.positions {
        text += &format!("v {:.6} {:.6} {:.6}\n", p.x, p.y, p.z);
    }
    for p in &soup.positions {
        text += &format!("vt {:.6} {:.6}\n", p.x, p.y);
    }
    for face in &soup.faces {
        text += "f";
        for v in face {
            text += &format!(" {0}/{0}", v + 1);
        }
        text += "\n";
    }
    text.into_bytes()
}

/// The icosphere in every format, by name.
fn files(n_splits: usize) -> Vec<(&'static str, Vec<u8>)> {
    let obj = obj(n_splits);
    let file = MeshFile::from_bytes("a.obj", obj.clone()).expect("the text is right");
    let x = Positions::from(file.soup().positions.clone());
    let converted = |name| file.to_bytes(name, &x).expect("positions are finite");
    vec![
        ("a.off", converted("a.off")),
        ("a.ply", converted("a.ply")),
        ("a.obj", obj),
    ]
}

fn load_mesh(c: &mut Criterion) {
    let mut group = c.benchmark_group("load_mesh");
    group.sample_size(10);
    for n_splits in [3, 5, 7] {
        let n_faces = 20 << (2 * n_splits);
        for (name, bytes) in files(n_splits) {
            group.throughput(Throughput::Bytes(bytes.len() as u64));
            group.bench_with_input(BenchmarkId::new(name, n_faces), &bytes, |b, bytes| {
                b.iter(|| MeshFile::from_bytes(name, black_box(bytes.clone())));
            });
            if name == "a.obj" {
                group.bench_with_input(BenchmarkId::new("tobj", n_faces), &bytes, |b, bytes| {
                    let options = tobj::LoadOptions::default();
                    b.iter(|| {
                        tobj::load_obj_buf(
                            &mut Cursor::new(black_box(bytes)),
                            &options,
                            |_| unreachable!(),
                        )
                    });
                });
            }
            if name == "a.ply" {
                group.bench_with_input(BenchmarkId::new("ply-rs", n_faces), &bytes, |b, bytes| {
                    let parser = ply_rs::parser::Parser::<ply_rs::ply::DefaultElement>::new();
                    b.iter(|| parser.read_ply(&mut Cursor::new(black_box(bytes))));
                });
            }
        }
    }
    group.finish();
}

criterion_group!(benches, load_mesh);
criterion_main!(benches);
