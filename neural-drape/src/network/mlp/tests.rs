//! The fused network against closed forms, plain dfdx and finite differences.

use dfdx::prelude::{
    Axes2, Axis, Backward, Cpu, Gradients, NoneTape, PermuteTo, SumTo, Tensor, TensorFromVec,
    Trace, TryConcatAlong, TryMatMul,
};
use mesh_core::{shapes, Point3};

use super::super::config::{Frequencies, Networks, Reveal};
use super::super::encoding::WaveKind;
use super::*;

/// Small enough to check, with every kind of encoding.
fn configs() -> [NetworkConfig; 4] {
    let small = |encoding| NetworkConfig {
        n_hidden_layers: 2,
        width: 16,
        input: NetworkInput::Initial,
        encoding,
        output_scale: 0.5,
    };
    let progressive = |frequencies, reveal, networks| Encoding::Progressive {
        frequencies,
        n_blocks: 3,
        reveal,
        networks,
    };
    let uniform = Frequencies::Uniform {
        count: 11,
        max: 4.0,
        trainable: true,
    };
    // Three networks bend more than one.
    let smooth = Frequencies::Uniform {
        count: 11,
        max: 1.5,
        trainable: true,
    };
    let gaussian = Frequencies::Gaussian {
        count: 7,
        deviation: 2.0,
    };
    let hold = Reveal::HoldAndFade { until: 1.0 };
    [
        small(Encoding::None),
        small(progressive(uniform, hold, Networks::One)),
        small(progressive(
            gaussian,
            Reveal::Even { until: 0.5 },
            Networks::One,
        )),
        small(progressive(smooth, hold, Networks::OnePerBlock)),
    ]
}

/// 2 562 vertices: several blocks in several lanes.
fn sphere() -> Positions {
    Positions::from(shapes::icosphere(4).positions)
}

/// A smooth field of directions.
fn field(x: &Positions) -> VertexData<Vector3> {
    x.map(|p| Vector3::new((3.0 * p.y).sin(), p.z * p.x, 1.0 - p.y) / x.len() as f64)
}

/// A network that has left the identity, halfway through its encoding.
fn trained(config: &NetworkConfig, x0: &Positions) -> Network {
    let mut network = Network::new(Shapes::at_rest(x0), config, 3).unwrap();
    network.set_progress(0.3).unwrap();
    for _ in 0..20 {
        let gradient = field(network.positions());
        network.descend(&gradient, 1e-2).unwrap();
    }
    network
}

fn squared_distance(x: &Positions, y: &Positions) -> f64 {
    x.iter()
        .zip(y)
        .map(|(a, b)| (a - b).norm_squared())
        .sum::<f64>()
        / x.len() as f64
}

#[test]
fn starts_exactly_at_the_identity() {
    let x0 = sphere();
    for config in configs() {
        let mut network = Network::new(Shapes::at_rest(&x0), &config, 3).unwrap();
        assert_eq!(network.positions(), &x0);
        network.set_progress(1.0).unwrap();
        network.evaluate();
        assert_eq!(network.positions(), &x0);
    }
}

#[test]
fn same_seed_gives_the_same_bits_at_1_and_2_threads() {
    let x0 = sphere();
    for config in configs() {
        let run = |n_threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(n_threads)
                .build()
                .unwrap();
            pool.install(|| trained(&config, &x0).positions().clone())
        };
        let once = run(1);
        assert_ne!(once, x0);
        assert_eq!(once, run(2));
        assert_eq!(once, run(1));
    }
}

#[test]
fn descends_towards_an_ellipsoid() {
    let x0 = sphere();
    let target = x0.map(|p| Point3::new(1.5 * p.x, p.y, 0.6 * p.z + 0.1 * p.x * p.y));
    for config in configs() {
        let mut network = Network::new(Shapes::at_rest(&x0), &config, 1).unwrap();
        let before = squared_distance(&x0, &target);
        for step in 0..150 {
            network.set_progress(step as f64 / 150.0).unwrap();
            let x = network.positions();
            let gradient = x
                .iter()
                .zip(&target)
                .map(|(a, b)| (a - b) / x.len() as f64)
                .collect();
            network.descend(&gradient, 5e-3).unwrap();
        }
        let after = squared_distance(network.positions(), &target);
        assert!(after < 0.02 * before, "{before} -> {after}");
    }
}

#[test]
fn the_map_moves_the_vertices_as_the_network_does() {
    let x0 = sphere();
    for config in configs() {
        let network = trained(&config, &x0);
        let images = network.network().unwrap().apply(x0.as_slice());
        for (image, x) in images.iter().zip(network.positions()) {
            // Blocks of another size may sum the 16 inputs of a neuron in another order.
            assert!((image - x).norm() < 1e-5);
        }
    }
}

