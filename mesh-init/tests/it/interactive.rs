//! Landmarks that are dragged: kept systems give what fresh ones give.

use mesh_core::{shapes, Landmark, LandmarkKind, Point3, Positions, UnitFrame, Vector3, VertexId};
use mesh_init::{
    adjust, initialize, InitConfig, InitError, InitInput, InteractiveInit, SimilarityPrior,
};
use nalgebra::Rotation3;
use proptest::prelude::*;

use crate::shapes::{self as all_shapes, Shape};

/// Every shape is its own stand-in.
const ALL: usize = usize::MAX;

fn input<'a>(s: &'a Shape, landmarks: &'a [Landmark]) -> InitInput<'a> {
    InitInput {
        triangulation: &s.triangulation,
        rest: &s.rest,
        landmarks,
        target_frame: frame(s),
    }
}

fn frame(s: &Shape) -> UnitFrame {
    UnitFrame::principal(s.rest.as_slice())
}

fn interactive(s: &Shape, max_vertices: usize, config: InitConfig) -> InteractiveInit {
    InteractiveInit::new(&s.triangulation, &s.rest, max_vertices, config)
        .expect("the shape has a stand-in")
}

fn bent(p: &Point3) -> Point3 {
    Point3::new(1.5 * p.x, p.y + 0.2 * p.x * p.x, p.z - 0.1 * p.x)
}

fn landmarks(vertices: &[VertexId], goal: &Positions) -> Vec<Landmark> {
    let landmark = |&v: &VertexId| Landmark::new(v, goal[v]);
    vertices.iter().map(landmark).collect()
}

#[test]
fn the_first_solve_is_that_of_initialize() {
    for s in all_shapes::all() {
        let goal = s.rest.map(bent);
        let mut marks = landmarks(&all_shapes::handles(&s), &goal);
        for n_rigid in [0, 1, 4] {
            marks
                .iter_mut()
                .take(n_rigid)
                .for_each(|l| l.kind = LandmarkKind::Rigid);
            for config in [InitConfig::paper(), InitConfig::standard()] {
                let fresh = initialize(input(&s, &marks), &config).unwrap();
                let mut interactive = interactive(&s, ALL, config);
                // The second solve uses what the first one kept.
                for _ in 0..2 {
                    let solved = interactive.solve(&marks, frame(&s)).unwrap();
                    assert_eq!(solved, fresh, "{}", s.name);
                }
            }
        }
    }
}

/// The vertices at both ends of three nearly orthogonal axes of a ball, each followed by its antipode.
fn ends(s: &Shape) -> [VertexId; 6] {
    let at = |p: Point3| {
        let squared = |v: &VertexId| (s.rest[*v] - p).norm_squared();
        let nearest = s
            .mesh
            .vertices()
            .min_by(|a, b| squared(a).total_cmp(&squared(b)));
        nearest.expect("a ball has vertices")
    };
    let mut ends = [VertexId::new(0); 6];
    for (k, axis) in [
        Vector3::new(1.0, 0.2, 0.1),
        Vector3::new(0.0, 1.0, 0.3),
        Vector3::z(),
    ]
    .into_iter()
    .enumerate()
    {
        ends[2 * k] = at(Point3::from(axis));
        ends[2 * k + 1] = at(Point3::from(-s.rest[ends[2 * k]].coords));
    }
    ends
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Opposite landmarks that move alike, and two others the other way, do not change the affine map, so that fresh
    /// systems are those that were kept.
    #[test]
    fn a_drag_gives_what_fresh_systems_give(d in prop::array::uniform3(-0.1..0.1f64), is_similar: bool) {
        let s = all_shapes::shape("quad sphere", shapes::quad_sphere(5));
        let marks = landmarks(&ends(&s), &s.rest.map(bent));
        let standard = if is_similar { InitConfig::standard() } else { InitConfig::paper() };
        let config = InitConfig { prior: SimilarityPrior::None, ..standard };
        let mut interactive = interactive(&s, ALL, config);
        interactive.solve(&marks, frame(&s)).unwrap();

        let mut moved = marks;
        for (mark, sign) in moved.iter_mut().zip([1.0, 1.0, -1.0, -1.0]) {
            mark.target += Vector3::from(d) * sign;
        }
        let dragged = interactive.solve(&moved, frame(&s)).unwrap();
        let fresh = initialize(input(&s, &moved), &config).unwrap();
        // The fresh map differs by its rounding, 1e-15, which the systems amplify.
        let apart = all_shapes::largest_distance(&dragged.positions, &fresh.positions);
        prop_assert!(apart < 1e-9, "{apart}");
        for (one, other) in dragged.affine.residuals.iter().zip(&fresh.affine.residuals) {
            prop_assert!((one - other).abs() < 1e-9);
        }
    }

    #[test]
    fn a_result_that_is_adjusted_takes_any_drag(d in prop::array::uniform3(-0.5..0.5f64), row in 0..4usize) {
        for s in all_shapes::all() {
            let present = s.rest.map(bent);
            let mut marks = landmarks(&all_shapes::handles(&s), &present);
            let mut interactive = interactive(&s, ALL, InitConfig::standard());
            interactive.adjust(&marks, &present).unwrap();
            marks[row].target += Vector3::from(d);
            let dragged = interactive.adjust(&marks, &present).unwrap();
            prop_assert_eq!(dragged, adjust(input(&s, &marks), &present).unwrap());
        }
    }
}

