//! The preconditioned vertices and their Adam against closed forms.

use mesh_core::{shapes, Positions, Triangulation, Vector3, VertexData, VertexId};
use neural_drape::{Parametrization, Vertices, VerticesConfig};

/// Without smoothing: the preconditioner is the identity.
fn plain() -> VerticesConfig {
    VerticesConfig {
        smoothing_start: 0.0,
        smoothing_end: 0.0,
        n_levels: 1,
        adaptivity: 0.0,
        ..VerticesConfig::standard()
    }
}

fn sphere() -> (Triangulation, Positions) {
    let (mesh, x) = shapes::quad_sphere(4)
        .into_halfedge()
        .expect("a shape is a mesh");
    (Triangulation::new(&mesh, &x), x)
}

/// Under a gradient that stays, both running means, rid of their bias, are the gradient: the steepest vertex moves by the
/// learning rate, the others in proportion.
#[test]
fn every_step_against_a_constant_gradient_has_the_length_of_the_rate() {
    let (triangulation, x0) = sphere();
    let mut gradient = VertexData::new(x0.len(), Vector3::zeros());
    gradient[VertexId::new(3)] = Vector3::new(0.0, 8.0, 6.0);
    gradient[VertexId::new(9)] = Vector3::new(5.0, 0.0, 0.0);
    let mut vertices = Vertices::new(&triangulation, &x0, &plain()).unwrap();
    vertices.set_progress(0.0).unwrap();
    for step in 1..=5 {
        vertices.descend(&gradient, 0.01).unwrap();
        let length = 0.01 * f64::from(step);
        for v in x0.ids() {
            let moved = vertices.positions()[v] - x0[v];
            let expected = gradient[v] * (-length / 10.0);
            assert!((moved - expected).norm() < 1e-12, "step {step}: {moved}");
        }
    }
}

#[test]
fn with_full_adaptivity_every_vertex_moves_by_the_rate() {
    let (triangulation, x0) = sphere();
    let mut gradient = VertexData::new(x0.len(), Vector3::zeros());
    gradient[VertexId::new(3)] = Vector3::new(0.0, 8.0, 6.0);
    gradient[VertexId::new(9)] = Vector3::new(0.5, 0.0, 0.0);
    let config = VerticesConfig {
        adaptivity: 1.0,
        adapt_from: 0.5,
        ..plain()
    };
    let moved = |progress: f64| {
        let mut vertices = Vertices::new(&triangulation, &x0, &config).unwrap();
        vertices.set_progress(progress).unwrap();
        vertices.descend(&gradient, 0.01).unwrap();
        [3, 9].map(|row| {
            let v = VertexId::new(row);
            (vertices.positions()[v] - x0[v]).norm()
        })
    };
    let close =
        |found: [f64; 2], expected: [f64; 2]| (0..2).all(|k| (found[k] - expected[k]).abs() < 1e-9);
    assert!(close(moved(0.49), [0.01, 0.0005]), "{:?}", moved(0.49));
    assert!(close(moved(0.5), [0.01, 0.01]), "{:?}", moved(0.5));
}

/// What moves with smoothing is a whole neighbourhood, and less of it at the end.
#[test]
fn steps_spread_over_the_surface_and_less_far_as_the_run_goes_on() {
    let (triangulation, x0) = sphere();
    let mut gradient = VertexData::new(x0.len(), Vector3::zeros());
    gradient[VertexId::new(0)] = Vector3::new(1.0, 0.0, 0.0);
    let config = VerticesConfig {
        smoothing_start: 1.0,
        smoothing_end: 0.1,
        n_levels: 2,
        ..plain()
    };
    let spread = |progress: f64| {
        let mut vertices = Vertices::new(&triangulation, &x0, &config).unwrap();
        vertices.set_progress(progress).unwrap();
        vertices.descend(&gradient, 0.01).unwrap();
        let moved = x0.ids().map(|v| (vertices.positions()[v] - x0[v]).norm());
        let moved: Vec<f64> = moved.collect();
        let largest = moved.iter().copied().fold(0.0, f64::max);
        moved.iter().sum::<f64>() / largest
    };
    let (start, end) = (spread(0.0), spread(0.9));
    assert!(start > 2.0 * end && end > 1.0, "{start} and {end}");
}
