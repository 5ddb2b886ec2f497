//! A run improves the fit, repeats to the bit, and starts where it should.

use std::sync::Arc;

use mesh_core::{shapes, Point3, Positions, TriangleSoup, Vector3};
use neural_drape::{Drape, DrapeConfig};

use crate::setup::{on_ellipsoid, presets, run, short, Pair};

fn mean_distance(x: &Positions, pair: &Pair) -> f64 {
    let hits = pair.target.closest_points(x.as_slice());
    hits.iter().map(|h| h.distance_squared.sqrt()).sum::<f64>() / x.len() as f64
}

#[test]
fn every_preset_starts_at_the_initial_shape_and_comes_closer() {
    for source in [shapes::icosphere(2), shapes::quad_sphere(5)] {
        let pair = Pair::new(source);
        for preset in presets() {
            let drape = Drape::new(pair.input(), short(preset, 60)).unwrap();
            let start = drape.positions();
            let shift = start
                .iter()
                .zip(&pair.initial)
                .map(|(a, b)| (a - b).norm())
                .fold(0.0, f64::max);
            assert!(shift < 1e-12, "{preset} starts {shift} away");

            let (end, reports) = run(pair.input(), short(preset, 60)).unwrap();
            assert_eq!(reports.len(), 60);
            let (before, after) = (mean_distance(&start, &pair), mean_distance(&end, &pair));
            assert!(after < 0.5 * before, "{preset}: {before} to {after}");
        }
    }
}

#[test]
fn open_sources_and_polygons_are_draped_too() {
    let mut sheet = shapes::open_grid(6, 6);
    sheet
        .positions
        .iter_mut()
        .for_each(|p| *p = Point3::new(p.x / 3.0 - 1.0, p.y / 3.0 - 1.0, 0.6));
    for source in [sheet, shapes::cone(9), shapes::prism(7)] {
        let pair = Pair::new(source);
        let (_, reports) = run(pair.input(), short("standard", 60)).unwrap();
        let chamfer = |k: usize| {
            reports[k]
                .terms
                .iter()
                .find(|t| t.name == "chamfer")
                .unwrap()
                .value
        };
        let (before, after) = (chamfer(0), chamfer(59));
        assert!(after < before, "{before} to {after}");
    }
}

#[test]
fn same_seed_same_bits_whatever_the_thread_count() {
    let pair = Pair::new(shapes::quad_sphere(6));
    for preset in presets() {
        let [one, two] = [1, 2].map(|n_threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(n_threads)
                .build()
                .unwrap();
            pool.install(|| run(pair.input(), short(preset, 12)).unwrap().0)
        });
        assert_eq!(one, two, "{preset}");
        let other = DrapeConfig {
            seed: 1,
            ..short(preset, 12)
        };
        assert_ne!(
            run(pair.input(), other).unwrap().0,
            one,
            "{preset}: the seed does nothing"
        );
    }
}

#[test]
fn units_place_and_turn_of_the_target_do_not_matter() {
    let turn = nalgebra::Rotation3::from_euler_angles(0.7, -1.1, 2.3);
    let away = |p: &Point3| turn * p * 1000.0 + Vector3::new(1e4, -1e4, 1e4);
    let near = Pair::new(shapes::icosphere(2));
    let (here, _) = run(near.input(), short("standard", 60)).unwrap();

    let mut far = Pair::new(shapes::icosphere(2));
    let mut ellipsoid = shapes::icosphere(3);
    for p in &mut ellipsoid.positions {
        *p = away(&on_ellipsoid(p));
    }
    far.target = Arc::new(TriangleSoup::new(ellipsoid).unwrap());
    far.initial = near.initial.map(away);
    let (there, _) = run(far.input(), short("standard", 60)).unwrap();

    let shifts = here.iter().zip(&there).map(|(a, b)| (away(a) - b).norm());
    let worst = shifts.fold(0.0, f64::max) / 2000.0;
    assert!(worst < 1e-6, "{worst} of the longest side");
}
