//! Settings are checked by name.

use mesh_core::shapes;
use neural_drape::network::{Encoding, Frequencies, NetworkConfig};
use neural_drape::{Drape, DrapeConfig, DrapeError, ParametrizationConfig, VerticesConfig};

use crate::setup::{short, Pair};

/// A setting and its value before a drape is made of it.
type Change<'c> = (&'static str, &'c dyn Fn(&mut DrapeConfig, f64));

#[test]
fn unknown_presets_are_refused_with_the_known_ones() {
    let message = DrapeConfig::named("fastest").unwrap_err().to_string();
    assert!(
        message.contains("fastest") && message.contains("standard"),
        "{message}"
    );
}

#[test]
fn settings_out_of_range_are_named() {
    let pair = Pair::new(shapes::icosphere(1));
    let refused = |change: fn(&mut DrapeConfig)| {
        let mut config = short("standard", 5);
        change(&mut config);
        match Drape::new(pair.input(), config) {
            Err(DrapeError::Setting { name, .. }) => name,
            Err(other) => panic!("{other}"),
            Ok(_) => panic!("accepted"),
        }
    };
    assert_eq!(refused(|c| c.worst_share = 2.0), "worst_share");
    assert_eq!(
        refused(|c| c.learning_rate.peak = f64::NAN),
        "learning_rate.peak"
    );
    assert_eq!(refused(|c| c.sampling.n_samples = 0), "sampling.n_samples");
    assert_eq!(
        refused(|c| c.sampling.double_every = Some(0)),
        "sampling.double_every"
    );
    let warm_up = |c: &mut DrapeConfig| c.learning_rate.warm_up = usize::MAX;
    assert_eq!(refused(warm_up), "learning_rate.warm_up");
}

#[test]
fn no_setting_takes_a_negative_number_or_one_that_is_not_finite() {
    let vertices = |change: fn(&mut VerticesConfig, f64)| {
        move |c: &mut DrapeConfig, value| match &mut c.parametrization {
            ParametrizationConfig::Vertices(vertices) => change(vertices, value),
            ParametrizationConfig::Network(_) => panic!("the vertices move"),
        }
    };
    let settings: [Change<'_>; 12] = [
        ("learning_rate.peak", &|c, x| c.learning_rate.peak = x),
        ("learning_rate.decay", &|c, x| c.learning_rate.decay = x),
        ("sampling.face_uniform", &|c, x| c.sampling.face_uniform = x),
        ("worst_share", &|c, x| c.worst_share = x),
        ("worst_tolerance", &|c, x| c.worst_tolerance = x),
        ("skinny_threshold", &|c, x| c.skinny_threshold = x),
        ("smoothing_start", &vertices(|v, x| v.smoothing_start = x)),
        ("smoothing_end", &vertices(|v, x| v.smoothing_end = x)),
        ("adaptivity", &vertices(|v, x| v.adaptivity = x)),
        ("adapt_from", &vertices(|v, x| v.adapt_from = x)),
        ("betas", &vertices(|v, x| v.betas[0] = x)),
        ("betas", &vertices(|v, x| v.betas[1] = x)),
    ];
    for (name, change) in settings {
        for value in [-0.5, f64::NAN, f64::INFINITY] {
            assert_refused("standard", name, &|c| change(c, value));
        }
    }
    // Cosines may be negative.
    let cosines: [Change<'_>; 2] = [
        ("fold_limit", &|c, x| c.fold_limit = x),
        ("sampling.normal_bias", &|c, x| {
            c.sampling.normal_bias = Some(x)
        }),
    ];
    for (name, change) in cosines {
        for value in [-3.0, f64::NAN, f64::INFINITY] {
            assert_refused("standard", name, &|c| change(c, value));
        }
    }
}

