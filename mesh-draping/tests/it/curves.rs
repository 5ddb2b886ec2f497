//! Curves and weights in a drape, against a known truth.

use mesh_draping::landmarks::cut;
use mesh_draping::mesh_core::{shapes, Curve, Landmark, MeshPoint, Point3, VertexId};
use mesh_draping::{Outcome, Pair, Seams, Source, Target, Transfer};

use crate::support::{ball_and_ellipsoid, same_bits, short};

/// Vertices along a side of the sheet, less one.
const N: usize = 24;

/// Where a place of the sheet belongs on the same sheet: its middle line is bent, its rim stays.
fn truth(p: &Point3) -> Point3 {
    let side = N as f64;
    let [x, y] = [p.x, p.y].map(|c| (std::f64::consts::PI * c / side).sin());
    Point3::new(p.x, p.y + 0.15 * side * x * y, p.z)
}

fn vertex(column: usize, row: usize) -> VertexId {
    VertexId::new(row * (N + 1) + column)
}

/// A flat sheet over itself: nothing but landmarks tells where in it a place belongs. The corners and the ends of its middle
/// line are marked, and the line itself as a curve.
fn sheet() -> Pair {
    let soup = shapes::open_grid(N, N);
    let source = Source::of_soup(soup.clone(), Seams::EXACT).expect("a sheet is a mesh");
    let rest = source.rest();
    let ends = [(0, 0), (N, 0), (0, N), (N, N), (0, N / 2), (N, N / 2)];
    let marks = ends.map(|(column, row)| vertex(column, row));
    let mut landmarks: Vec<Landmark> = marks
        .iter()
        .map(|&v| Landmark::new(v, truth(&rest[v])))
        .collect();
    let line = (0..=N).map(|column| truth(&rest[vertex(column, N / 2)]));
    let curve = Curve {
        name: Some("middle".to_owned()),
        source: marks[4..].iter().map(|&v| MeshPoint::vertex(v)).collect(),
        target: line.collect(),
        weight: 1.0,
    };
    landmarks.extend(cut(curve, &source).expect("it can be cut"));
    Pair {
        target: Target::of_soup(soup).expect("a sheet is a surface"),
        landmarks,
        source,
    }
}

fn run(pair: Pair) -> Outcome {
    Transfer::of_pair(pair, short(40))
        .run()
        .expect("it is draped")
}

/// Mean distance of the middle line from where it belongs, in sides of the sheet.
fn error_along(outcome: &Outcome, initial: bool) -> f64 {
    let x = if initial {
        &outcome.by_landmarks
    } else {
        &outcome.draped
    };
    let rest = outcome.pair.source.rest();
    let miss = |column: usize| {
        let v = vertex(column, N / 2);
        (x[v] - truth(&rest[v])).norm()
    };
    (0..=N).map(miss).sum::<f64>() / ((N + 1) * N) as f64
}

#[test]
#[expect(clippy::print_stdout, reason = "the figures are asked for")]
fn a_curve_brings_the_line_between_its_ends_to_its_place() {
    let with = run(sheet());
    let mut pair = sheet();
    pair.landmarks.truncate(6);
    let without = run(pair);
    let figures = [&without, &with].map(|o| [true, false].map(|i| 100.0 * error_along(o, i)));
    println!(
        "mean error along the line, % of the side, start and result: ends alone {:.2?}, with the curve {:.2?}",
        figures[0], figures[1]
    );
    assert!(figures[1][0] < 0.3 * figures[0][0], "{figures:?}");
    assert!(figures[1][1] < 0.2 * figures[0][1], "{figures:?}");
    assert_eq!(with.report.curves.len(), 1);
    assert_eq!(
        with.report
            .landmarks
            .as_ref()
            .map(|fit| fit.residuals.len()),
        Some(6)
    );
}

#[test]
fn a_curve_of_weight_zero_changes_nothing_but_the_report() {
    let mut pair = sheet();
    pair.landmarks
        .iter_mut()
        .skip(6)
        .for_each(|l| l.weight = 0.0);
    let ignored = run(pair.clone());
    pair.landmarks.truncate(6);
    assert!(same_bits(&ignored.draped, &run(pair).draped));
}

#[test]
fn a_landmark_that_weighs_more_is_met_better() {
    let miss = |weight: f64| {
        let mut pair = ball_and_ellipsoid(6);
        pair.landmarks[0].target.x += 0.6;
        pair.landmarks[0].weight = weight;
        let outcome = run(pair);
        let landmark = &outcome.pair.landmarks[0];
        (landmark.source.position(&outcome.draped) - landmark.target).norm()
    };
    let misses = [0.2, 1.0, 5.0].map(miss);
    assert!(misses[0] > misses[1] && misses[1] > misses[2], "{misses:?}");
}