#[test]
fn gradient_equals_the_finite_difference_along_itself() {
    let x0 = sphere();
    for config in configs() {
        let mut network = trained(&config, &x0);
        let weights = field(&x0);
        let value = |network: &Network| -> f64 {
            let moved = network.positions().iter().zip(&x0);
            moved
                .zip(&weights)
                .map(|((x, x0), w)| (x - x0).dot(w))
                .sum()
        };
        let mut gradients = network.gradients(&weights).unwrap();
        let here = network.parameters.clone();
        let length = here.clone().norm(&mut gradients).unwrap();

        let h = 5e-3;
        let mut moved = |sign: f64| {
            network.parameters = here.clone();
            network
                .parameters
                .shift(&mut gradients, (sign * h / length) as f32)
                .unwrap();
            network.evaluate();
            value(&network)
        };
        let difference = (moved(1.0) - moved(-1.0)) / (2.0 * h);
        // The values are sums of f32 outputs of size 1: 1e-7 / h of rounding, and h² of curvature.
        assert!(
            (difference / length - 1.0).abs() < 2e-3,
            "{config:?}: {difference} vs {length}"
        );
    }
}

#[test]
fn fused_layers_equal_plain_dfdx() {
    let x0 = sphere();
    for config in configs() {
        let network = trained(&config, &x0);
        let weights = field(&x0);
        let (plain_output, mut plain) = plain_dfdx(&network, &weights);
        let evaluation = lock(&network.evaluation);
        let fused_output: Vec<f32> = evaluation.pass.outputs().flatten().collect();
        drop(evaluation);
        assert!(relative_difference(&fused_output, &plain_output) < 1e-5);

        let mut fused = network.gradients(&weights).unwrap();
        for parameter in network.parameters.tensors() {
            let ours = fused.get_or_alloc_mut(parameter).unwrap().to_vec();
            let theirs = plain.get_or_alloc_mut(parameter).unwrap().to_vec();
            // Sums of 2 562 products in another order.
            assert!(relative_difference(&ours, &theirs) < 1e-4);
        }
    }
}

fn relative_difference(a: &[f32], b: &[f32]) -> f32 {
    let norm = |v: &mut dyn Iterator<Item = f32>| v.map(|x| x * x).sum::<f32>().sqrt();
    assert_eq!(a.len(), b.len());
    norm(&mut a.iter().zip(b).map(|(a, b)| a - b)) / norm(&mut b.iter().copied()).max(1e-12)
}

/// Output and dL/dθ by dfdx's own operations.
fn plain_dfdx(network: &Network, weights: &VertexData<Vector3>) -> (Vec<f32>, Gradients<f32, Cpu>) {
    let Evaluation { map, masks, .. } = &*lock(&network.evaluation);
    let n = network.initial.len();
    let points = matrix(
        network
            .initial
            .iter()
            .flat_map(|p| to_input(&map.frame, p))
            .collect(),
        3,
    );
    let tensors = network.parameters.tensors();

    let n_features = map.waves.n_features();
    let features = || match map.waves.kind {
        _ if n_features == 3 => points.clone().leaky_traced(),
        WaveKind::Sine => {
            let rows = tensors[tensors.len() - 1].leaky_trace();
            let phases = points
                .clone()
                .leaky_traced()
                .matmul(rows.permute::<_, Axes2<1, 0>>());
            (
                points.clone().leaky_traced(),
                (phases * map.waves.gain).sin(),
            )
                .concat_along(Axis::<1>)
        }
        WaveKind::SineCosine => {
            let mut entries = vec![0.0; n * n_features];
            let mut encoder = map.waves.encoder();
            for (p, features) in network.initial.iter().zip(entries.chunks_mut(n_features)) {
                encoder.encode(&to_input(&map.frame, p), features, None);
            }
            matrix(entries, n_features).leaky_traced()
        }
    };
    let mut tensors_left = tensors.iter().copied();
    let mut sum = matrix(vec![0.0; 3 * n], 3).leaky_traced();
    for (mask, layers) in masks.iter().zip(&map.networks) {
        let mut values = features().matmul(selection(mask, n_features));
        for l in 0..layers.len() {
            let (weight, bias) = tensors_left.next().zip(tensors_left.next()).unwrap();
            let ones = matrix(vec![1.0; n], 1).leaky_traced();
            values = values.matmul(weight.clone()) + ones.matmul(bias.clone());
            if l + 1 < layers.len() {
                values = values.relu();
            }
        }
        sum = sum + values * mask.output();
    }
    let output = sum.as_vec();
    let unit = map.output_unit();
    let weights = weights
        .iter()
        .flat_map(|w| [w.x, w.y, w.z].map(|d| (d * unit) as f32));
    let gradients = (sum * matrix(weights.collect(), 3))
        .sum::<(), _>()
        .backward();
    (output, gradients)
}

