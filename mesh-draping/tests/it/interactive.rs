//! A drape that is changed on the way.

use mesh_draping::neural_drape::Regions;
use mesh_draping::{Draping, Transfer};

use crate::support::{ball_and_ellipsoid, same_bits, short};

fn start() -> Draping {
    let pair = ball_and_ellipsoid(6);
    let transfer = Transfer::of_pair(pair, short(12));
    transfer.start().expect("the drape starts")
}

fn steps(draping: &mut Draping, n: usize) {
    for _ in 0..n {
        let step = draping.step().expect("the drape goes on");
        assert!(step.is_some());
    }
}

#[test]
fn landmarks_that_move_take_the_shape_along_and_give_more_time() {
    let mut draping = start();
    steps(&mut draping, 20);
    let n_before = draping.n_iterations();
    let mut landmarks = draping.pair().landmarks.clone();
    landmarks[0].target.x += 1.0;
    draping.set_landmarks(landmarks.clone()).unwrap();
    let at = landmarks[0].source.position(&draping.positions());
    assert!((at - landmarks[0].target).norm() < 1e-6);
    assert!(draping.n_iterations() > n_before);
    assert_eq!(draping.pair().landmarks, landmarks);
}

#[test]
fn landmarks_of_another_mesh_are_refused_and_nothing_changes() {
    let mut draping = start();
    steps(&mut draping, 3);
    let before = draping.positions();
    let mut landmarks = draping.pair().landmarks.clone();
    let far = mesh_draping::mesh_core::VertexId::new(100_000);
    landmarks[0].source = mesh_draping::mesh_core::MeshPoint::vertex(far);
    assert!(draping.set_landmarks(landmarks).is_err());
    assert!(same_bits(&draping.positions(), &before));
    assert_eq!(draping.pair().landmarks, start().pair().landmarks);
}

#[test]
fn a_saved_drape_goes_on_to_the_same_bits() {
    let mut draping = start();
    steps(&mut draping, 7);
    let n = draping.pair().source.rest().len();
    let mut regions = Regions::none(n);
    for v in regions.attraction.ids().take(9) {
        regions.attraction[v] = 0.0;
    }
    draping.set_regions(regions.clone()).unwrap();
    let (state, landmarks) = (draping.state(), draping.pair().landmarks.clone());
    let mut resumed = start();
    resumed.restore(&state, landmarks, regions).unwrap();
    assert_eq!(resumed.iteration(), 7);
    while draping.step().unwrap().is_some() {
        assert!(resumed.step().unwrap().is_some());
    }
    assert!(same_bits(&draping.positions(), &resumed.positions()));
}

#[test]
fn a_longer_run_goes_on_after_its_end() {
    let mut draping = start();
    while draping.step().unwrap().is_some() {}
    assert!(draping.is_over());
    draping.extend(5);
    assert!(!draping.is_over());
    steps(&mut draping, 5);
    assert!(draping.step().unwrap().is_none());
}

#[test]
fn the_landmarks_of_a_dense_source_move_with_its_stand_in() {
    let pair = ball_and_ellipsoid(51);
    let mut draping = Transfer::of_pair(pair, short(6)).start().unwrap();
    steps(&mut draping, 4);
    let mut landmarks = draping.pair().landmarks.clone();
    landmarks[0].target.x += 1.0;
    draping.set_landmarks(landmarks.clone()).unwrap();
    let at = landmarks[0].source.position(&draping.positions());
    assert!((at - landmarks[0].target).norm() < 1e-6);
}
