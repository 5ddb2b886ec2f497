//! Weights of pairs and the farthest of them, by figures that can be worked out by hand.

use std::sync::Arc;

use mesh_core::sampling::SeededRng;
use mesh_core::{
    shapes, Point3, Positions, Profile, TargetSurface, TriangleSoup, Triangulation, Vector3,
    VertexData, VertexId,
};
use mesh_loss::{
    Chamfer, Loss, Matches, Overlap, SamplingConfig, SurfaceMatch, SurfaceMatcher, WorstDistance,
};

use crate::finite_differences::UNIT;

/// Weights of the pairs between a plane and the same plane turned by `degrees`.
fn weights(degrees: f64, normal_bias: Option<f64>) -> Vec<f64> {
    let (mesh, rest) = shapes::open_grid(4, 4)
        .into_halfedge()
        .expect("a grid is a mesh");
    let triangulation = Arc::new(Triangulation::new(&mesh, &rest));
    let turn = nalgebra::Rotation3::from_axis_angle(&Vector3::x_axis(), degrees.to_radians());
    let target: Arc<dyn TargetSurface> =
        Arc::new(TriangleSoup::new(shapes::open_grid(4, 4)).expect("a grid is a target"));
    let x = rest.map(|p| turn * p);
    let config = SamplingConfig {
        n_samples: 50,
        face_uniform: 0.5,
        normal_bias,
        n_hard: 0,
        overlap: Overlap::default(),
        mutual: 1.0,
    };
    let mut matcher = SurfaceMatcher::new(&triangulation, &x, &target, UNIT);
    let mut rng = SeededRng::new(1);
    let matches = matcher.resample(&x, &config, &mut rng, &mut Profile::off());
    let pairs = matches.to_target.iter().chain(&matches.to_mesh);
    pairs.map(|pair| pair.weight).collect()
}

#[test]
fn a_pair_counts_by_the_cosine_of_its_normals_and_the_bias() {
    let cases = [
        (0.0, Some(0.3), 1.0),
        (60.0, Some(0.3), 0.8),
        (60.0, Some(0.0), 0.5),
        (60.0, Some(-0.2), 0.3),
        (60.0, Some(-2.0), 0.05),
        (60.0, None, 1.0),
    ];
    for (degrees, bias, expected) in cases {
        let weights = weights(degrees, bias);
        assert_eq!(weights.len(), 100);
        for weight in weights {
            assert!((weight - expected).abs() < 1e-12, "{degrees}°: {weight}");
        }
    }
}

/// Triangles that lie apart, and pairs of their first corners with points that far above.
fn apart(distances: &[f64], hard: &[f64]) -> (Positions, Matches) {
    let all = distances.len() + hard.len();
    let corners = (0..all).flat_map(|k| {
        let at = |dx: f64, dy: f64| Point3::new(3.0 * k as f64 + dx, dy, 0.0);
        [at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0)]
    });
    let x: Positions = corners.collect();
    let pair = |(k, &distance): (usize, &f64)| SurfaceMatch {
        triangle: [0, 1, 2].map(|c| VertexId::new(3 * k + c)),
        barycentric: [1.0, 0.0, 0.0],
        point: x[VertexId::new(3 * k)] - Vector3::z() * distance,
        normal: None,
        weight: 0.5,
        is_on_boundary: false,
    };
    let rows = distances.iter().chain(hard).enumerate();
    let mut pairs: Vec<SurfaceMatch> = rows.map(pair).collect();
    let hard = pairs.split_off(distances.len());
    let matches = Matches {
        to_target: pairs,
        hard_to_target: hard,
        ..Matches::default()
    };
    (x, matches)
}

/// The value, and the gradient at the first corner of each triangle, along z.
fn value_and_pull(loss: &dyn Loss, x: &Positions) -> (f64, Vec<f64>) {
    let mut gradient = VertexData::new(x.len(), Vector3::zeros());
    let value = loss.accumulate(x, 1.0, &mut gradient);
    let pulls = gradient.iter().step_by(3).map(|g| g.z);
    (value, pulls.collect())
}

#[test]
fn the_worst_distance_is_the_mean_of_the_largest_rounded_up_in_number() {
    let (x, matches) = apart(&[1.0, 4.0, 2.0, 3.0], &[]);
    let worst = |share: f64, tolerance: f64| {
        let loss = WorstDistance {
            matches: &matches,
            share,
            tolerance,
        };
        value_and_pull(&loss, &x)
    };
    // ⌈0.3 · 4⌉ = 2 of 4: the distances 4 and 3. The weights of the pairs do not count.
    assert_eq!(worst(0.3, 0.0), (3.5, vec![0.0, 0.5, 0.0, 0.5]));
    assert_eq!(worst(0.25, 0.0), (4.0, vec![0.0, 1.0, 0.0, 0.0]));
    assert_eq!(worst(0.01, 0.0), (4.0, vec![0.0, 1.0, 0.0, 0.0]));
    assert_eq!(worst(1.0, 0.0), (2.5, vec![0.25; 4]));
    assert_eq!(worst(0.0, 0.0), (0.0, vec![0.0; 4]));
}

#[test]
fn distances_within_the_tolerance_neither_count_nor_pull() {
    let (x, matches) = apart(&[1.0, 4.0, 2.0, 3.0], &[]);
    let loss = WorstDistance {
        matches: &matches,
        share: 1.0,
        tolerance: 2.5,
    };
    // The excesses 1.5 and 0.5, over all four.
    assert_eq!(value_and_pull(&loss, &x), (0.5, vec![0.0, 0.25, 0.0, 0.25]));
}

#[test]
fn corners_kept_in_mind_compete_with_the_samples_without_adding_to_their_number() {
    let (x, matches) = apart(&[1.0, 4.0, 2.0, 3.0], &[5.0, 0.5]);
    let loss = WorstDistance {
        matches: &matches,
        share: 0.5,
        tolerance: 0.0,
    };
    let expected = (4.5, vec![0.0, 0.5, 0.0, 0.0, 0.5, 0.0]);
    assert_eq!(value_and_pull(&loss, &x), expected);
}

#[test]
fn the_chamfer_distance_is_the_weighted_mean_of_the_distances() {
    let (x, matches) = apart(&[1.0, 4.0, 0.0, 3.0], &[9.0]);
    // Weights of a half, four pairs; the far corner does not count, the pair at distance 0 does not pull.
    let expected = (1.0, vec![0.125, 0.125, 0.0, 0.125, 0.0]);
    assert_eq!(value_and_pull(&Chamfer(&matches), &x), expected);
}
