use mesh_core::{Aabb, Point3, UnitFrame, Vector3};
use mesh_init::{fit_affine, AffineKind, FramePair, PointPair, SimilarityPrior};
use nalgebra::{Matrix3, Rotation3};
use proptest::prelude::*;

const PRIORS: [SimilarityPrior; 2] = [SimilarityPrior::None, SimilarityPrior::LeaveOneOut];

fn pairs(sources: &[[f64; 3]], map: impl Fn(&Point3) -> Point3) -> Vec<PointPair> {
    let pair = |&s: &[f64; 3]| PointPair::new(Point3::from(s), map(&Point3::from(s)));
    sources.iter().map(pair).collect()
}

fn frames(pairs: &[PointPair]) -> FramePair {
    FramePair {
        source: UnitFrame::of(Aabb::of(pairs.iter().map(|p| &p.source))),
        target: UnitFrame::of(Aabb::of(pairs.iter().map(|p| &p.target))),
    }
}

const CORNERS: [[f64; 3]; 6] = [
    [0., 0., 0.],
    [2., 0., 0.],
    [0., 1., 0.],
    [0., 0., 1.],
    [1., 1., 1.],
    [2., 1., 0.5],
];

proptest! {
    /// Millimetres onto metres, far from the origin: none of it may matter.
    #[test]
    fn any_affine_map_is_recovered(
        entries in proptest::array::uniform9(-1.0..1.0f64), shift in -1e4..1e4f64, scale in prop::sample::select(vec![1e-3, 1.0, 1e3]),
    ) {
        let linear = (Matrix3::from_row_slice(&entries) + Matrix3::identity() * 2.0) * scale;
        let map = |p: &Point3| Point3::from(linear * p.coords + Vector3::new(shift, -shift, 1.0));
        let pairs = pairs(&CORNERS, map);
        for prior in PRIORS {
            let fit = fit_affine(&pairs, frames(&pairs), prior);
            prop_assert_eq!(fit.kind, AffineKind::Affine);
            // 1e4 away from the origin, coordinates hold 1e-12 of a unit; the map multiplies that by its condition.
            prop_assert!((fit.matrix - linear).norm() < 1e-8 * (scale + 1e-3), "{} {}", fit.matrix, linear);
            prop_assert!(fit.residuals.iter().all(|r| *r < 1e-8 * (1.0 + scale)));
        }
    }
}

#[test]
fn fewer_landmarks_determine_less() {
    let turn = Rotation3::from_euler_angles(0.4, -0.8, 2.5);
    let map = |p: &Point3| turn * p * 3.0 + Vector3::new(5.0, 6.0, 7.0);
    let kinds = [
        AffineKind::Bounds,
        AffineKind::Translation,
        AffineKind::SimilarityOfLine,
        AffineKind::Similarity,
        AffineKind::Affine,
    ];
    let whole = frames(&pairs(&CORNERS, map));
    for prior in PRIORS {
        for (n, kind) in kinds.into_iter().enumerate() {
            let pairs = pairs(&CORNERS[..n], map);
            let fit = fit_affine(&pairs, whole, prior);
            assert_eq!(fit.kind, kind);
            assert!(!fit.is_mirroring());
            assert!(
                fit.residuals.iter().all(|r| *r < 1e-9),
                "{kind:?}: {:?}",
                fit.residuals
            );
            if n >= 3 {
                assert!((fit.matrix - turn.matrix() * 3.0).norm() < 1e-9, "{kind:?}");
            }
        }
    }
}

#[test]
fn without_a_landmark_the_boxes_match() {
    let frames = FramePair {
        source: UnitFrame::of(Aabb {
            min: Point3::new(0., 0., 0.),
            max: Point3::new(2., 1., 1.),
        }),
        target: UnitFrame::of(Aabb {
            min: Point3::new(10., 10., 10.),
            max: Point3::new(11., 14., 12.),
        }),
    };
    let fit = fit_affine(&[], frames, SimilarityPrior::None);
    assert_eq!(fit.apply(&frames.source.center), frames.target.center);
    assert_eq!(fit.matrix, Matrix3::identity() * 2.0);
}

#[test]
fn landmarks_in_a_plane_stay_a_similarity_with_noise_across_it() {
    let flat: Vec<[f64; 3]> = (0..5)
        .map(|k| {
            [
                (k as f64).cos(),
                (k as f64 * 1.7).sin(),
                1e-4 * (k as f64 * 9.0).sin(),
            ]
        })
        .collect();
    let noise = |p: &Point3| {
        p + Vector3::new(
            0.02 * (50.0 * p.y).sin(),
            0.02 * (40.0 * p.x).cos(),
            0.03 * (30.0 * p.x).sin(),
        )
    };
    let pairs = pairs(&flat, noise);
    let fit = fit_affine(&pairs, frames(&pairs), SimilarityPrior::LeaveOneOut);
    let stretch = fit.matrix.singular_values();
    assert!(stretch.min() > 0.7 && stretch.max() < 1.4, "{stretch}");
    assert!(!fit.is_mirroring());
}

#[test]
fn a_mirrored_map_says_so_unless_held_to_a_similarity() {
    let mirrored = pairs(&CORNERS, |p| Point3::new(-p.x, p.y, p.z));
    assert!(fit_affine(&mirrored, frames(&mirrored), SimilarityPrior::None).is_mirroring());
}

#[test]
fn coincident_landmarks_neither_collapse_nor_blow_up_the_map() {
    let same_target = pairs(&CORNERS, |_| Point3::new(1.0, 2.0, 3.0));
    let boxes = frames(&pairs(&CORNERS, |p| p * 2.0));
    let fit = fit_affine(&same_target, boxes, SimilarityPrior::None);
    assert_eq!(
        (fit.kind, fit.matrix),
        (AffineKind::Translation, Matrix3::identity() * 2.0)
    );
    let same_source = pairs(&[[1.0; 3]; 4], |p| *p);
    assert_eq!(
        fit_affine(&same_source, boxes, SimilarityPrior::None).kind,
        AffineKind::Translation
    );
}

#[test]
fn a_reversed_line_turns_by_half() {
    let reversed = pairs(&[[0., 0., 0.], [2., 0., 0.]], |p| {
        Point3::new(-p.x, p.y, p.z)
    });
    let fit = fit_affine(&reversed, frames(&reversed), SimilarityPrior::None);
    assert!(fit.residuals.iter().all(|r| *r < 1e-12));
    assert!((fit.matrix.determinant() - 1.0).abs() < 1e-12);
}

/// Without one of four landmarks the other three lie in a plane and give the same similarity under every prior, so that all
/// priors predict alike: the strongest is taken. A weaker one would stretch the map to the last bit of the landmarks' noise.
#[test]
fn of_priors_that_predict_alike_the_strongest_is_taken() {
    let stretched = |p: &Point3| Point3::new(1.3 * p.x, 0.8 * p.y, 1.1 * p.z);
    let pairs = pairs(&CORNERS[..4], stretched);
    let fit = fit_affine(&pairs, frames(&pairs), SimilarityPrior::LeaveOneOut);
    assert_eq!(fit.kind, AffineKind::Affine);
    let stretch = fit.matrix.singular_values();
    assert!(stretch.max() - stretch.min() < 1e-12, "{stretch}");
    let free = fit_affine(&pairs, frames(&pairs), SimilarityPrior::None);
    assert!(free.residuals.iter().all(|r| *r < 1e-12));
    assert!(fit.residuals.iter().all(|r| *r > 1e-2));
}
