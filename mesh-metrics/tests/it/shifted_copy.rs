//! A shape and its copy, moved or bent by a known amount.

use mesh_core::{
    shapes, Landmark, Point3, PolygonSoup, Positions, TriangleSoup, Triangulation, Vector3,
    VertexId,
};
use mesh_metrics::{
    evaluate, EvaluateError, EvaluationConfig, EvaluationInput, Report, TargetKind,
};

const CONFIG: EvaluationConfig = EvaluationConfig {
    n_samples: 2_000,
    seed: 3,
};

fn closed_and_open() -> Vec<PolygonSoup> {
    vec![
        shapes::icosphere(2),
        shapes::quad_sphere(5),
        shapes::prism(6),
        shapes::open_grid(4, 3),
        shapes::cone(12),
    ]
}

/// The report of `shape` moved by `draw` and judged against `target`.
fn judge(shape: PolygonSoup, target: PolygonSoup, draw: impl Fn(&Point3) -> Point3) -> Report {
    let (mesh, rest) = shape.into_halfedge().unwrap();
    let target = TriangleSoup::new(target).unwrap();
    let draped = rest.map(draw);
    let input = EvaluationInput {
        triangulation: &Triangulation::new(&mesh, &rest),
        rest: &rest,
        draped: &draped,
        target: &target,
        landmarks: &[],
        truth: Some(&rest),
    };
    evaluate(input, &CONFIG).unwrap()
}

#[test]
fn perfect_copy_is_perfect() {
    for shape in closed_and_open() {
        let report = judge(shape.clone(), shape, |&p| p);
        assert!(report.hausdorff < 1e-12 && report.mean_l2_sum() < 1e-12);
        assert!((report.dirichlet - 1.0).abs() < 1e-12);
        assert!(report.q_transfer > 1.0 - 1e-12);
        assert_eq!(
            report.defects.folds + report.defects.skinny_new + report.defects.self_intersections,
            0
        );
        assert_eq!(report.defects.opposed_faces, Some(0));
        assert_eq!(report.target_kind, TargetKind::Surface);
    }
}

#[test]
fn hausdorff_of_a_sheet_moved_off_its_plane_is_the_shift() {
    // The sheet is 4 long, so a shift by 1 is a quarter; every point of either is exactly that far.
    let sheet = shapes::open_grid(4, 2);
    let report = judge(sheet.clone(), sheet, |p| p + Vector3::new(0.0, 0.0, 1.0));
    for figure in [
        report.hausdorff,
        report.to_target.mean_l2,
        report.to_draped.p50,
        report.to_draped.p99,
    ] {
        assert!((figure - 0.25).abs() < 1e-12);
    }
    assert!((report.mean_squared_sum() - 2.0 * 0.0625).abs() < 1e-12);
}

#[test]
fn hausdorff_of_any_shifted_copy_is_at_most_the_shift_and_near_it() {
    let shift = Vector3::new(0.05, 0.02, -0.03);
    for shape in [shapes::icosphere(2), shapes::quad_sphere(5)] {
        let size = mesh_core::Aabb::of(&shape.positions).longest_side();
        let report = judge(shape.clone(), shape, |p| p + shift);
        let expected = shift.norm() / size;
        // On a sphere the farthest point lies along the shift; facets 20° wide leave cos 10° of it.
        assert!(report.hausdorff <= expected + 1e-12 && report.hausdorff > 0.98 * expected);
    }
}

#[test]
fn hausdorff_is_symmetric() {
    let (small, large) = (shapes::icosphere(2), shapes::quad_sphere(4));
    let there = judge(small.clone(), large.clone(), |&p| p);
    let back = judge(large, small, |&p| p);
    // Both boxes have nearly the same side; the farthest points are vertices, so sampling does not matter.
    assert!((there.hausdorff - back.hausdorff).abs() < 0.05 * there.hausdorff);
    assert!((there.to_target.max - back.to_draped.max).abs() < 0.05 * there.hausdorff);
}

#[test]
fn uniform_scale_is_no_distortion() {
    for shape in closed_and_open() {
        let mut target = shape.clone();
        target.positions.iter_mut().for_each(|p| *p *= 7.0);
        let report = judge(shape, target, |p| p * 7.0);
        assert!((report.dirichlet - 1.0).abs() < 1e-12);
        assert!((report.dirichlet_raw - 1.0).abs() < 1e-12);
        assert!(report.hausdorff < 1e-12);
    }
}

