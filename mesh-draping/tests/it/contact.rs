//! No surface through another: shapes built so that a drape would drive them through themselves.

use mesh_core::{Landmark, Point3, PolygonSoup, VertexId};
use mesh_draping::{Outcome, Preset, Seams, Source, Target, Transfer};

/// The surface of the cells of a lattice that are full.
fn blocks(lines: [&[f64]; 3], is_full: impl Fn([usize; 3]) -> bool) -> PolygonSoup {
    let n = lines.map(|line| line.len());
    let row = |at: [usize; 3]| (at[0] * n[1] + at[1]) * n[2] + at[2];
    let mut row_of = vec![None; n.iter().product()];
    let mut soup = PolygonSoup::default();
    let cells = |axis: usize| n[axis] - 1;
    for cell in (0..cells(0) * cells(1) * cells(2)).map(|k| {
        let (k, z) = (k / cells(2), k % cells(2));
        [k / cells(1), k % cells(1), z]
    }) {
        if !is_full(cell) {
            continue;
        }
        for (axis, side) in (0..3).flat_map(|axis| [(axis, 0), (axis, 1)]) {
            let mut beside = cell.map(|c| c as i64);
            beside[axis] += if side == 0 { -1 } else { 1 };
            let is_inside = (0..3).all(|k| (0..cells(k) as i64).contains(&beside[k]));
            if is_inside && is_full(beside.map(|c| c as usize)) {
                continue;
            }
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let turns = [[0, 0], [1, 0], [1, 1], [0, 1]];
            let mut face: Vec<u32> = turns
                .iter()
                .map(|[a, b]| {
                    let mut at = cell;
                    at[axis] += side;
                    at[u] += a;
                    at[v] += b;
                    *row_of[row(at)].get_or_insert_with(|| {
                        let place = Point3::new(lines[0][at[0]], lines[1][at[1]], lines[2][at[2]]);
                        soup.positions.push(place);
                        soup.positions.len() as u32 - 1
                    })
                })
                .collect();
            if side == 0 {
                face.reverse();
            }
            soup.faces.push(face);
        }
    }
    soup
}

/// `n` equal steps from `from` to `to`.
fn steps(from: f64, to: f64, n: usize) -> Vec<f64> {
    let at = |k: usize| from + (to - from) * k as f64 / n as f64;
    (0..=n).map(at).collect()
}

/// A drape of vertices over the same vertices elsewhere, led by some of them.
fn draped(source: PolygonSoup, target: PolygonSoup, marked: &[u32]) -> Outcome {
    let landmark = |&v: &u32| {
        let row = v as usize;
        Landmark::new(VertexId::new(row), source.positions[row])
    };
    let landmarks: Vec<Landmark> = marked.iter().map(landmark).collect();
    let source = Source::of_soup(source, Seams::EXACT).expect("a mesh");
    let target = Target::of_soup(target).expect("a surface");
    Transfer::new(&source, &target, &landmarks, Preset::quick())
        .run()
        .expect("a drape")
}

/// The vertices nearest to some places.
fn nearest(soup: &PolygonSoup, places: &[[f64; 3]]) -> Vec<u32> {
    let rows = |place: &[f64; 3]| {
        let place = Point3::from(*place);
        let far = soup.positions.iter().map(|p| (p - place).norm());
        let least = far.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
        least.map_or(0, |(row, _)| row as u32)
    };
    places.iter().map(rows).collect()
}

fn assert_apart(outcome: &Outcome) {
    let defects = &outcome.report.defects;
    assert_eq!(
        (defects.crossings, defects.self_intersections_new),
        (0, 0),
        "{:?}",
        outcome.notes
    );
    assert_eq!(
        (defects.folds, defects.skinny_new),
        (0, 0),
        "{:?}",
        outcome.notes
    );
}

/// A body of 2 m with two fingers of 10 cm at its top, `gap` apart.
fn fingers(gap: f64) -> PolygonSoup {
    let xs = [
        -0.2, -0.14, -0.08, -0.04, -0.025, -0.015, -0.005, 0.005, 0.015, 0.025, 0.04, 0.08, 0.14,
        0.2,
    ];
    let ys = [-0.15, -0.08, -0.03, -0.01, 0.0, 0.01, 0.03, 0.08, 0.15];
    let zs = [steps(0.0, 1.9, 24), steps(1.9, 2.0, 10)[1..].to_vec()].concat();
    let mut soup = blocks([&xs, &ys, &zs], |[i, j, k]| {
        k < 24 || ([4, 5, 7, 8].contains(&i) && (3..5).contains(&j))
    });
    for p in soup.positions.iter_mut().filter(|p| p.z > 1.905) {
        p.x += (0.5 * gap - 0.005) * p.x.signum();
    }
    soup
}

