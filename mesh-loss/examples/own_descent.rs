//! A gradient descent of your own on the terms of this crate: a sphere of quads is laid over an ellipsoid.
//!
//! `cargo run --release -p mesh-loss --example own_descent`
//!
//! The loss is Eq. 1 of the paper, `L = L_d + λ L_s`: Chamfer distance and one landmark, then corner angles and areas.
//! The descent is the plainest there is: a step along the gradient, by a rate that falls to 0.

use std::error::Error;
use std::sync::Arc;

use mesh_loss::mesh_core::sampling::SeededRng;
use mesh_loss::mesh_core::{
    shapes, Landmark, Point3, Positions, Profile, TargetSurface, TriangleSoup, Triangulation,
    UnitFrame, Vector3, VertexData, VertexId,
};
use mesh_loss::{
    AreaKl, Chamfer, CornerAngle, LandmarkDistance, Loss, Overlap, SamplingConfig, SurfaceMatcher,
};

const N_ITERATIONS: usize = 300;
/// λ of Eq. 1.
const LAMBDA: f64 = 0.02;
/// Weight of the landmark: as much as that of a dozen vertices in the Chamfer distance.
const LANDMARK: f64 = 0.1;
/// The first rate for each vertex. Means share their gradients out over all vertices.
const FIRST_RATE: f64 = 0.02;
/// Samples on each side, drawn anew in every iteration; all pairs count alike.
const SAMPLING: SamplingConfig = SamplingConfig {
    n_samples: 2000,
    face_uniform: 0.5,
    normal_bias: None,
    n_hard: 0,
    overlap: Overlap {
        target_exceeds: false,
        mesh_exceeds: false,
    },
    mutual: 1.0,
};

fn main() -> Result<(), Box<dyn Error>> {
    let (mesh, rest) = shapes::quad_sphere(12).into_halfedge()?;
    let triangulation = Arc::new(Triangulation::new(&mesh, &rest));
    let target = ellipsoid()?;
    // The vertex nearest to the longest axis belongs at its end.
    let tip = rest.ids().max_by(|&v, &w| rest[v].x.total_cmp(&rest[w].x));
    let tip = tip.unwrap_or(VertexId::new(0));
    let landmarks = [Landmark::new(tip, Point3::new(1.0, 0.0, 0.0))];

    let angles = CornerAngle::new(&triangulation, &rest);
    let areas = AreaKl::new(&triangulation, &rest);
    // Mesh and target live in the same coordinates here.
    let frame = UnitFrame {
        center: Point3::origin(),
        scale: 1.0,
    };
    let mut matcher = SurfaceMatcher::new(&triangulation, &rest, &target, frame);
    let mut rng = SeededRng::new(0);

    let mut x = rest.clone();
    let before = mean_distance(&x, target.as_ref());
    for iteration in 0..N_ITERATIONS {
        let matches = matcher.resample(&x, &SAMPLING, &mut rng, &mut Profile::off());
        let terms: [(f64, &dyn Loss); 4] = [
            (1.0, &Chamfer(&matches)),
            (LANDMARK, &LandmarkDistance(&landmarks)),
            (LAMBDA, &angles),
            (LAMBDA, &areas),
        ];
        let mut gradient = VertexData::new(x.len(), Vector3::zeros());
        for (weight, term) in terms {
            term.accumulate(&x, weight, &mut gradient);
        }
        let left = 1.0 - iteration as f64 / N_ITERATIONS as f64;
        let rate = FIRST_RATE * left * x.len() as f64;
        for (p, g) in x.iter_mut().zip(&gradient) {
            *p -= g * rate;
        }
    }

    let after = mean_distance(&x, target.as_ref());
    let miss = (x[tip] - landmarks[0].target).norm();
    assert!(after < 0.1 * before, "mean distance {before} to {after}");
    assert!(miss < 0.05, "the landmark is missed by {miss}");
    Ok(())
}

/// Half axes 1, 0.7 and 0.5.
fn ellipsoid() -> Result<Arc<dyn TargetSurface>, Box<dyn Error>> {
    let mut soup = shapes::icosphere(4);
    for p in &mut soup.positions {
        *p = Point3::new(p.x, 0.7 * p.y, 0.5 * p.z);
    }
    Ok(Arc::new(TriangleSoup::new(soup)?))
}

/// Mean distance of the vertices to the target.
fn mean_distance(x: &Positions, target: &dyn TargetSurface) -> f64 {
    let hits = target.closest_points(x.as_slice());
    hits.iter().map(|h| h.distance_squared.sqrt()).sum::<f64>() / x.len() as f64
}
