//! Values in closed form: 0 at rest, invariances, bounds.

use std::sync::Arc;

use mesh_core::sampling::SeededRng;
use mesh_core::{
    shapes, Point3, Positions, Profile, TargetSurface, TriangleSoup, Triangulation, Vector3,
    VertexData,
};
use mesh_loss::{
    AreaKl, Chamfer, Conformal, CornerAngle, Drift, Flip, FoldBarrier, LocalShape, Loss,
    SamplingConfig, SmoothChange, SurfaceMatcher, TriangleQuality, WorstDistance,
};
use proptest::prelude::*;

use crate::finite_differences::{all_shapes, setup, UNIT};

fn value_and_gradient(loss: &dyn Loss, x: &Positions) -> (f64, f64) {
    let mut gradient = VertexData::new(x.len(), Vector3::zeros());
    let value = loss.accumulate(x, 1.0, &mut gradient);
    (value, gradient.iter().map(Vector3::norm).sum())
}

#[test]
fn structural_terms_and_their_gradients_vanish_at_rest() {
    for shape in 0..all_shapes().len() {
        let s = setup(shape, 1, 0.0);
        let t = &s.triangulation;
        let terms: [&dyn Loss; 9] = [
            &CornerAngle::new(t, &s.rest),
            &AreaKl::new(t, &s.rest),
            &TriangleQuality::new(t, 0.1),
            &Flip::new(t, &s.rest),
            &FoldBarrier::new(t, &s.rest, 0.3),
            &Conformal::new(t, &s.rest),
            &Drift::new(t, &s.rest),
            &SmoothChange::new(t, &s.rest),
            &LocalShape::new(t, &s.rest),
        ];
        for (row, term) in terms.into_iter().enumerate() {
            let (value, gradient) = value_and_gradient(term, &s.rest);
            assert!(
                value.abs() < 1e-12,
                "shape {shape}, term {row}: value {value}"
            );
            assert!(
                gradient < 1e-7,
                "shape {shape}, term {row}: gradient {gradient}"
            );
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn angle_area_and_conformal_terms_ignore_similarities(shape in 0..5usize, seed in 0..1000u64, scale in 0.1..10.0f64, turn in 0.0..3.0f64) {
        let s = setup(shape, seed, 0.1);
        let rotation = nalgebra::Rotation3::new(Vector3::new(0.3, -0.5, 0.8) * turn);
        let copy = s.moved.map(|p| rotation * Point3::from(p.coords * scale) + Vector3::new(3.0, -2.0, 1.0));
        let t = &s.triangulation;
        let terms: [&dyn Loss; 5] = [
            &CornerAngle::new(t, &s.rest),
            &AreaKl::new(t, &s.rest),
            &TriangleQuality::new(t, 0.9),
            &Conformal::new(t, &s.rest),
            &LocalShape::new(t, &s.rest),
        ];
        for term in terms {
            let (a, b) = (value_and_gradient(term, &s.moved).0, value_and_gradient(term, &copy).0);
            prop_assert!(a >= -1e-12);
            prop_assert!((a - b).abs() <= 1e-9 * (1.0 + a.abs()), "{a} against {b}");
        }
    }
}

#[test]
fn chamfer_of_a_shifted_plane_is_the_shift() {
    let (mesh, rest) = shapes::open_grid(4, 4).into_halfedge().unwrap();
    let triangulation = Arc::new(Triangulation::new(&mesh, &rest));
    let target: Arc<dyn TargetSurface> =
        Arc::new(TriangleSoup::new(shapes::open_grid(4, 4)).unwrap());
    let shifted = rest.map(|p| p + Vector3::z() * 0.25);
    let config = SamplingConfig {
        n_samples: 100,
        face_uniform: 0.5,
        normal_bias: None,
        n_hard: 20,
        overlap: mesh_loss::Overlap::default(),
        mutual: 0.7,
    };
    let mut rng = SeededRng::new(3);
    let matches = SurfaceMatcher::new(&triangulation, &shifted, &target, UNIT).resample(
        &shifted,
        &config,
        &mut rng,
        &mut Profile::off(),
    );
    assert!((value_and_gradient(&Chamfer(&matches), &shifted).0 - 0.5).abs() < 1e-12);
    let worst = WorstDistance {
        matches: &matches,
        share: 0.05,
        tolerance: 0.0,
    };
    assert!((value_and_gradient(&worst, &shifted).0 - 0.5).abs() < 1e-12);
}

#[test]
fn half_turned_pair_of_faces_is_stopped_by_the_barrier() {
    let (mesh, rest) = shapes::open_grid(2, 1).into_halfedge().unwrap();
    let triangulation = Arc::new(Triangulation::new(&mesh, &rest));
    let mut folded = rest.clone();
    for p in folded.iter_mut().filter(|p| p.x == 2.0) {
        p.x = 0.5;
        p.z = 0.1;
    }
    let barrier = FoldBarrier::new(&triangulation, &rest, 0.3);
    assert_eq!(value_and_gradient(&barrier, &rest).0, 0.0);
    let (value, gradient) = value_and_gradient(&barrier, &folded);
    assert!(value > 0.1 && gradient > 0.1);
}

#[test]
fn folds_of_thin_faces_pull_no_harder_than_others() {
    let steepest = |height: f64| {
        let (mesh, mut rest) = shapes::open_grid(8, 8).into_halfedge().unwrap();
        for p in rest.iter_mut().filter(|p| p.x > 4.0) {
            p.x += height - 1.0;
        }
        let triangulation = Arc::new(Triangulation::new(&mesh, &rest));
        let mut folded = rest.clone();
        for p in folded.iter_mut().filter(|p| p.x > 4.0) {
            p.x = 8.0 - p.x;
            p.z = 0.3 * (4.0 - p.x);
        }
        let mut gradient = VertexData::new(rest.len(), Vector3::zeros());
        FoldBarrier::new(&triangulation, &rest, 0.3).accumulate(&folded, 1.0, &mut gradient);
        gradient.iter().map(Vector3::norm).fold(0.0, f64::max)
    };
    let ordinary = steepest(1.0);
    let thin = steepest(0.1);
    assert!(ordinary > 0.0 && thin < 8.0 * ordinary);
    for height in [0.03, 0.01, 0.001] {
        assert!(steepest(height) < 1.1 * thin, "{height}");
    }
}
