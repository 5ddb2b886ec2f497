//! Each analytic gradient equals central differences in f64, on triangles and polygons, closed and open shapes.

use std::sync::Arc;

use mesh_core::sampling::SeededRng;
use mesh_core::{
    shapes, Landmark, MeshPoint, Point3, PolygonSoup, Positions, Profile, TargetSurface,
    TriangleSoup, Triangulation, UnitFrame, Vector3, VertexData, VertexId,
};
use mesh_loss::{
    AreaKl, Chamfer, Conformal, Contact, ContactPair, CornerAngle, Drift, Flip, FoldBarrier,
    LandmarkDistance, LocalShape, Loss, Matches, NormalAgreement, SamplingConfig, SmoothChange,
    SurfaceMatcher, TriangleQuality, WorstDistance,
};
use proptest::prelude::*;

/// Step of the central differences: its error, h² times a third derivative, is about 1e-10 here.
const STEP: f64 = 1e-5;

/// The frame whose coordinates are those of the target.
pub(crate) const UNIT: UnitFrame = UnitFrame {
    center: Point3::new(0.0, 0.0, 0.0),
    scale: 1.0,
};

pub(crate) fn all_shapes() -> Vec<PolygonSoup> {
    vec![
        shapes::icosphere(1),
        shapes::quad_sphere(2),
        shapes::prism(7),
        shapes::open_grid(3, 2),
        shapes::cone(6),
    ]
}

pub(crate) struct Setup {
    pub(crate) triangulation: Arc<Triangulation>,
    pub(crate) rest: Positions,
    pub(crate) moved: Positions,
    pub(crate) rng: SeededRng,
}

/// A shape at rest and a random deformation of it.
pub(crate) fn setup(shape: usize, seed: u64, amount: f64) -> Setup {
    let soup = all_shapes().swap_remove(shape);
    let (mesh, rest) = soup.into_halfedge().expect("a shape is a mesh");
    let triangulation = Arc::new(Triangulation::new(&mesh, &rest));
    let mut rng = SeededRng::new(seed);
    let moved = rest.map(|p| p + random_vector(&mut rng) * amount);
    Setup {
        triangulation,
        rest,
        moved,
        rng,
    }
}

fn random_vector(rng: &mut SeededRng) -> Vector3 {
    Vector3::from_fn(|_, _| rng.uniform_in(-1.0..1.0))
}

/// Directional derivatives along random directions. A kink, or a curvature too strong for the step, shows as a
/// difference between the quotients of two steps; such a direction tells nothing and is passed over.
fn assert_gradient(
    loss: &dyn Loss,
    x: &Positions,
    rng: &mut SeededRng,
) -> Result<(), TestCaseError> {
    let value_at =
        |x: &Positions| loss.accumulate(x, 1.0, &mut VertexData::new(x.len(), Vector3::zeros()));
    let mut gradient = VertexData::new(x.len(), Vector3::zeros());
    let value = loss.accumulate(x, 3.0, &mut gradient);
    for _ in 0..4 {
        let direction: Vec<Vector3> = (0..x.len()).map(|_| random_vector(rng)).collect();
        let quotient = |h: f64| {
            let [ahead, behind] = [h, -h].map(|h| {
                let shifted = x.iter().zip(&direction).map(|(p, d)| p + d * h);
                value_at(&shifted.collect())
            });
            (ahead - behind) / (2.0 * h)
        };
        let (numeric, finer) = (quotient(STEP), quotient(STEP / 4.0));
        let tolerance = 1e-6 * (1.0 + numeric.abs() + value.abs());
        if (numeric - finer).abs() > 0.3 * tolerance {
            continue;
        }
        let along = gradient.iter().zip(&direction).map(|(g, d)| g.dot(d));
        let analytic = along.sum::<f64>() / 3.0;
        prop_assert!(
            (numeric - analytic).abs() <= tolerance,
            "central difference {numeric}, gradient {analytic}"
        );
    }
    Ok(())
}

fn matches(s: &mut Setup, normal_bias: Option<f64>) -> Matches {
    let target = TriangleSoup::new(shapes::icosphere(2)).expect("a sphere is a target");
    let target: Arc<dyn TargetSurface> = Arc::new(target);
    let config = SamplingConfig {
        n_samples: 40,
        face_uniform: 0.5,
        normal_bias,
        n_hard: 20,
        overlap: mesh_loss::Overlap::default(),
        mutual: 0.7,
    };
    SurfaceMatcher::new(&s.triangulation, &s.moved, &target, UNIT).resample(
        &s.moved,
        &config,
        &mut s.rng,
        &mut Profile::off(),
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn structural_terms(shape in 0..5usize, seed in 0..10_000u64) {
        let mut s = setup(shape, seed, 0.1);
        let (t, x) = (&s.triangulation, &s.moved);
        let terms: [&dyn Loss; 9] = [
            &CornerAngle::new(t, &s.rest),
            &AreaKl::new(t, &s.rest),
            &TriangleQuality::new(t, 0.9),
            &Flip::new(t, &s.rest),
            &FoldBarrier::new(t, &s.rest, 0.95),
            &Conformal::new(t, &s.rest),
            &Drift::new(t, &s.rest),
            &SmoothChange::new(t, &s.rest),
            &LocalShape::new(t, &s.rest),
        ];
        for term in terms {
            assert_gradient(term, x, &mut s.rng)?;
        }
    }

    #[test]
    fn distance_terms(shape in 0..5usize, seed in 0..10_000u64) {
        let mut s = setup(shape, seed, 0.1);
        let pairs = matches(&mut s, Some(0.3));
        let worst = WorstDistance { matches: &pairs, share: 0.1, tolerance: 0.02 };
        let terms: [&dyn Loss; 3] = [&Chamfer(&pairs), &worst, &NormalAgreement(&pairs)];
        for term in terms {
            assert_gradient(term, &s.moved, &mut s.rng)?;
        }
    }

    #[test]
    fn contact(shape in 0..5usize, seed in 0..10_000u64) {
        let mut s = setup(shape, seed, 0.2);
        // Every vertex with a triangle that it is no corner of, on either side.
        let triangles = s.triangulation.triangles();
        let pairs = s.triangulation.vertices().filter_map(|vertex| {
            let triangle = *triangles.iter().find(|t| !t.contains(&vertex))?;
            let side = if vertex.index() % 2 == 0 { 1.0 } else { -1.0 };
            Some(ContactPair { vertex, triangle, side, gap: 0.9, share: 0.3 })
        });
        let contact = Contact { pairs: pairs.collect() };
        assert_gradient(&contact, &s.moved, &mut s.rng)?;
    }

    #[test]
    fn landmarks(seed in 0..10_000u64) {
        let mut s = setup(0, seed, 0.1);
        let corners = s.triangulation.triangles()[3];
        let mut inside = Landmark::new(VertexId::new(0), Point3::new(0.3, 0.2, 0.1));
        inside.source = MeshPoint::barycentric(corners, [0.2, 0.3, 0.5]);
        inside.weight = 0.3;
        let pairs = [Landmark::new(VertexId::new(5), Point3::new(1.0, 2.0, 3.0)), inside];
        assert_gradient(&LandmarkDistance(&pairs), &s.moved, &mut s.rng)?;
    }
}
