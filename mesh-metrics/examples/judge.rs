//! Judges a result: a ball laid over an ellipsoid, exactly but for one dent.
#![allow(clippy::print_stdout, reason = "an example tells what it found")]

use std::error::Error;

use mesh_metrics::mesh_core::{shapes, Landmark, Point3, TriangleSoup, Triangulation, VertexId};
use mesh_metrics::{evaluate, EvaluationConfig, EvaluationInput};

fn main() -> Result<(), Box<dyn Error>> {
    let stretched = |p: &Point3| Point3::new(2.0 * p.x, p.y, p.z);
    let mut soup = shapes::icosphere(5);
    soup.positions.iter_mut().for_each(|p| *p = stretched(p));
    let target = TriangleSoup::new(soup)?;

    // Where every vertex belongs, and where the result has it: one is a tenth of its radius too low.
    let (mesh, rest) = shapes::quad_sphere(24).into_halfedge()?;
    let truth = rest.map(stretched);
    let mut draped = truth.clone();
    let dent = VertexId::new(1000);
    draped[dent] *= 0.9;

    let input = EvaluationInput {
        triangulation: &Triangulation::new(&mesh, &rest),
        rest: &rest,
        draped: &draped,
        target: &target,
        landmarks: &[Landmark::new(dent, truth[dent])],
        truth: Some(&truth),
    };
    let report = evaluate(input, &EvaluationConfig::standard())?;
    println!("{report}");

    // Lengths are in longest sides of the target's box, which is 4 long.
    let depth = (truth[dent] - draped[dent]).norm() / 4.0;
    let landmarks = report.landmarks.as_ref().expect("there is a landmark");
    assert!((landmarks.max - depth).abs() < 1e-12);
    assert!(report.truth.is_some_and(|t| (t.max - depth).abs() < 1e-12));
    // The dented vertex is no farther from the ellipsoid than from where it belongs.
    assert!(report.hausdorff > 0.4 * depth && report.hausdorff < 1.01 * depth);
    assert_eq!(report.defects.folds, 0);
    println!("a dent of {depth:.4}: Hausdorff {:.4}", report.hausdorff);
    Ok(())
}
