//! Our hot paths beside parry3d and tobj in one run; `against_libigl.py` does the same for libigl.
//!
//! `cargo run --release -- closest|biharmonic|obj [FILES]`; `RAYON_NUM_THREADS` sets the threads.

use std::hint::black_box;
use std::time::Instant;

use mesh_core::io::MeshFile;
use mesh_core::{shapes, Point3, PolygonSoup, Triangulation, TriangleBvh, Vector3};
use parry3d_f64::query::PointQuery;
use parry3d_f64::shape::TriMesh;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

/// Turns of each measurement; the middle one counts.
const N_TURNS: usize = 5;
const N_QUERIES: usize = 100_000;

fn main() {
    let task = std::env::args().nth(1).unwrap_or_default();
    match task.as_str() {
        "closest" => [29, 91, 289].into_iter().for_each(closest),
        "biharmonic" => [91, 183].into_iter().for_each(biharmonic),
        "obj" => [5, 7].into_iter().for_each(load),
        "write" => write(&std::env::args().nth(2).unwrap_or_else(|| ".".into())),
        _ => eprintln!("closest, biharmonic, obj, or write FOLDER"),
    }
}

/// A quad sphere with bumps, as triangles: 12 n² of them.
fn bumpy(n: usize) -> (Vec<Point3>, Vec<[u32; 3]>) {
    let soup = shapes::quad_sphere(n);
    let bump = |p: &Point3| {
        p * (1.0 + 0.2 * (5.0 * p.x).sin() * (4.0 * p.y).cos() + 0.1 * (7.0 * p.z).sin())
    };
    let triangles = soup.faces.iter().flat_map(|f| [[f[0], f[1], f[2]], [f[0], f[2], f[3]]]);
    (soup.positions.iter().map(bump).collect(), triangles.collect())
}

/// Half of them anywhere in the box, half within 2 % of the surface.
fn queries(points: &[Point3]) -> Vec<Point3> {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut near = |_| points[rng.random_range(0..points.len())] * rng.random_range(0.98..1.02);
    let mut queries: Vec<Point3> = (0..N_QUERIES / 2).map(&mut near).collect();
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    queries.extend((0..N_QUERIES / 2).map(|_| Point3::from([(); 3].map(|()| rng.random_range(-1.3..1.3)))));
    queries
}

/// Seconds of the middle turn.
fn median(mut work: impl FnMut()) -> f64 {
    let mut seconds: Vec<f64> = (0..N_TURNS)
        .map(|_| {
            let start = Instant::now();
            work();
            start.elapsed().as_secs_f64()
        })
        .collect();
    seconds.sort_by(f64::total_cmp);
    seconds[N_TURNS / 2]
}

fn closest(n: usize) {
    let (points, triangles) = bumpy(n);
    let corners: Vec<[Point3; 3]> = triangles.iter().map(|t| t.map(|v| points[v as usize])).collect();
    let queries = queries(&points);
    let bvh = TriangleBvh::new(corners.clone());
    let vertices = points.iter().map(|p| parry3d_f64::math::Point::new(p.x, p.y, p.z)).collect();
    let parry = TriMesh::new(vertices, triangles.clone()).expect("the mesh is sound");

    let ours = median(|| {
        black_box(bvh.closest_points(&queries));
    });
    let theirs = median(|| {
        let project = |q: &Point3| {
            let q = parry3d_f64::math::Point::new(q.x, q.y, q.z);
            parry.project_local_point(&q, true).point
        };
        black_box(queries.par_iter().with_min_len(64).map(project).collect::<Vec<_>>());
    });
    let build = median(|| {
        black_box(TriangleBvh::new(corners.clone()));
    });
    println!(
        "closest {} triangles, {} threads: ours {ours:.4} s, parry3d {theirs:.4} s, ratio {:.2}; our build {build:.4} s",
        triangles.len(),
        rayon::current_num_threads(),
        theirs / ours
    );
}

/// Sixteen vertices held, the field between them found; 6 n² vertices.
fn biharmonic(n: usize) {
    let (points, triangles) = bumpy(n);
    let faces = triangles.iter().map(|t| t.to_vec()).collect();
    let (mesh, rest) = PolygonSoup { positions: points, faces }.into_halfedge().expect("the mesh is sound");
    let triangulation = Triangulation::new(&mesh, &rest);
    let held: Vec<_> = mesh
        .vertices()
        .step_by(rest.len() / 16)
        .map(|v| (v, Vector3::repeat(v.index() as f64)))
        .collect();
    let seconds = median(|| {
        black_box(mesh_init::biharmonic_displacement(&triangulation, &rest, &held).expect("it is held"));
    });
    println!("biharmonic {} vertices: ours {seconds:.3} s", rest.len());
}

/// The text of an icosphere with texture coordinates.
fn obj(n_splits: usize) -> Vec<u8> {
    let soup = shapes::icosphere(n_splits);
    let mut text = String::new();
    for p in &soup.positions {
        text += &format!("v {:.6} {:.6} {:.6}\n", p.x, p.y, p.z);
    }
    for p in &soup.positions {
        text += &format!("vt {:.6} {:.6}\n", p.x, p.y);
    }
    for f in &soup.faces {
        text += &format!("f {0}/{0} {1}/{1} {2}/{2}\n", f[0] + 1, f[1] + 1, f[2] + 1);
    }
    text.into_bytes()
}

fn load(n_splits: usize) {
    let bytes = obj(n_splits);
    let megabytes = bytes.len() as f64 / 1e6;
    let ours = median(|| {
        black_box(MeshFile::from_bytes("a.obj", bytes.clone()).expect("the text is right"));
    });
    let theirs = median(|| {
        let mut text = std::io::Cursor::new(&bytes);
        let options = tobj::LoadOptions::default();
        let _ = black_box(tobj::load_obj_buf(&mut text, &options, |_| unreachable!()));
    });
    println!(
        "OBJ of {megabytes:.1} MB: ours {:.0} MB/s, tobj {:.0} MB/s, ratio {:.2}",
        megabytes / ours,
        megabytes / theirs,
        theirs / ours
    );
}

/// The meshes and queries as raw little-endian numbers, for `against_libigl.py`.
fn write(folder: &str) {
    let put = |name: String, bytes: Vec<u8>| {
        std::fs::write(std::path::Path::new(folder).join(name), bytes).expect("the folder can be written");
    };
    for n in [29, 91, 183, 289] {
        let (points, triangles) = bumpy(n);
        let reals = |p: &[Point3]| p.iter().flat_map(|p| p.coords.iter().flat_map(|c| c.to_le_bytes()).collect::<Vec<_>>()).collect();
        put(format!("{n}.v"), reals(&points));
        put(format!("{n}.f"), triangles.iter().flatten().flat_map(|v| v.to_le_bytes()).collect());
        put(format!("{n}.q"), reals(&queries(&points)));
    }
}
