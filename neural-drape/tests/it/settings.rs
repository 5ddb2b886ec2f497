//! Settings are checked by name.

use mesh_core::shapes;
use neural_drape::{Drape, DrapeConfig, DrapeError};

use crate::setup::{short, Pair};

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
}

#[test]
fn inputs_of_different_lengths_are_refused() {
    let (pair, other) = (
        Pair::new(shapes::icosphere(1)),
        Pair::new(shapes::icosphere(0)),
    );
    let mut input = pair.input();
    input.initial = &other.initial;
    assert!(matches!(
        Drape::new(input, short("standard", 5)),
        Err(DrapeError::LengthMismatch { .. })
    ));
}