fn matrix(entries: Vec<f32>, n_columns: usize) -> Tensor<(usize, usize), f32, Cpu, NoneTape> {
    let shape = (entries.len() / n_columns, n_columns);
    Cpu::default().tensor_from_vec(entries, shape)
}

/// What takes from `n_features` features the first ones, for which a network is made, each by its α.
fn selection(mask: &Mask, n_features: usize) -> Tensor<(usize, usize), f32, Cpu, NoneTape> {
    let n_seen = mask.n_features();
    let mut entries = vec![0.0; n_features * n_seen];
    for (k, alpha) in mask.alpha().iter().enumerate() {
        entries[k * (n_seen + 1)] = *alpha;
    }
    matrix(entries, n_seen)
}

#[test]
fn a_network_that_comes_in_late_steps_as_one_that_begins() {
    // Adam's first step moves every weight by the learning rate, whenever it is; with moments that are corrected for steps
    // in which the network was hidden, it would be three times as far.
    let x0 = sphere();
    let config = configs()[3];
    let mut network = Network::new(Shapes::at_rest(&x0), &config, 3).unwrap();
    let last_of = |network: &Network, k: usize| {
        let tensors = network.parameters.tensors();
        let mut entries = Vec::new();
        super::super::tape::copy(tensors[6 * k + 4], &mut entries);
        entries
    };
    for _ in 0..20 {
        let gradient = field(network.positions());
        network.descend(&gradient, 1e-3).unwrap();
    }
    assert!(last_of(&network, 1).iter().all(|&w| w == 0.0));
    // The step that reveals it evaluates it; the next one moves it.
    network.set_progress(0.5).unwrap();
    network.evaluate();
    let gradient = field(network.positions());
    network.descend(&gradient, 1e-3).unwrap();
    let moved = last_of(&network, 1);
    assert!(moved.iter().all(|w| w.abs() < 1.01e-3));
    assert!(moved.iter().any(|w| w.abs() > 0.99e-3));
}

#[test]
fn a_first_step_moves_every_weight_by_the_learning_rate_and_a_second_like_it_again() {
    // Adam, its moments corrected: m / √v is 1 in the first step, and in all that have the same gradient.
    let x0 = sphere();
    for config in configs() {
        let mut network = Network::new(Shapes::at_rest(&x0), &config, 3).unwrap();
        let gradient = field(&x0);
        for n_steps in 1..=2 {
            network.descend(&gradient, 1e-5).unwrap();
            let mut last = Vec::new();
            super::super::tape::copy(network.parameters.tensors()[4], &mut last);
            // A neuron that no point activates stays.
            let moved = last.iter().filter(|w| **w != 0.0);
            assert!(moved.clone().count() > last.len() / 4);
            let expected = n_steps as f32 * 1e-5;
            assert!(moved
                .clone()
                .all(|w| (w.abs() / expected - 1.0).abs() < 0.02));
        }
    }
}

/// Vertices that start at one place stay there to a network of the initial positions, and part to one of the rest shape.
#[test]
fn what_starts_laid_on_each_other_parts_by_its_place_at_rest() {
    let rest = sphere();
    let initial = rest.map(|p| Point3::new(p.x, p.y, p.z.abs()));
    let outwards = rest.map(|p| Vector3::new(0.0, 0.0, -p.z) / rest.len() as f64);
    let gap = |input| {
        let config = NetworkConfig {
            input,
            ..NetworkConfig::guide()
        };
        let shapes = Shapes {
            rest: &rest,
            initial: &initial,
        };
        let mut network = Network::new(shapes, &config, 1).unwrap();
        assert_eq!(network.positions(), &initial);
        for _ in 0..20 {
            network.descend(&outwards, 1e-2).unwrap();
        }
        let x = network.positions();
        let (above, below) = (mean_z(x, &rest, 1.0), mean_z(x, &rest, -1.0));
        assert!(network.network().is_some() == (input == NetworkInput::Initial));
        (above - below).abs()
    };
    assert!(gap(NetworkInput::Initial) < 1e-3);
    assert!(gap(NetworkInput::Rest) > 0.1);
}

/// Mean z of the vertices that are on this side at rest.
fn mean_z(x: &Positions, rest: &Positions, side: f64) -> f64 {
    let on_side = x.iter().zip(rest).filter(|(_, r)| r.z * side > 0.5);
    let (sum, n) = on_side.fold((0.0, 0), |(sum, n), (p, _)| (sum + p.z, n + 1));
    sum / f64::from(n)
}
