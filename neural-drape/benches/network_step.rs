//! One step of the network (backward, Adam, forward) beside its bare matrix products, and the ratio of the two, measured in
//! turns.
//!
//! The products run on one thread: to compare, run the steps on one too (`RAYON_NUM_THREADS=1`).

#![allow(clippy::print_stderr, reason = "criterion has no words for a ratio")]

use std::hint::black_box;
use std::time::Duration;

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
        for (name, width, waves) in PRODUCTS {
            group.bench_function(BenchmarkId::new(name, n), |b| {
                let mut products = Products::new(n, width, waves);
                b.iter(|| products.run());
            });
        }
    }
    group.finish();
    ratios();
}

/// Name, width and waves of the products of each network.
const PRODUCTS: [(&str, usize, WaveTraining); 3] = [
    ("products_128", 128, WaveTraining::Frozen),
    ("products_256", 256, WaveTraining::Frozen),
    ("products_paper", 256, WaveTraining::Trained),
];

/// Turns in which a step and its products follow each other.
const N_TURNS: usize = 41;

/// Says how many times as long as its products a step takes: the middle of the ratios of all turns.
fn ratios() {
    let n = 2_600;
    let x = points(n);
    let gradient: VertexData<Vector3> = x.map(|p| p.coords / n as f64);
    let standard = NetworkConfig::standard();
    let configs = [
        standard,
        NetworkConfig {
            width: 256,
            ..standard
        },
        NetworkConfig::paper(),
    ];
    for (config, (name, width, waves)) in configs.into_iter().zip(PRODUCTS) {
        let mut network = Network::new(Shapes::at_rest(&x), &config, 0).expect("presets are valid");
        network
            .set_progress(1.0)
            .expect("a network is always ready");
        let mut products = Products::new(n, width, waves);
        let mut ratios: Vec<f64> = (0..N_TURNS)
            .map(|_| {
                let step = time(|| {
                    network
                        .descend(black_box(&gradient), 1e-6)
                        .expect("the step stays finite");
                });
                step.as_secs_f64() / time(|| products.run()).as_secs_f64()
            })
            .collect();
        ratios.sort_by(f64::total_cmp);
        let [low, middle, high] = [1, 2, 3].map(|q| ratios[q * N_TURNS / 4]);
        eprintln!("step / {name}, {n} points: {middle:.2} (quartiles {low:.2}, {high:.2})");
    }
}

/// What `run` takes of the processors' time, so that what else the machine does hardly counts.
fn time(run: impl FnOnce()) -> Duration {
    let start = processor_time();
    run();
    processor_time() - start
}

/// What all processors together have spent on this process.
#[cfg(unix)]
fn processor_time() -> Duration {
    let now = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Duration::new(
        u64::try_from(now.tv_sec).unwrap_or_default(),
        u32::try_from(now.tv_nsec).unwrap_or_default(),
    )
}

/// Time on the clock, where the system's count of processor time is not known.
#[cfg(not(unix))]
fn processor_time() -> Duration {
    static START: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    START.get_or_init(std::time::Instant::now).elapsed()
}

/// Whether the waves train, which takes one product more: that by their features.
#[derive(Clone, Copy, PartialEq, Eq)]
enum WaveTraining {
    Frozen,
    Trained,
}

/// The products of one step: forward, by the weights, by the inputs.
struct Products {
    waves: WaveTraining,
    /// Where the last product goes, the layer's input staying as it is.
    by_features: Mat<f32>,
    /// Activations of each layer, features first.
    activations: Vec<Mat<f32>>,
    weights: Vec<Mat<f32>>,
}

impl Products {
    fn new(n: usize, width: usize, waves: WaveTraining) -> Self {
        let n_features = match waves {
            WaveTraining::Frozen => 255,
            WaveTraining::Trained => 256,
        };
        let sizes = [n_features, width, width, width, width, 3];
        Self {
            waves,
            by_features: Mat::zeros(n_features, n),
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
            if l > 0 || self.waves == WaveTraining::Trained {
                let by_inputs = match l {
                    0 => &mut self.by_features,
                    _ => &mut before[l],
                };
                matmul(
                    by_inputs,
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
