//! A drape can be kept and gone on with, moved, and made longer.

use mesh_core::{shapes, Landmark, Positions, Vector3, VertexData, VertexId};
use neural_drape::{Drape, DrapeError, DrapeState};

use crate::setup::{presets, short, Pair};

fn steps(drape: &mut Drape, n: usize) {
    for _ in 0..n {
        drape.step().expect("a step");
    }
}

fn end(mut drape: Drape) -> Positions {
    while drape.step().expect("a step").is_some() {}
    drape.positions()
}

/// A ball with a landmark that is added, and iterations too.
fn changed_on_the_way(drape: &mut Drape, pair: &Pair) {
    let v = VertexId::new(3);
    drape
        .set_landmarks(&[Landmark::new(v, crate::setup::on_ellipsoid(&pair.rest[v]))])
        .expect("it fits");
    let up = VertexData::new(pair.rest.len(), Vector3::new(0.0, 0.05, 0.0));
    drape.displace(&up).expect("it fits");
    drape.extend(8);
}

#[test]
fn a_kept_drape_goes_on_to_the_same_bits() {
    let pair = Pair::new(shapes::quad_sphere(4));
    for preset in presets() {
        let mut drape = Drape::new(pair.input(), short(preset, 20)).unwrap();
        steps(&mut drape, 9);
        changed_on_the_way(&mut drape, &pair);
        steps(&mut drape, 6);
        let bytes = drape.state().as_bytes().to_vec();

        let mut again = Drape::new(pair.input(), short(preset, 20)).unwrap();
        let v = VertexId::new(3);
        again
            .set_landmarks(&[Landmark::new(v, crate::setup::on_ellipsoid(&pair.rest[v]))])
            .unwrap();
        again.restore(&DrapeState::from_bytes(bytes)).unwrap();
        assert_eq!((again.iteration(), again.n_iterations()), (15, 28));
        assert_eq!(again.positions(), drape.positions(), "{preset}");
        assert_eq!(end(again), end(drape), "{preset}");
    }
}

#[test]
fn a_foreign_or_damaged_state_is_refused() {
    let pair = Pair::new(shapes::quad_sphere(4));
    let other = Pair::new(shapes::icosphere(1));
    let mut drape = Drape::new(pair.input(), short("standard", 5)).unwrap();
    let state = drape.state();
    let mut foreign = Drape::new(other.input(), short("standard", 5)).unwrap();
    let half = DrapeState::from_bytes(state.as_bytes()[..60].to_vec());
    for (drape, state) in [(&mut foreign, &state), (&mut drape, &half)] {
        assert!(matches!(
            drape.restore(state),
            Err(DrapeError::ForeignState)
        ));
    }
}

#[test]
fn displacements_are_in_the_coordinates_of_the_target() {
    let pair = Pair::new(shapes::quad_sphere(4));
    let shift = Vector3::new(0.25, -0.5, 1.0);
    for preset in presets() {
        let mut drape = Drape::new(pair.input(), short(preset, 5)).unwrap();
        drape
            .displace(&VertexData::new(pair.rest.len(), shift))
            .unwrap();
        for (now, before) in drape.positions().iter().zip(&pair.initial) {
            // Two changes of frame round each coordinate, which is below 2.
            assert!((now - before - shift).norm() < 1e-14);
        }
        assert!(drape.network().is_none());
        let short = VertexData::new(1, shift);
        assert!(matches!(
            drape.displace(&short),
            Err(DrapeError::LengthMismatch { .. })
        ));
    }
}

#[test]
fn an_extended_run_has_that_many_more_iterations() {
    let pair = Pair::new(shapes::icosphere(1));
    let mut drape = Drape::new(pair.input(), short("standard", 4)).unwrap();
    steps(&mut drape, 5);
    drape.extend(3);
    assert!(drape.step().unwrap().is_some());
    assert_eq!((drape.iteration(), drape.n_iterations()), (5, 7));
}
