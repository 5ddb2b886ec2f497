//! The last stage of a run.

use mesh_core::{shapes, Landmark, Positions, VertexId};
use neural_drape::{Drape, DrapeConfig, DrapeInput};

use crate::setup::{short, Pair};

/// A sphere of which one vertex was thrown over its neighbours, and that vertex.
fn folded() -> (Pair, Positions, VertexId) {
    let pair = Pair::new(shapes::quad_sphere(48));
    let mut x = pair.rest.as_ref().clone();
    let v = VertexId::new(1040);
    let is_side = |t: &&[VertexId; 3]| t.contains(&v);
    let triangle = pair.triangulation.triangles().iter().find(is_side);
    let other = triangle
        .expect("a vertex has neighbours")
        .iter()
        .copied()
        .find(|&w| w != v)
        .expect("a vertex has neighbours");
    x[v] = x[v] + (x[other] - x[v]) * 1.6;
    (pair, x, v)
}

fn finished(pair: &Pair, x: &Positions, landmarks: &[Landmark], repair: bool) -> Positions {
    let input = DrapeInput {
        initial: x,
        landmarks,
        ..pair.input()
    };
    let config = DrapeConfig {
        repair,
        ..short("standard", 5)
    };
    let drape = Drape::new(input, config).expect("sound settings");
    let end = drape.finish();
    assert!(!end.before.is_empty());
    end.positions
}

#[test]
fn the_last_stage_mends_and_holds_the_vertices_of_landmarks() {
    let (pair, x, v) = folded();
    let there = finished(&pair, &x, &[], true);
    assert!((there[v] - x[v]).norm() > 1e-3, "nothing was mended");

    let held = finished(&pair, &x, &[Landmark::new(v, x[v])], true);
    // Into the unit frame and back.
    assert!((held[v] - x[v]).norm() < 1e-12);
}

#[test]
fn a_run_that_does_not_repair_ends_where_it_is() {
    let (pair, x, _) = folded();
    let there = finished(&pair, &x, &[], false);
    let shifts = there.iter().zip(&x).map(|(a, b)| (a - b).norm());
    assert!(shifts.fold(0.0, f64::max) < 1e-12);
}
