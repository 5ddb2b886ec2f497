//! A result deformed further by landmarks that are added to it.

use mesh_core::{Landmark, UnitFrame, Vector3, VertexId};
use mesh_init::{adjust, InitError, InitInput};

use crate::shapes::{self as all_shapes, Shape};

fn input<'a>(s: &'a Shape, landmarks: &'a [Landmark]) -> InitInput<'a> {
    InitInput {
        triangulation: &s.triangulation,
        rest: &s.rest,
        landmarks,
        target_frame: UnitFrame::principal(s.rest.as_slice()),
    }
}

/// The result is the shape at twice its size, so that whoever started from the rest shape again would be found out.
#[test]
fn landmarks_are_met_and_without_any_nothing_moves() {
    for s in all_shapes::all() {
        let present = s.rest.map(|p| p * 2.0);
        let still = adjust(input(&s, &[]), &present).unwrap();
        assert!(all_shapes::largest_distance(&still, &present) < 1e-12);

        let [v, w] = [0, s.rest.len() - 1].map(VertexId::new);
        let goal = present[v] + Vector3::new(0.1, -0.05, 0.02);
        let landmarks = [Landmark::new(v, goal), Landmark::new(w, present[w])];
        let moved = adjust(input(&s, &landmarks), &present).unwrap();
        assert!((moved[v] - goal).norm() < 1e-8, "{}", s.name);
        assert!((moved[w] - present[w]).norm() < 1e-8, "{}", s.name);
    }
}

#[test]
fn a_result_of_another_mesh_is_refused() {
    let s = &all_shapes::all()[0];
    let short = s.rest.iter().copied().take(2).collect();
    assert!(matches!(
        adjust(input(s, &[]), &short),
        Err(InitError::PositionCount { n_positions: 2, .. })
    ));
}
