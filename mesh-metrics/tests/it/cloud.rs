//! Point clouds as targets.

use mesh_core::{shapes, PointCloud, Triangulation};
use mesh_metrics::{evaluate, EvaluationConfig, EvaluationInput, TargetKind};

#[test]
fn a_cloud_of_the_own_vertices() {
    let soup = shapes::quad_sphere(8);
    let cloud = PointCloud::new(soup.positions.clone(), None).unwrap();
    let (mesh, rest) = soup.into_halfedge().unwrap();
    let input = EvaluationInput {
        triangulation: &Triangulation::new(&mesh, &rest),
        rest: &rest,
        draped: &rest,
        target: &cloud,
        landmarks: &[],
        truth: None,
    };
    let report = evaluate(
        input,
        &EvaluationConfig {
            n_samples: 5_000,
            seed: 1,
        },
    )
    .unwrap();

    assert_eq!(report.target_kind, TargetKind::Cloud);
    // Every point of the cloud lies on the mesh; points of the mesh are up to half a quad from the nearest.
    assert!(report.to_draped.max < 1e-12);
    let half_diagonal = 0.5 * 2f64.sqrt() * (std::f64::consts::FRAC_PI_4 / 4.0).tan() / 2.0;
    assert!(
        report.to_target.max > 0.5 * half_diagonal && report.to_target.max < 1.5 * half_diagonal
    );
    assert!(report.to_string().contains("point cloud"));
}
