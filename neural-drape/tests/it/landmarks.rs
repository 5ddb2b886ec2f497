//! Landmarks can be changed between two steps, as the paper's interactive mode asks.

use mesh_core::{shapes, Landmark, Point3, VertexId};
use neural_drape::{Drape, DrapeError};

use crate::setup::{short, Pair};

#[test]
fn a_landmark_added_on_the_way_is_met() {
    let pair = Pair::new(shapes::icosphere(2));
    let mut drape = Drape::new(pair.input(), short("standard", 200)).unwrap();
    for _ in 0..40 {
        drape.step().unwrap();
    }
    let v = VertexId::new(0);
    let goal = crate::setup::on_ellipsoid(&pair.rest[VertexId::new(12)]);
    let before = (drape.positions()[v] - goal).norm();
    drape.set_landmarks(&[Landmark::new(v, goal)]).unwrap();
    while drape.step().unwrap().is_some() {}
    let after = (drape.positions()[v] - goal).norm();
    assert!(after < 0.2 * before, "{before} to {after}");
    assert_eq!(drape.iteration(), 200);
    assert!(drape.step().unwrap().is_none());
}

#[test]
fn a_landmark_on_a_vertex_that_is_not_there_is_refused() {
    let pair = Pair::new(shapes::icosphere(1));
    let mut drape = Drape::new(pair.input(), short("standard", 5)).unwrap();
    let wrong = Landmark::new(VertexId::new(1_000_000), Point3::origin());
    let answer = drape.set_landmarks(&[wrong]);
    assert!(matches!(
        answer,
        Err(DrapeError::LandmarkOutOfRange {
            landmark: 0,
            vertex: 1_000_000,
            ..
        })
    ));
    assert!(drape.step().unwrap().is_some());
}
