//! A target that is only a part of what the source shows.

use std::sync::Arc;

use mesh_core::measure::corner_angle;
use mesh_core::{shapes, Positions, TargetSurface, TriangleSoup, VertexId};
use neural_drape::{Drape, DrapeConfig, DrapeInput, OverlapMode};

use crate::setup::{on_ellipsoid, run, short, Pair};

/// The ellipsoid, with a hole where it is highest.
fn holed() -> Arc<dyn TargetSurface> {
    let mut soup = shapes::icosphere(3);
    let is_low = |f: &Vec<u32>| f.iter().all(|&v| soup.positions[v as usize].z < 0.6);
    soup.faces = soup.faces.iter().filter(|f| is_low(f)).cloned().collect();
    soup.positions.iter_mut().for_each(|p| *p = on_ellipsoid(p));
    Arc::new(TriangleSoup::new(soup).expect("a shape with a hole"))
}

/// A short run over a target that is a part.
fn over_part<'a>(
    pair: &'a Pair,
    target: &'a Arc<dyn TargetSurface>,
    n_iterations: usize,
) -> (DrapeInput<'a>, DrapeConfig) {
    let input = DrapeInput {
        target,
        ..pair.input()
    };
    let mut config = short("standard", n_iterations);
    config.overlap = OverlapMode::TargetPartial;
    (input, config)
}

/// Mean change of the corner angles of the triangles all of whose corners are in `part`, in degrees.
fn angle_change(pair: &Pair, x: &Positions, part: &[VertexId]) -> f64 {
    let triangles = pair.triangulation.triangles().iter();
    let inside = triangles.filter(|t| t.iter().all(|v| part.contains(v)));
    let changes: Vec<f64> = inside
        .flat_map(|&[a, b, c]| [[a, b, c], [b, c, a], [c, a, b]])
        .map(|[a, b, c]| {
            let at = |x: &Positions| corner_angle(x[a], x[b], x[c]);
            (at(x) - at(&pair.initial)).abs().to_degrees()
        })
        .collect();
    changes.iter().sum::<f64>() / changes.len() as f64
}

#[test]
fn what_lies_over_a_hole_keeps_its_initial_shape_and_closes_it() {
    let pair = Pair::new(shapes::quad_sphere(12));
    let target = holed();
    let (input, config) = over_part(&pair, &target, 200);
    let (x, _) = run(input, config).expect("a sound pair");

    let cap: Vec<VertexId> = x.ids().filter(|&v| pair.rest[v].z > 0.75).collect();
    let change = angle_change(&pair, &x, &cap);
    // The terms of the loss alone leave 3°.
    assert!(change < 2.5, "{change}");
    // Over the hole, whose rim is at 0.3, not on it.
    assert!(cap.iter().all(|&v| x[v].z > 0.3));
    let below: Vec<VertexId> = x.ids().filter(|&v| pair.rest[v].z < 0.4).collect();
    let miss = |&v: &VertexId| target.closest_point(&x[v]).distance_squared.sqrt();
    let mean = below.iter().map(miss).sum::<f64>() / below.len() as f64;
    assert!(mean < 0.01, "{mean}");
}

#[test]
fn a_kept_drape_over_a_part_goes_on_to_the_same_bits() {
    let pair = Pair::new(shapes::quad_sphere(16));
    let target = holed();
    let (input, mut config) = over_part(&pair, &target, 30);
    // So few that vertices without pairs in one iteration have them in another.
    config.sampling.n_samples = 400;
    config.sampling.double_every = None;
    config.sampling.max_samples = 400;
    let steps = |drape: &mut Drape, n: usize| {
        (0..n).for_each(|_| drop(drape.step().expect("a step")));
    };
    let mut drape = Drape::new(input, config.clone()).unwrap();
    // Just before the end of a period after which parts without pairs follow the rest.
    steps(&mut drape, 29);
    let state = drape.state();
    steps(&mut drape, 1);

    let mut again = Drape::new(input, config).unwrap();
    again.restore(&state).unwrap();
    steps(&mut again, 1);
    assert_eq!(again.positions(), drape.positions());
}
