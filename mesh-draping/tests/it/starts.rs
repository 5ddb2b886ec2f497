//! Which start is taken, and what is left out of a shape.

use mesh_draping::mesh_core::{shapes, Point3, PolygonSoup};
use mesh_draping::{InitialMethod, Note, Preset, Seams, Source, Target, Transfer};

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

/// A ball that narrows to a point, closed below.
fn cone() -> PolygonSoup {
    let mut soup = shapes::quad_sphere(6);
    for p in &mut soup.positions {
        let wide = p.coords / p.coords.amax();
        let width = 0.5 * (1.02 - wide.y);
        *p = Point3::new(wide.x * width, wide.y, wide.z * width);
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

/// The least that tells what is left out.
fn decision() -> Preset {
    short(1)
}

/// Simple shapes over each other, without a landmark: whole shapes are draped whole.
#[test]
fn simple_shapes_over_each_other_are_not_left_out() {
    let shapes: [(&str, PolygonSoup); 5] = [
        ("ball", shapes::quad_sphere(5)),
        ("cube", cube()),
        ("cone", cone()),
        ("hook", hook()),
        ("blob", blob()),
    ];
    for (source_name, source) in &shapes {
        for (target_name, target) in &shapes {
            let source = Source::of_soup(source.clone(), Seams::EXACT).unwrap();
            let target = Target::of_soup(target.clone()).unwrap();
            let run = Transfer::new(&source, &target, &[], decision()).run();
            let left_out = run
                .unwrap()
                .notes
                .iter()
                .any(|note| matches!(note, Note::LeftOut { share, .. } if *share > 0.5));
            assert!(!left_out, "{source_name} over {target_name}");
        }
    }
}

/// Where the deformation by landmarks is as good as any, it is the start, to the bit.
#[test]
fn a_good_start_is_kept() {
    let start = |initial: InitialMethod| {
        let preset = Preset {
            initial,
            ..decision()
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
