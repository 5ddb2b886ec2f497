//! Sources whose vertices are split along seams, and landmarks, truth and figures for them.

use mesh_core::{io, shapes, Point3, PolygonSoup};

use crate::support::{Ended, Workplace};

/// The vertices of `shapes::quad_sphere(6)`.
const N: usize = 218;

/// A sphere of quads as one piece, and the same with the faces of its last third on copies of their vertices, each
/// `gap` away along x.
fn whole_and_split(gap: f64) -> (PolygonSoup, PolygonSoup) {
    let whole = shapes::quad_sphere(6);
    assert_eq!(whole.positions.len(), N);
    let mut split = whole.clone();
    let mut copy_of = vec![None; N];
    let n_faces = split.faces.len();
    for face in &mut split.faces[2 * n_faces / 3..] {
        for v in face {
            let copy = copy_of[*v as usize].get_or_insert_with(|| {
                let p = split.positions[*v as usize];
                split.positions.push(Point3::new(p.x + gap, p.y, p.z));
                split.positions.len() as u32 - 1
            });
            *v = *copy;
        }
    }
    (whole, split)
}

/// The rows of the split sphere that are one vertex of the whole one.
fn copies(split: &PolygonSoup) -> Vec<(usize, usize)> {
    (N..split.positions.len())
        .map(|copy| {
            let p = split.positions[copy];
            let near = (0..N).min_by(|&a, &b| {
                let distance = |v: usize| (split.positions[v] - p).norm();
                distance(a).total_cmp(&distance(b))
            });
            (copy, near.expect("a vertex"))
        })
        .collect()
}

fn drape(place: &Workplace, source: &str, more: &str) -> Ended {
    place
        .drape(&format!(
            "transfer {source} target.ply --landmarks landmarks.json --config short.toml -o out.obj {more}"
        ))
        .well()
}

fn result(place: &Workplace) -> Vec<Point3> {
    io::read_soup(place.path("out.obj"))
        .expect("the result")
        .positions
}

#[test]
fn a_split_source_is_draped_as_the_whole_one_and_stays_split() {
    let place = Workplace::new();
    let (whole, split) = whole_and_split(0.0);
    io::write_soup(place.path("whole.obj"), &whole).expect("it is written");
    io::write_soup(place.path("split.obj"), &split).expect("it is written");
    drape(&place, "whole.obj", "");
    let expected = result(&place);
    let ended = drape(&place, "split.obj", "");
    let draped = result(&place);

    assert_eq!(draped[..N], expected, "to the last bit");
    let copies = copies(&split);
    assert!(copies.len() > 50);
    for (copy, original) in copies {
        assert_eq!(draped[copy], draped[original]);
    }
    let words = format!("{} vertices at {N} places", split.positions.len());
    assert!(ended.stdout.contains(&words), "{}", ended.stdout);
    let faces = io::read_soup(place.path("out.obj"))
        .expect("the result")
        .faces;
    assert_eq!(faces, split.faces);
}

#[test]
fn a_tolerance_closes_gaps_and_off_leaves_equal_places_apart() {
    let place = Workplace::new();
    let (whole, split) = whole_and_split(1e-4);
    io::write_soup(place.path("gaps.obj"), &split).expect("it is written");
    drape(&place, "gaps.obj", "--weld 0.001");
    let draped = result(&place);
    for (copy, original) in copies(&split) {
        assert_eq!(draped[copy], draped[original]);
    }
    io::write_soup(place.path("whole.obj"), &whole).expect("it is written");
    drape(&place, "whole.obj", "");
    assert_eq!(draped[..N], result(&place));

    let (_, touching) = whole_and_split(0.0);
    io::write_soup(place.path("touching.obj"), &touching).expect("it is written");
    drape(&place, "touching.obj", "--weld off");
    let apart = result(&place);
    assert!(copies(&touching)
        .iter()
        .any(|&(copy, original)| apart[copy] != apart[original]));

    let refused = place.drape("transfer gaps.obj target.ply -o out.obj --weld=-1");
    assert_eq!(refused.code, Some(2));
    assert!(
        refused.stderr.contains("--weld") && refused.stderr.contains("0 or more, or off"),
        "{}",
        refused.stderr
    );
}

#[test]
fn landmarks_truth_and_results_count_the_vertices_of_the_file() {
    let place = Workplace::new();
    let (_, split) = whole_and_split(0.0);
    io::write_soup(place.path("split.obj"), &split).expect("it is written");
    io::write_soup(place.path("truth.obj"), &split).expect("it is written");
    let last = split.positions.len() - 1;
    let p = split.positions[last];
    let landmark = format!(
        r#"{{"landmarks": [{{"source": {{"vertex": {last}}}, "target": {{"point": [{}, {}, {}]}}}}]}}"#,
        4.0 * p.x + 10.0,
        3.0 * p.y,
        2.5 * p.z - 5.0
    );
    place.write("last.json", &landmark);
    let judged = place
        .drape("metrics split.obj split.obj split.obj -l last.json --truth truth.obj --json")
        .well()
        .json();
    assert_eq!(judged["figures"]["truth_mean"], 0.0, "{judged}");
    assert_eq!(judged["figures"]["vertices"], N as f64);

    let mut torn = split.clone();
    torn.positions[last].x += 0.5;
    io::write_soup(place.path("torn.obj"), &torn).expect("it is written");
    let warned = place.drape("metrics split.obj torn.obj split.obj").well();
    assert!(
        warned
            .stderr
            .contains("warning: torn.obj: vertices that are one"),
        "{}",
        warned.stderr
    );
    let beyond = landmark.replace(
        &format!("\"vertex\": {last}"),
        &format!("\"vertex\": {}", last + 1),
    );
    place.write("beyond.json", &beyond);
    let refused = place.drape("metrics split.obj split.obj split.obj -l beyond.json");
    assert_eq!(refused.code, Some(2));
}

#[test]
fn inspect_tells_of_seams() {
    let place = Workplace::new();
    let (_, split) = whole_and_split(0.0);
    io::write_soup(place.path("split.obj"), &split).expect("it is written");
    let found = place.drape("inspect split.obj").well().stdout;
    assert!(
        found.contains("at 218 places: split along seams"),
        "{found}"
    );
    let json = place.drape("inspect split.obj --json").well().json();
    assert_eq!(
        (&json["pieces"], &json["boundary_loops"]),
        (&1.into(), &0.into())
    );
}
