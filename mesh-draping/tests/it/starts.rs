//! Which start is taken, and what is left out of a shape.

use mesh_draping::mesh_core::{shapes, Point3, PolygonSoup, Positions};
use mesh_draping::{
    InitialMethod, Note, Outcome, Population, Preset, Seams, Source, Target, Transfer,
};

use crate::support::{ball_and_ellipsoid, same_bits, short};

/// A ring cut open and closed at its ends, a bar with a bend: part of a torus.
fn hook() -> PolygonSoup {
    let mut soup = shapes::quad_sphere(6);
    for p in &mut soup.positions {
        let (angle, radius) = (1.8 * p.x, 2.0 + 0.6 * p.y);
        *p = Point3::new(radius * angle.sin(), radius * angle.cos(), 0.6 * p.z);
    }
    soup
}

/// A ball pressed flat on six sides.
fn cube() -> PolygonSoup {
    let mut soup = shapes::quad_sphere(6);
    for p in &mut soup.positions {
        *p = Point3::from(p.coords / p.coords.amax());
    }
    soup
}

/// A cube that narrows upwards, to so much of its width.
fn cone(tip: f64) -> PolygonSoup {
    let mut soup = cube();
    for p in &mut soup.positions {
        let width = 0.5 * (1.0 - p.y) + 0.5 * tip * (1.0 + p.y);
        *p = Point3::new(p.x * width, p.y, p.z * width);
    }
    soup
}

/// A ball with two ears.
fn blob() -> PolygonSoup {
    let mut soup = shapes::quad_sphere(6);
    for p in &mut soup.positions {
        let ear =
            |x: f64| (-8.0 * (p.coords - Point3::new(x, 0.8, 0.3).coords).norm_squared()).exp();
        *p += p.coords * (0.8 * (ear(0.6) + ear(-0.6)));
    }
    soup
}

/// Whether more than half of either shape is left out before the first step, without a landmark.
fn is_half_left_out(source: &PolygonSoup, target: &PolygonSoup) -> bool {
    let source = Source::of_soup(source.clone(), Seams::EXACT).expect("a source");
    let target = Target::of_soup(target.clone()).expect("a target");
    let draping = Transfer::new(&source, &target, &[], Preset::standard()).start();
    let outcome = draping.and_then(|draping| draping.finish());
    let is_half = |note: &Note| matches!(note, Note::LeftOut { share, .. } if *share > 0.5);
    outcome.expect("an outcome").notes.iter().any(is_half)
}

/// Simple shapes over each other: whole shapes are draped whole.
#[test]
fn simple_shapes_over_each_other_are_not_left_out() {
    let shapes: [(&str, PolygonSoup); 5] = [
        ("ball", shapes::quad_sphere(5)),
        ("cube", cube()),
        ("cone", cone(0.25)),
        ("hook", hook()),
        ("blob", blob()),
    ];
    for (source_name, source) in &shapes {
        for (target_name, target) in &shapes {
            let is_left_out = is_half_left_out(source, target);
            assert!(!is_left_out, "{source_name} over {target_name}");
        }
    }
}

/// The tip stays outside, but leaving half of the cone out does not even bring the other half to the ball.
#[test]
fn a_sharp_tip_over_a_ball_is_not_left_out() {
    assert!(!is_half_left_out(&cone(0.01), &shapes::quad_sphere(5)));
}

/// Where the deformation by landmarks is as good as any, it is the start, to the bit.
#[test]
fn a_good_start_is_kept() {
    let start = |initial: InitialMethod| {
        let preset = Preset {
            initial,
            ..short(1)
        };
        let draping = Transfer::of_pair(ball_and_ellipsoid(6), preset)
            .start()
            .unwrap();
        draping.initial().clone()
    };
    assert!(same_bits(
        &start(InitialMethod::Tried),
        &start(InitialMethod::Standard)
    ));
}

