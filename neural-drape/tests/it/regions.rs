//! Free and rigid parts.

use mesh_core::{shapes, Positions, VertexId};
use neural_drape::{Drape, DrapeError, Regions};

use crate::setup::{on_ellipsoid, presets, short, Pair};

fn run(pair: &Pair, preset: &str, regions: &Regions) -> Positions {
    let mut drape = Drape::new(pair.input(), short(preset, 120)).expect("a sound pair");
    drape.set_regions(regions).expect("sound regions");
    while drape.step().expect("a step").is_some() {}
    drape.positions()
}

/// The vertices of the quad sphere around its pole.
fn cap(pair: &Pair) -> Vec<VertexId> {
    pair.rest.ids().filter(|&v| pair.rest[v].z > 0.75).collect()
}

#[test]
fn a_rigid_part_keeps_its_shape_whatever_is_optimised() {
    let pair = Pair::new(shapes::quad_sphere(8));
    let mut regions = Regions::none(pair.rest.len());
    let cap = cap(&pair);
    cap.iter().for_each(|&v| regions.rigid[v] = true);
    let tried = ["standard", "network"];
    for preset in presets().filter(|p| tried.contains(p)) {
        let x = run(&pair, preset, &regions);
        let ratio =
            |a: VertexId, b: VertexId| (x[a] - x[b]).norm() / (pair.rest[a] - pair.rest[b]).norm();
        for &v in &cap[1..] {
            // The initial shape is the sphere at 0.8 of its size, and so big the body stays.
            assert!((ratio(cap[0], v) - 0.8).abs() < 1e-6, "{preset}");
        }
        assert!(x.iter().all(|p| p.coords.iter().all(|c| c.is_finite())));
    }
}

#[test]
fn a_free_part_follows_and_is_not_attracted() {
    let pair = Pair::new(shapes::quad_sphere(8));
    let mut regions = Regions::none(pair.rest.len());
    let cap = cap(&pair);
    cap.iter().for_each(|&v| regions.attraction[v] = 0.0);
    let free = run(&pair, "standard", &regions);
    let whole = run(&pair, "standard", &Regions::none(pair.rest.len()));
    let miss = |x: &Positions, v: VertexId| (x[v] - on_ellipsoid(&pair.rest[v])).norm();
    let worst = |x: &Positions| cap.iter().map(|&v| miss(x, v)).fold(0.0, f64::max);
    // The pole starts 0.3 above the target. The rest sinks, and the smooth field takes the cap along.
    assert!(worst(&free) < 0.2, "{}", worst(&free));
    assert!(worst(&whole) < worst(&free));
    for v in pair.rest.ids().filter(|&v| pair.rest[v].z < -0.5) {
        assert!(miss(&free, v) < 0.2);
    }
}

#[test]
fn regions_of_another_mesh_are_refused() {
    let pair = Pair::new(shapes::quad_sphere(3));
    let mut drape = Drape::new(pair.input(), short("standard", 1)).expect("a sound pair");
    let wrong = drape.set_regions(&Regions::none(3));
    assert!(matches!(
        wrong,
        Err(DrapeError::LengthMismatch { found: 3, .. })
    ));
    let mut regions = Regions::none(pair.rest.len());
    regions.attraction[VertexId::new(1)] = 1.5;
    let wrong = drape.set_regions(&regions);
    assert!(matches!(wrong, Err(DrapeError::Setting { .. })));
}