#[test]
fn fingers_two_millimetres_apart_stay_apart_where_those_of_the_target_run_through_each_other() {
    let (source, target) = (fingers(2e-3), fingers(-3e-3));
    let corners = [
        [-0.2, -0.15, 0.0],
        [0.2, -0.15, 0.0],
        [0.2, 0.15, 0.0],
        [-0.2, 0.15, 1.9],
        [0.2, 0.15, 1.9],
        [-0.2, -0.15, 1.9],
    ];
    let marked = nearest(&source, &corners);
    let outcome = draped(source, target, &marked);
    assert_apart(&outcome);
    assert!(
        outcome.report.hausdorff < 0.01,
        "{}",
        outcome.report.hausdorff
    );
}

/// A head with a mouth whose lips touch all but for a tenth of a millimetre, and a bag behind them.
fn head(has_mouth: bool) -> PolygonSoup {
    let xs = steps(-0.1, 0.1, 12);
    let ys = steps(-0.1, 0.1, 12);
    let zs = steps(-0.1, 0.1, 13);
    let mut soup = blocks([&xs, &ys, &zs], |[i, j, k]| {
        let is_slit = k == 6 && j < 3 && (3..9).contains(&i);
        let is_bag = (5..8).contains(&k) && (3..7).contains(&j) && (3..9).contains(&i);
        !has_mouth || !(is_slit || is_bag)
    });
    for p in soup.positions.iter_mut() {
        if p.z.abs() < 0.01 && p.y < -0.045 && p.x.abs() < 0.045 {
            p.z = 5e-5 * p.z.signum();
        }
    }
    soup
}

#[test]
fn lips_that_touch_stay_apart_and_the_bag_behind_them_whole_over_a_face_without_a_mouth() {
    let (source, target) = (head(true), head(false));
    let corners = [
        [-0.1, -0.1, -0.1],
        [0.1, -0.1, -0.1],
        [0.1, 0.1, -0.1],
        [-0.1, 0.1, 0.1],
        [0.1, -0.1, 0.1],
    ];
    let marked = nearest(&source, &corners);
    assert_apart(&draped(source, target, &marked));
}

/// An arm and a sleeve around it.
fn arm_in_sleeve(arm: f64, sleeve: f64) -> PolygonSoup {
    let mut soup = PolygonSoup::default();
    let n_around = 24u32;
    let mut tube = |from: f64, to: f64, n: usize, radius: f64, is_capped: bool| {
        let first = soup.positions.len() as u32;
        for x in steps(from, to, n) {
            for k in 0..n_around {
                let (sin, cos) =
                    (std::f64::consts::TAU * f64::from(k) / f64::from(n_around)).sin_cos();
                soup.positions
                    .push(Point3::new(x, radius * cos, radius * sin));
            }
        }
        for ring in 0..n as u32 {
            for k in 0..n_around {
                let at = |ring: u32, k: u32| first + ring * n_around + k % n_around;
                soup.faces.push(vec![
                    at(ring, k),
                    at(ring, k + 1),
                    at(ring + 1, k + 1),
                    at(ring + 1, k),
                ]);
            }
        }
        if is_capped {
            for (x, ring) in [(from - radius, 0), (to + radius, n as u32)] {
                let tip = soup.positions.len() as u32;
                soup.positions.push(Point3::new(x, 0.0, 0.0));
                for k in 0..n_around {
                    let [a, b] = [k, (k + 1) % n_around].map(|k| first + ring * n_around + k);
                    soup.faces.push(if ring == 0 {
                        vec![tip, b, a]
                    } else {
                        vec![tip, a, b]
                    });
                }
            }
        }
    };
    tube(-0.5, 0.5, 40, arm, true);
    tube(-0.3, 0.3, 24, sleeve, false);
    soup
}

#[test]
fn a_sleeve_stays_around_its_arm_where_that_of_the_target_is_inside() {
    let (source, target) = (arm_in_sleeve(0.05, 0.053), arm_in_sleeve(0.052, 0.0515));
    let ends = [
        [-0.55, 0., 0.],
        [0.55, 0., 0.],
        [0.0, 0.05, 0.0],
        [0.0, 0.0, 0.05],
        [0.3, 0.053, 0.0],
    ];
    let marked = nearest(&source, &ends[..4]);
    assert_apart(&draped(source, target, &marked));
}