#[test]
fn a_shape_that_nearly_fits_is_a_start_of_a_short_run() {
    let (pair, preset) = (ball_and_ellipsoid(6), short(30));
    let before = Transfer::of_pair(pair.clone(), preset.clone()).run();
    let before = before.expect("the pair can be draped");
    // The next frame: a little further on, and unmarked.
    let further = |p: &Point3| Point3::new(p.x + 0.05, p.y, p.z);
    let mut soup = pair.target.soup().clone();
    soup.positions.iter_mut().for_each(|p| *p = further(p));
    let target = Target::of_soup(soup).expect("a target");
    let next = Transfer::new(&pair.source, &target, &[], preset).with_start(before.draped.clone());
    let draping = next.start().expect("the next frame can be draped");
    assert_eq!(draping.n_iterations(), 20);
    assert!(same_bits(draping.initial(), &before.draped));
    let outcome = draping.finish().expect("an outcome");
    assert!(outcome.notes.is_empty(), "{:?}", outcome.notes);

    let wrong = Transfer::of_pair(pair, short(3)).with_start(vec![Point3::origin()].into());
    let told = wrong.start().err().map(|error| error.to_string());
    assert!(told.is_some_and(|told| told.contains("the shape to start from")));
}

/// Balls that are drawn out in different ways, where the target of [`ball_and_ellipsoid`] is.
fn solved(rest: &Positions) -> Vec<Positions> {
    let sides = [
        [4.0, 3.0, 2.0],
        [4.0, 2.5, 3.0],
        [3.5, 3.0, 3.0],
        [4.5, 3.5, 2.5],
    ];
    let drawn_out =
        |[x, y, z]: [f64; 3]| rest.map(|p| Point3::new(x * p.x + 10.0, y * p.y, z * p.z - 5.0));
    sides.map(drawn_out).to_vec()
}

/// Shapes that say nothing of the target change no bit.
#[test]
fn a_prior_that_fits_no_better_is_no_start() {
    let pair = ball_and_ellipsoid(6);
    let flat = |y: f64| {
        pair.source
            .rest()
            .map(|p| Point3::new(p.x, y * p.y, 0.1 * p.z))
    };
    let useless = Population::of(&[flat(1.0), flat(0.2)]).expect("two shapes");
    let alone = Transfer::of_pair(pair.clone(), short(6)).run().unwrap();
    let led = Transfer::of_pair(pair.clone(), short(6)).with_prior(useless);
    let led = led.run().unwrap();
    assert!(same_bits(&alone.initial, &led.initial));
    assert!(same_bits(&alone.draped, &led.draped));

    let other = Population::of(&[vec![Point3::origin()].into()]).expect("a shape");
    let wrong = Transfer::of_pair(pair, short(6)).with_prior(other).start();
    let told = wrong.err().map(|error| error.to_string());
    assert!(told.is_some_and(|told| told.contains("a shape of the population")));
}

#[test]
fn what_a_scan_does_not_show_is_taken_from_the_prior() {
    let mut pair = ball_and_ellipsoid(6);
    let right = pair.target.soup().clone();
    let mut scan = right.clone();
    let is_seen = |row: &u32| right.positions[*row as usize].z < -4.5;
    let faces = right.faces.iter().filter(|face| face.iter().all(is_seen));
    scan.faces = faces.cloned().collect();
    pair.target = Target::of_soup(scan).expect("half an ellipsoid");
    pair.landmarks.retain(|l| l.target.z < -4.5);
    let population = Population::of(&solved(pair.source.rest())).expect("four shapes");
    let truth = pair
        .source
        .rest()
        .map(|p| Point3::new(4.0 * p.x + 10.0, 3.0 * p.y, 2.5 * p.z - 5.0));
    let run = |transfer: Transfer| {
        let outcome = transfer.with_truth(truth.clone()).run();
        outcome.expect("the scan can be draped")
    };
    let alone = run(Transfer::of_pair(pair.clone(), short(30)));
    let led = run(Transfer::of_pair(pair, short(30)).with_prior(population));
    let is_completed = |note: &Note| matches!(note, Note::Completed { .. });
    assert!(led.notes.iter().any(is_completed), "{:?}", led.notes);
    let miss = |outcome: &Outcome| outcome.report.truth.as_ref().map(|t| t.mean);
    let (alone, led) = (miss(&alone).unwrap(), miss(&led).unwrap());
    assert!(led < alone, "{led} with the prior, {alone} without");
}