#[test]
fn no_setting_of_the_network_takes_a_negative_number_or_one_that_is_not_finite() {
    fn network(c: &mut DrapeConfig) -> &mut NetworkConfig {
        match &mut c.parametrization {
            ParametrizationConfig::Network(network) => network,
            ParametrizationConfig::Vertices(_) => panic!("the network moves"),
        }
    }
    let settings: [Change<'_>; 3] = [
        ("output_scale", &|c, x| network(c).output_scale = x),
        ("deviation", &|c, deviation| {
            network(c).encoding = Encoding::Static(Frequencies::Gaussian {
                count: 5,
                deviation,
            });
        }),
        ("max", &|c, max| {
            network(c).encoding = Encoding::Static(Frequencies::Uniform {
                count: 5,
                max,
                trainable: false,
            });
        }),
    ];
    for (name, change) in settings {
        for value in [-0.5, f64::NAN, f64::INFINITY] {
            assert_refused("network", name, &|c| change(c, value));
        }
    }
}

#[test]
fn weights_that_are_negative_or_not_finite_are_named_by_stage_and_term() {
    for value in [-1e-9, f64::NAN, f64::INFINITY] {
        assert_refused("paper", "stages[1].to.area_kl", &|c| {
            c.stages[1].to.area_kl = value;
        });
        assert_refused("standard", "stages[0].from.landmark", &|c| {
            c.stages[0].from.landmark = value;
        });
        assert_refused("standard", "stages[1].from.drift", &|c| {
            c.stages[1].from.drift = value;
        });
    }
}

/// The settings of a preset with this change are refused by the name of one.
fn assert_refused(preset: &str, expected: &str, change: &dyn Fn(&mut DrapeConfig)) {
    let mut config = DrapeConfig::named(preset).expect("a known preset");
    change(&mut config);
    match config.check() {
        Err(DrapeError::Setting { name, .. }) => assert_eq!(name, expected),
        other => panic!("{expected}: {other:?}"),
    }
}

#[test]
fn settings_that_ask_for_too_much_memory_are_refused_by_name() {
    let refused = |preset: &str, change: fn(&mut DrapeConfig)| {
        let mut config = DrapeConfig::named(preset).unwrap();
        change(&mut config);
        match config.check() {
            Err(error @ DrapeError::Memory { .. }) => error.to_string(),
            other => panic!("{other:?}"),
        }
    };
    assert!(refused("standard", |c| c.sampling.n_hard = 1_000_000_000).contains("n_hard"));
    assert!(refused("standard", |c| c.sampling.n_samples = 100_000_000).contains("n_samples"));
    assert!(refused("standard", |c| c.sampling.max_samples = 900_000_000).contains("max_samples"));
    for (name, width, n_hidden_layers) in [
        ("width", 1_000_000, 1),
        ("n_hidden_layers", 1, 1_000_000_000),
    ] {
        let mut config = DrapeConfig::network();
        config.parametrization = ParametrizationConfig::Network(NetworkConfig {
            width,
            n_hidden_layers,
            ..NetworkConfig::standard()
        });
        let message = config.check().unwrap_err().to_string();
        assert!(
            message.contains(name) && message.contains("GiB"),
            "{message}"
        );
    }
}

#[test]
fn runs_that_never_end_are_refused() {
    assert_refused("standard", "stages[1].n_iterations", &|c| {
        c.stages[1].n_iterations = usize::MAX;
    });
    assert_refused("standard", "n_iterations of all stages", &|c| {
        c.stages
            .iter_mut()
            .for_each(|s| s.n_iterations = 600_000_000);
    });
    let pair = Pair::new(shapes::icosphere(1));
    let mut drape = Drape::new(pair.input(), short("standard", 5)).unwrap();
    drape.extend(usize::MAX);
    drape.extend(usize::MAX);
    assert_eq!(drape.n_iterations(), 1_000_000_000);
    assert!(drape.step().unwrap().is_some());
}

#[cfg(not(feature = "network"))]
#[test]
fn presets_that_move_a_network_say_that_this_build_has_none() {
    let pair = Pair::new(shapes::icosphere(1));
    for preset in ["network", "paper", "study"] {
        let answer = Drape::new(pair.input(), short(preset, 5));
        assert!(
            matches!(answer, Err(DrapeError::NetworkFeatureOff)),
            "{preset}"
        );
    }
}
