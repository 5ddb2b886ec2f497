//! Brushes on a shape, and on a drape that goes on from there.

use mesh_draping::mesh_core::{Point3, Positions, Vector3, VertexData, VertexId};
use mesh_draping::neural_drape::Regions;
use mesh_draping::{Brush, BrushInput, Pair, Stroke, Transfer};
use nalgebra::Rotation3;

use crate::support::{ball_and_ellipsoid, same_bits, short};

/// The end of the ellipsoid along x.
const TIP: [f64; 3] = [14.0, 0.0, -5.0];

fn stroke(brush: Brush, path: &[[f64; 3]]) -> Stroke {
    Stroke {
        brush,
        radius: 1.5,
        strength: 1.0,
        path: path.to_vec(),
    }
}

/// What a stroke makes of a shape of which nothing is held.
fn brushed(pair: &Pair, stroke: &Stroke, x: &Positions) -> Positions {
    let held = VertexData::new(x.len(), false);
    let mut x = x.clone();
    stroke.apply(BrushInput { pair, held: &held }, &mut x);
    x
}

/// The ball as large as the ellipsoid is long, turned.
fn turned_ball(pair: &Pair) -> Positions {
    let turn = Rotation3::from_euler_angles(0.3, 1.0, -0.7);
    let at = Vector3::new(10.0, 0.0, -5.0);
    pair.source.rest().map(|p| turn * (p * 4.0) + at)
}

/// The same with every vertex moved by some.
fn rough(x: &Positions) -> Positions {
    let shake = |v: VertexId| {
        let k = v.index() as f64;
        Vector3::new((1.7 * k).sin(), (2.3 * k).cos(), (3.1 * k).sin()) * 0.2
    };
    x.ids().map(|v| x[v] + shake(v)).collect()
}

fn mean(x: &Positions, of: impl Fn(VertexId) -> f64, near: [f64; 3], reach: f64) -> f64 {
    let near = Point3::from(near);
    let some: Vec<f64> = x
        .ids()
        .filter(|&v| (x[v] - near).norm() < reach)
        .map(of)
        .collect();
    assert!(some.len() > 8, "{} vertices", some.len());
    some.iter().sum::<f64>() / some.len() as f64
}

#[test]
fn relaxing_leaves_a_turned_rest_shape_and_smooths_a_rough_one() {
    let pair = ball_and_ellipsoid(16);
    let smooth = turned_ball(&pair);
    let relax = stroke(Brush::Relax, &[TIP, TIP, TIP]);
    let same = brushed(&pair, &relax, &smooth);
    assert!(smooth.iter().zip(&same).all(|(a, b)| (a - b).norm() < 1e-9));

    let before = rough(&smooth);
    let after = brushed(&pair, &relax, &before);
    // The ball is smooth where edges are as at rest, four times as long.
    let (t, rest) = (pair.source.triangulation(), pair.source.rest());
    let strain = |x: &Positions, v: VertexId| {
        let ends = t.vertex_neighbours(v).iter();
        let off = ends.map(|&w| ((x[w] - x[v]).norm() / (4.0 * (rest[w] - rest[v]).norm())).ln());
        off.map(|s| s * s).sum::<f64>()
    };
    let [rough, relaxed] = [&before, &after].map(|x| mean(&smooth, |v| strain(x, v), TIP, 0.7));
    assert!(relaxed < 0.3 * rough, "{rough} {relaxed}");
    let far = |v: VertexId| (before[v] - Point3::from(TIP)).norm() > 1.5;
    assert!(before
        .ids()
        .filter(|&v| far(v))
        .all(|v| before[v] == after[v]));
}

#[test]
fn pulling_brings_the_surface_to_the_target_and_no_far_side_through_it() {
    let pair = ball_and_ellipsoid(32);
    let before = turned_ball(&pair).map(|p| p + Vector3::new(0.4, 0.0, 0.0));
    let at = [TIP[0] + 0.4, TIP[1], TIP[2]];
    let after = brushed(&pair, &stroke(Brush::Pull, &[at, at]), &before);
    let off = |x: &Positions, v| {
        let hit = pair.target.judged().closest_point(&x[v]);
        (hit.point - x[v]).norm()
    };
    let [was, is] = [&before, &after].map(|x| mean(&before, |v| off(x, v), at, 0.6));
    assert!(is < 0.1 * was, "{was} {is}");
    // The near side of a ball beyond the tip faces the other way, and stays.
    let beyond = before.map(|p| p + Vector3::new(8.0, 0.0, 0.0));
    let left = brushed(&pair, &stroke(Brush::Pull, &[at]), &beyond);
    assert!(same_bits(&left, &beyond));
}