/// More landmarks, other places, and a map that drifts far: all are noticed.
#[test]
fn what_was_kept_for_something_else_is_not_used() {
    let s = all_shapes::shape("icosphere", shapes::icosphere(2));
    let goal = s.rest.map(bent);
    let mut interactive = interactive(&s, ALL, InitConfig::standard());
    let more: Vec<VertexId> = s.mesh.vertices().step_by(11).collect();
    let elsewhere = s.rest.map(|p| bent(p) * 3.0);
    for (vertices, goal) in [
        (&more[..5], &goal),
        (&more[..6], &goal),
        (&more[1..7], &goal),
        (&more[1..7], &elsewhere),
        (&more[..0], &goal),
    ] {
        let marks = landmarks(vertices, goal);
        let fresh = initialize(input(&s, &marks), &InitConfig::standard()).unwrap();
        let solved = interactive.solve(&marks, frame(&s)).unwrap();
        assert_eq!(solved, fresh);
        let adjusted = interactive.adjust(&marks, goal).unwrap();
        assert_eq!(adjusted, adjust(input(&s, &marks), goal).unwrap());
    }
}

#[test]
fn a_dense_shape_gets_nearly_the_same_from_its_stand_in() {
    for s in [
        all_shapes::shape("quad sphere", shapes::quad_sphere(24)),
        all_shapes::shape("open grid", shapes::open_grid(50, 60)),
    ] {
        let size = frame(&s).scale;
        let goal = s.rest.map(|p| bent(&(p * (1.0 / size))));
        let vertices: Vec<VertexId> = s.mesh.vertices().step_by(s.rest.len() / 9).collect();
        let mut marks = landmarks(&vertices, &goal);
        for config in [InitConfig::paper(), InitConfig::standard()] {
            let mut interactive = interactive(&s, 600, config);
            for _ in 0..2 {
                let fresh = initialize(input(&s, &marks), &config).unwrap();
                let solved = interactive.solve(&marks, frame(&s)).unwrap();
                let apart = all_shapes::largest_distance(&solved.positions, &fresh.positions);
                assert!(apart < 0.03, "{}: {apart}", s.name);
                for mark in &marks {
                    let missed = |x: &Positions| (mark.source.position(x) - mark.target).norm();
                    let (coarse, exact) = (missed(&solved.positions), missed(&fresh.positions));
                    assert!(coarse < exact + 2e-3, "{}: {coarse}, {exact}", s.name);
                }
                marks[4].target += Vector3::new(0.03, 0.04, -0.02);
            }
        }
    }
}

#[test]
fn a_similarity_is_exact_on_any_stand_in_and_an_adjusted_shape_keeps_its_detail() {
    let mut soup = shapes::quad_sphere(16);
    for (row, p) in soup.positions.iter_mut().enumerate() {
        *p *= 1.0 + 0.01 * (row % 7) as f64;
    }
    let s = all_shapes::shape("rough ball", soup);
    let turn = Rotation3::from_euler_angles(0.5, 1.0, -2.0);
    let goal = s.rest.map(|p| turn * p * 3.0 + Vector3::new(1.0, 2.0, 3.0));
    let vertices: Vec<VertexId> = s.mesh.vertices().step_by(s.rest.len() / 7).collect();
    let marks = landmarks(&vertices, &goal);
    let mut interactive = interactive(&s, 200, InitConfig::standard());
    let solved = interactive.solve(&marks, frame(&s)).unwrap();
    let apart = all_shapes::largest_distance(&solved.positions, &goal);
    assert!(apart < 1e-6, "{apart}");

    let still = interactive.adjust(&marks, &goal).unwrap();
    let apart = all_shapes::largest_distance(&still, &goal);
    assert!(apart < 1e-9, "{apart}");
}

#[test]
fn bad_landmarks_and_shapes_are_refused() {
    let s = all_shapes::shape("icosphere", shapes::icosphere(2));
    let mut interactive = interactive(&s, 60, InitConfig::standard());
    let far = [Landmark::new(VertexId::new(900), Point3::origin())];
    assert!(matches!(
        interactive.solve(&far, frame(&s)),
        Err(InitError::LandmarkOutOfRange { vertex: 900, .. })
    ));
    let short = s.rest.iter().copied().take(3).collect();
    assert!(matches!(
        interactive.adjust(&[], &short),
        Err(InitError::PositionCount { n_positions: 3, .. })
    ));
    let broken = s.rest.map(|p| p * f64::NAN);
    let refused = InteractiveInit::new(&s.triangulation, &broken, 60, InitConfig::standard()).err();
    assert!(
        matches!(refused, Some(InitError::StandIn(_))),
        "{refused:?}"
    );
}
