//! The presets `paper` and `authors`, step by step: what docs/paper.md says of them.

use mesh_core::{shapes, Landmark, Point3, Vector3, VertexId};
use neural_drape::network::{Encoding, Frequencies, NetworkConfig, NetworkInput, Networks, Reveal};
use neural_drape::{AngleReference, Descent, DrapeConfig, ParametrizationConfig, Weights};

use crate::setup::{on_ellipsoid, Pair};
use crate::steps::{norm, of_weights, recorded, with_only};

/// A preset with so few samples that its whole schedule takes a second.
fn light(preset: &str) -> DrapeConfig {
    let mut config = DrapeConfig::named(preset).expect("a known preset");
    config.sampling.n_samples = 20;
    config.sampling.max_samples = 20;
    config
}

#[test]
fn the_paper_descends_distance_and_structure_in_turn_1500_times_at_one_rate() {
    let mut pair = Pair::new(shapes::icosphere(0));
    let top = VertexId::new(0);
    pair.landmarks = vec![Landmark::new(top, on_ellipsoid(&pair.rest[top]))];
    let (log, reports) = recorded(&pair, light("paper"), Vector3::zeros());
    assert_eq!((log.len(), reports.len()), (3000, 1500));
    assert!(log.iter().all(|step| step.rate == 1e-3));
    for (iteration, (steps, report)) in log.chunks(2).zip(&reports).enumerate() {
        // Both steps see what the same progress reveals.
        let progress = iteration as f64 / 1500.0;
        assert!(steps.iter().all(|step| step.progress == progress));
        let (landmark, lambda) = if iteration < 1000 {
            (40_000.0, 1.0)
        } else {
            (4_000.0, 0.2)
        };
        let terms: Vec<_> = report.terms.iter().map(|t| (t.name, t.weight)).collect();
        let expected = [
            ("chamfer", 20.0),
            ("landmarks", landmark),
            ("angles", lambda),
            ("areas", lambda),
            ("skinny", 0.1),
        ];
        assert_eq!(terms, expected, "iteration {iteration}");
    }
}

#[test]
fn both_steps_carry_the_penalty_on_skinny_triangles() {
    let mut pair = Pair::new(shapes::icosphere(2));
    pair.initial = pair.rest.map(|p| Point3::new(p.x, p.y, 0.01 * p.z));
    let weights = Weights {
        triangle_quality: 0.1,
        ..Weights::ZERO
    };
    let mut config = of_weights(weights, 1);
    config.skinny_threshold = DrapeConfig::paper().skinny_threshold;
    config.descent = Descent::Alternating;
    let (log, reports) = recorded(&pair, config.clone(), Vector3::zeros());
    assert!(norm(&log[0].gradient) > 1e-3);
    assert_eq!(log[0].gradient, log[1].gradient);
    // It is one term of the report all the same.
    assert_eq!(reports[0].terms.len(), 1);
    config.descent = Descent::Combined;
    let (combined, _) = recorded(&pair, config, Vector3::zeros());
    assert_eq!(combined.len(), 1);
    assert_eq!(combined[0].gradient, log[0].gradient);
}

#[test]
fn the_paper_keeps_the_angles_of_the_source_and_the_authors_those_of_the_initial_shape() {
    let mut pair = Pair::new(shapes::icosphere(2));
    pair.initial = pair.rest.map(on_ellipsoid);
    let at_start = |preset: &str| {
        let angles = Weights {
            corner_angle: 1.0,
            ..Weights::ZERO
        };
        let config = with_only(light(preset), angles, 1);
        let (log, _) = recorded(&pair, config, Vector3::zeros());
        norm(&log[1].gradient)
    };
    assert!(at_start("paper") > 1e-2);
    assert!(at_start("authors") < 1e-9);
}

#[test]
fn samples_of_the_authors_stay_for_100_iterations_and_those_of_the_paper_are_drawn_anew() {
    let pair = Pair::new(shapes::icosphere(1));
    let gradients = |preset: &str| {
        let chamfer = Weights {
            chamfer: 1.0,
            ..Weights::ZERO
        };
        let mut config = with_only(light(preset), chamfer, 201);
        config.descent = Descent::Combined;
        let (log, _) = recorded(&pair, config, Vector3::zeros());
        log.into_iter()
            .map(|step| step.gradient)
            .collect::<Vec<_>>()
    };
    let kept = gradients("authors");
    assert!(kept[1..100].iter().all(|g| *g == kept[0]));
    assert!(kept[101..200].iter().all(|g| *g == kept[100]));
    assert!(kept[0] != kept[100] && kept[100] != kept[200]);
    let anew = gradients("paper");
    assert!(anew.windows(2).all(|pair| pair[0] != pair[1]));
}

#[test]
fn the_networks_are_those_of_the_paper_and_of_the_authors() {
    let frequencies = Frequencies::Uniform {
        count: 253,
        max: 10.0,
        trainable: true,
    };
    let network = |until, networks, output_scale| {
        ParametrizationConfig::Network(NetworkConfig {
            input: NetworkInput::Initial,
            n_hidden_layers: 4,
            width: 256,
            encoding: Encoding::Progressive {
                frequencies,
                n_blocks: 6,
                reveal: Reveal::HoldAndFade { until },
                networks,
            },
            output_scale,
        })
    };
    let paper = DrapeConfig::paper();
    assert_eq!(paper.parametrization, network(1.0, Networks::One, 1.0));
    let authors = DrapeConfig::authors();
    // Output 1 is a twentieth of the longest side: the unit of the authors' frame.
    let expected = network(2000.0 / 1500.0, Networks::OnePerBlock, 0.1);
    assert_eq!(authors.parametrization, expected);
}

#[test]
fn what_else_the_paper_and_the_authors_set() {
    for (preset, angles, face_uniform, keep_for) in [
        ("paper", AngleReference::Rest, 0.0, 1),
        ("authors", AngleReference::Initial, 0.5, 100),
    ] {
        let config = DrapeConfig::named(preset).unwrap();
        assert_eq!(config.descent, Descent::Alternating);
        assert_eq!(config.angle_reference, angles);
        assert_eq!(config.skinny_threshold, 0.1);
        assert_eq!(
            (config.learning_rate.peak, config.learning_rate.decay),
            (1e-3, 0.0)
        );
        assert_eq!(config.learning_rate.warm_up, 0);
        let sampling = config.sampling;
        assert_eq!((sampling.n_samples, sampling.max_samples), (3000, 10_000));
        assert_eq!(sampling.double_every, Some(100));
        assert_eq!(
            (sampling.face_uniform, sampling.keep_for),
            (face_uniform, keep_for)
        );
        assert_eq!((sampling.normal_bias, sampling.n_hard), (None, 0));
        assert!(!config.repair);
    }
}