#[test]
fn sliding_follows_the_brush_and_stays_on_the_target() {
    let pair = ball_and_ellipsoid(32);
    let target = pair.target.judged();
    let onto = |p: &Point3| target.closest_point(p).point;
    let before = turned_ball(&pair).map(onto);
    let path = [TIP, [13.9, 0.5, -5.0], [13.7, 1.0, -5.0]];
    let after = brushed(&pair, &stroke(Brush::Slide, &path), &before);
    let off = |v: VertexId| (onto(&after[v]) - after[v]).norm();
    assert!(after.ids().all(|v| off(v) < 1e-9));
    let along = mean(&before, |v| after[v].y - before[v].y, TIP, 0.4);
    assert!(along > 0.3, "{along}");
    // A touch that goes nowhere does nothing.
    let still = brushed(&pair, &stroke(Brush::Slide, &[TIP]), &before);
    assert!(still
        .iter()
        .zip(&before)
        .all(|(a, b)| (a - b).norm() < 1e-12));
}

#[test]
fn a_stroke_is_its_places_one_by_one_on_any_number_of_threads() {
    let pair = ball_and_ellipsoid(16);
    let before = rough(&turned_ball(&pair));
    let held = VertexData::new(before.len(), false);
    let input = BrushInput {
        pair: &pair,
        held: &held,
    };
    for brush in [Brush::Relax, Brush::Pull, Brush::Slide] {
        let stroke = stroke(brush, &[TIP, [13.8, 0.9, -5.0], [13.0, 1.6, -4.0]]);
        let mut shown = before.clone();
        (0..3).for_each(|place| stroke.apply_place(input, &mut shown, place));
        for n_threads in [1, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads);
            let pool = pool.build().unwrap();
            let whole = pool.install(|| brushed(&pair, &stroke, &before));
            assert!(same_bits(&whole, &shown), "{brush:?}, {n_threads} threads");
        }
    }
}

#[test]
fn a_drape_goes_on_from_what_was_brushed_and_takes_it_back() {
    let mut draping = Transfer::of_pair(ball_and_ellipsoid(8), short(12))
        .start()
        .unwrap();
    while draping.step().unwrap().is_some() {}
    let (before, n) = (draping.positions(), draping.n_iterations());
    let path = [TIP, [13.6, 1.2, -5.0]];
    let moves = draping.brush(&stroke(Brush::Slide, &path)).unwrap();
    let after = draping.positions();
    assert!(!moves.entries.is_empty() && !same_bits(&before, &after));
    assert!(draping.is_over() && draping.n_iterations() == n);
    draping.displace(&moves.reversed()).unwrap();
    let back = draping.positions();
    assert!(before.iter().zip(&back).all(|(a, b)| (a - b).norm() < 1e-9));
    draping.extend(2);
    assert!(draping.step().unwrap().is_some());
    for (radius, strength) in [(0.0, 0.5), (f64::NAN, 0.5), (1.0, 1.5)] {
        let bad = Stroke {
            radius,
            strength,
            ..stroke(Brush::Pull, &[TIP])
        };
        assert!(draping.brush(&bad).is_err());
    }
    let wild = stroke(Brush::Pull, &[[f64::NAN, 0.0, 0.0]]);
    assert!(draping.brush(&wild).is_err());
}

#[test]
fn rigid_parts_are_held() {
    let pair = ball_and_ellipsoid(8);
    let mut regions = Regions::none(pair.source.rest().len());
    for v in pair.source.rest().ids() {
        regions.rigid[v] = pair.source.rest()[v].x > 0.7;
    }
    let rigid = regions.rigid.clone();
    let transfer = Transfer::of_pair(pair, short(3)).with_regions(regions);
    let mut draping = transfer.start().unwrap();
    assert!(draping.step().unwrap().is_some());
    let wide = Stroke {
        radius: 4.0,
        ..stroke(Brush::Pull, &[TIP])
    };
    let moves = draping.brush(&wide).unwrap();
    assert!(!moves.entries.is_empty());
    assert!(moves.entries.iter().all(|&(v, _)| !rigid[v]));
}