#[test]
fn inside_out_copy_opposes_its_target_everywhere() {
    let shape = shapes::quad_sphere(4);
    let mut turned = shape.clone();
    turned.faces.iter_mut().for_each(|f| f.reverse());
    let report = judge(turned, shape, |&p| p);
    assert_eq!(report.defects.opposed_faces, Some(2 * 6 * 16));
    assert_eq!(report.places.opposed.len(), 6 * 16);
}

#[test]
fn truth_and_landmarks_are_measured_in_the_common_frame() {
    let (mesh, rest) = shapes::open_grid(4, 2).into_halfedge().unwrap();
    let target = TriangleSoup::new(shapes::open_grid(4, 2)).unwrap();
    let draped = rest.map(|p| p + Vector3::new(0.4, 0.0, 0.0));
    let mut landmarks = vec![
        Landmark::new(VertexId::new(0), rest[VertexId::new(0)]),
        Landmark::new(VertexId::new(7), draped[VertexId::new(7)]),
    ];
    landmarks[0].name = Some("corner".into());
    let input = EvaluationInput {
        triangulation: &Triangulation::new(&mesh, &rest),
        rest: &rest,
        draped: &draped,
        target: &target,
        landmarks: &landmarks,
        truth: Some(&rest),
    };
    let report = evaluate(input, &CONFIG).unwrap();
    let fit = report.landmarks.as_ref().unwrap();
    assert!((fit.max - 0.1).abs() < 1e-12 && (fit.rms - 0.1 / 2f64.sqrt()).abs() < 1e-12);
    assert_eq!(fit.residuals[1].distance, 0.0);
    let truth = report.truth.unwrap();
    assert!([truth.mean, truth.p95, truth.max]
        .iter()
        .all(|d| (d - 0.1).abs() < 1e-12));
    assert!(report.to_string().contains("corner"));
    assert!(report.figures().contains(&("landmark_max", fit.max)));
}

#[test]
fn same_seed_same_report() {
    let twist = |p: &Point3| Point3::new(p.x + 0.1 * p.y * p.z, p.y, p.z);
    let one = judge(shapes::quad_sphere(4), shapes::icosphere(2), twist);
    assert_eq!(
        one,
        judge(shapes::quad_sphere(4), shapes::icosphere(2), twist)
    );
}

#[test]
fn what_cannot_be_judged_is_said() {
    let (mesh, rest) = shapes::open_grid(2, 2).into_halfedge().unwrap();
    let target = TriangleSoup::new(shapes::open_grid(2, 2)).unwrap();
    let judge = |draped: &Positions| {
        let input = EvaluationInput {
            triangulation: &Triangulation::new(&mesh, &rest),
            rest: &rest,
            draped,
            target: &target,
            landmarks: &[],
            truth: None,
        };
        evaluate(input, &CONFIG).unwrap_err()
    };
    let short = Positions::new(3, Point3::origin());
    assert_eq!(
        judge(&short),
        EvaluateError::VertexCount {
            positions: "draped positions",
            found: 3,
            expected: 9
        }
    );
    let mut broken = rest.clone();
    broken[VertexId::new(4)].y = f64::NAN;
    assert_eq!(
        judge(&broken),
        EvaluateError::NonFiniteCoordinate {
            positions: "draped positions",
            vertex: 4
        }
    );
    let flat = PolygonSoup {
        positions: vec![Point3::origin()],
        faces: vec![vec![0, 0, 0]],
    };
    let (mesh, rest) = flat.into_halfedge().unwrap();
    let input = EvaluationInput {
        triangulation: &Triangulation::new(&mesh, &rest),
        rest: &rest,
        draped: &rest,
        target: &target,
        landmarks: &[],
        truth: None,
    };
    assert_eq!(
        evaluate(input, &CONFIG).unwrap_err(),
        EvaluateError::NoTriangles
    );
}

#[test]
fn collapsed_result_scores_nothing_and_breaks_nothing() {
    let report = judge(shapes::quad_sphere(3), shapes::quad_sphere(3), |_| {
        Point3::origin()
    });
    assert_eq!(report.dirichlet, f64::INFINITY);
    assert_eq!(report.q_transfer, 0.0);
    assert_eq!(report.defects.skinny_new, 2 * 6 * 9);
    assert!(report.hausdorff.is_finite());
}
