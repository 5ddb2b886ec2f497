//! Inputs that do not fit together, or are no numbers, are refused with the place where they do not.

use std::sync::Arc;

use mesh_core::{shapes, Landmark, Point3, Positions, Vector3, VertexData, VertexId};
use neural_drape::{Drape, DrapeError, DrapeInput};

use crate::setup::{short, Pair};

/// Numbers that no coordinate may be.
const NO_NUMBERS: [f64; 3] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

fn refused(input: DrapeInput<'_>) -> DrapeError {
    match Drape::new(input, short("standard", 5)) {
        Err(error) => error,
        Ok(_) => panic!("accepted"),
    }
}

#[test]
fn a_drape_can_go_to_another_thread() {
    fn is_owned<T: Send + 'static>() {}
    is_owned::<Drape>();

    let pair = Pair::new(shapes::icosphere(1));
    let mut drape = Drape::new(pair.input(), short("standard", 3)).unwrap();
    drop(pair);
    let thread = std::thread::spawn(move || {
        while drape.step().unwrap().is_some() {}
        drape
    });
    assert!(thread.join().unwrap().is_finished());
}

#[test]
fn a_run_is_finished_after_its_last_step_and_not_before() {
    let pair = Pair::new(shapes::icosphere(1));
    let mut drape = Drape::new(pair.input(), short("standard", 2)).unwrap();
    for _ in 0..2 {
        assert!(!drape.is_finished());
        drape.step().unwrap();
    }
    assert!(drape.is_finished());
    drape.extend(1);
    assert!(!drape.is_finished());
}

#[test]
fn inputs_of_different_lengths_are_refused() {
    let (pair, other) = (
        Pair::new(shapes::icosphere(1)),
        Pair::new(shapes::icosphere(0)),
    );
    let input = DrapeInput {
        initial: &other.initial,
        ..pair.input()
    };
    assert!(matches!(refused(input), DrapeError::LengthMismatch { .. }));
}

#[test]
fn the_triangulation_of_another_mesh_is_refused_with_both_counts() {
    let pair = Pair::new(shapes::icosphere(1));
    let (larger, smaller) = (
        Pair::new(shapes::icosphere(2)),
        Pair::new(shapes::icosphere(0)),
    );
    let of = |other: &Pair| {
        refused(DrapeInput {
            triangulation: &other.triangulation,
            ..pair.input()
        })
    };
    assert!(matches!(
        of(&smaller),
        DrapeError::ForeignTriangulation {
            n_triangulated: 12,
            ..
        }
    ));
    let error = of(&larger);
    assert!(matches!(
        error,
        DrapeError::ForeignTriangulation {
            n_triangulated: 162,
            n_vertices: 42
        }
    ));
    let message = error.to_string();
    assert!(
        message.contains("162") && message.contains("42"),
        "{message}"
    );
}

#[test]
fn a_vertex_that_is_not_finite_is_named() {
    let pair = Pair::new(shapes::icosphere(1));
    for value in NO_NUMBERS {
        let spoiled = |x: &Positions| {
            let mut x = x.clone();
            x[VertexId::new(7)].y = value;
            x
        };
        let (rest, initial) = (Arc::new(spoiled(&pair.rest)), spoiled(&pair.initial));
        let with_rest = DrapeInput {
            rest: &rest,
            ..pair.input()
        };
        let with_initial = DrapeInput {
            initial: &initial,
            ..pair.input()
        };
        for (input, shape) in [(with_rest, "rest"), (with_initial, "initial")] {
            match refused(input) {
                DrapeError::VertexNotFinite { what, vertex: 7 } => assert!(what.contains(shape)),
                other => panic!("{other}"),
            }
        }
    }
}

#[test]
fn a_landmark_that_is_not_finite_is_named_and_the_old_ones_stay() {
    let pair = Pair::new(shapes::icosphere(1));
    let sound = Landmark::new(VertexId::new(3), Point3::new(0.0, 0.5, 0.0));
    for value in NO_NUMBERS {
        let mut target = sound.clone();
        target.target.z = value;
        let mut place = sound.clone();
        place.source.weights[2] = value;
        for spoiled in [target, place] {
            let landmarks = [sound.clone(), spoiled];
            let input = DrapeInput {
                landmarks: &landmarks,
                ..pair.input()
            };
            assert!(matches!(
                refused(input),
                DrapeError::LandmarkNotFinite { landmark: 1 }
            ));
            let mut drape = Drape::new(pair.input(), short("standard", 5)).unwrap();
            let answer = drape.set_landmarks(&landmarks);
            assert!(matches!(
                answer,
                Err(DrapeError::LandmarkNotFinite { landmark: 1 })
            ));
            let step = drape.step().unwrap().unwrap();
            let term = step.terms.iter().find(|t| t.name == "landmarks").unwrap();
            assert_eq!(term.value, 0.0);
        }
    }
}

#[test]
fn a_displacement_that_is_not_finite_is_named_and_nothing_moves() {
    let pair = Pair::new(shapes::icosphere(1));
    let mut drape = Drape::new(pair.input(), short("standard", 5)).unwrap();
    let before = drape.positions();
    for value in NO_NUMBERS {
        let mut moves = VertexData::new(pair.rest.len(), Vector3::zeros());
        moves[VertexId::new(11)].x = value;
        let answer = drape.displace(&moves);
        assert!(matches!(
            answer,
            Err(DrapeError::VertexNotFinite { vertex: 11, .. })
        ));
        assert_eq!(drape.positions(), before);
    }
}
