//! One step of the network (backward, Adam, forward) beside its bare matrix products.
//!
//! The products run on one thread: to compare, run the steps on one too (`RAYON_NUM_THREADS=1`).

use std::hint::black_box;

use criterion::{criterion_group, criterion_main, BenchmarkId, Criterion, Throughput};
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par};
use mesh_core::{Point3, Positions, Vector3, VertexData};
use neural_drape::network::{Network, NetworkConfig, Shapes};
use neural_drape::Parametrization;

/// Points on a spiral over the unit sphere.
fn points(n: usize) -> Positions {
    let spiral = (0..n).map(|k| {
        let z = 1.0 - (2 * k + 1) as f64 / n as f64;
        let (sin, cos) = (2.4 * k as f64).sin_cos();
        let r = (1.0 - z * z).sqrt();
        Point3::new(r * cos, r * sin, z)
    });
    spiral.collect()
}

fn step(c: &mut Criterion) {
    let mut group = c.benchmark_group("network_step");
    group.sample_size(20);
    for n in [1_000, 2_600, 10_000] {
        group.throughput(Throughput::Elements(n as u64));
        let x = points(n);
        let gradient: VertexData<Vector3> = x.map(|p| p.coords / n as f64);
        let standard = NetworkConfig::standard();
        let wide = NetworkConfig {
            width: 256,
            ..standard
        };
        let paper = NetworkConfig::paper();
        for (name, config) in [("standard", standard), ("wide", wide), ("paper", paper)] {
            let mut network =
                Network::new(Shapes::at_rest(&x), &config, 0).expect("presets are valid");
            network
                .set_progress(1.0)
                .expect("a network is always ready");
            group.bench_function(BenchmarkId::new(name, n), |b| {
                b.iter(|| network.descend(black_box(&gradient), 1e-6));
            });
        }
        for width in [128, 256] {
            group.bench_function(BenchmarkId::new(format!("products_{width}"), n), |b| {
                let mut products = Products::new(n, width);
                b.iter(|| products.run());
            });
        }
    }
    group.finish();
}

/// The products of one step with frozen waves: forward, by the weights, by the inputs.
struct Products {
    /// Activations of each layer, features first.
    activations: Vec<Mat<f32>>,
    weights: Vec<Mat<f32>>,
}

impl Products {
    fn new(n: usize, width: usize) -> Self {
        let sizes = [255, width, width, width, width, 3];
        Self {
            activations: sizes
                .iter()
                .map(|&rows| Mat::from_fn(rows, n, |i, j| (i + j) as f32 * 1e-4))
                .collect(),
            weights: sizes
                .windows(2)
                .map(|s| Mat::from_fn(s[1], s[0], |i, j| (i + j) as f32 * 1e-4))
                .collect(),
        }
    }

    fn run(&mut self) {
        let par = Par::Seq;
        for (l, weight) in self.weights.iter_mut().enumerate() {
            let (before, after) = self.activations.split_at_mut(l + 1);
            matmul(
                &mut after[0],
                Accum::Replace,
                &*weight,
                &before[l],
                1e-4,
                par,
            );
            matmul(
                &mut *weight,
                Accum::Replace,
                &after[0],
                before[l].transpose(),
                1e-4,
                par,
            );
            if l > 0 {
                matmul(
                    &mut before[l],
                    Accum::Replace,
                    weight.transpose(),
                    &after[0],
                    1e-4,
                    par,
                );
            }
        }
    }
}

criterion_group!(benches, step);
criterion_main!(benches);
