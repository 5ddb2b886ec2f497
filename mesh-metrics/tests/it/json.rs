//! A report as JSON.

use mesh_core::{shapes, TriangleSoup, Triangulation};
use mesh_metrics::{evaluate, EvaluationConfig, EvaluationInput};

#[test]
fn names_faces_by_row_and_leaves_the_heat_maps_out() {
    let mut inside_out = shapes::prism(5);
    inside_out.faces.iter_mut().for_each(|f| f.reverse());
    let (mesh, rest) = inside_out.into_halfedge().unwrap();
    let target = TriangleSoup::new(shapes::prism(5)).unwrap();
    let input = EvaluationInput {
        triangulation: &Triangulation::new(&mesh, &rest),
        rest: &rest,
        draped: &rest,
        target: &target,
        landmarks: &[],
        truth: None,
    };
    let config = EvaluationConfig {
        n_samples: 100,
        seed: 0,
    };
    let json = serde_json::to_value(evaluate(input, &config).unwrap()).unwrap();

    assert_eq!(
        json["places"]["opposed"],
        serde_json::json!([0, 1, 2, 3, 4, 5, 6])
    );
    assert_eq!(json["target_kind"], "surface");
    assert_eq!(json["defects"]["folds"], 0);
    assert!(json["landmarks"].is_null() && json.get("vertex_distances").is_none());
}
