//! Work that once grew with the square of the input.

use std::fmt::Write as _;
use std::time::{Duration, Instant};

use super::assert_refused;
use crate::support::Workplace;

/// What none of these inputs may take on the clock, on a machine with other work to do.
const AT_ONCE: Duration = Duration::from_secs(20);

/// The corners of a cube as OBJ.
const CUBE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n";

/// 300 000 faces over the corners of a cube: its sides as quads, or cut into triangles, again and again.
fn coincident(faces: &[&str]) -> String {
    let mut text = CUBE.to_owned();
    for face in faces.iter().cycle().take(300_000) {
        let _ = writeln!(text, "f {face}");
    }
    text
}

const QUADS: [&str; 6] = [
    "1 4 3 2", "5 6 7 8", "1 2 6 5", "2 3 7 6", "3 4 8 7", "4 1 5 8",
];

#[test]
fn a_polygon_of_two_hundred_thousand_corners() {
    let place = Workplace::new();
    let mut text = String::new();
    let mut face = String::from("f");
    for k in 0..200_000 {
        let angle = f64::from(k) * std::f64::consts::TAU / 200_000.0;
        let _ = writeln!(text, "v {} {} 0", angle.cos(), angle.sin());
        let _ = write!(face, " {}", k + 1);
    }
    place.write("a.obj", &(text + &face));
    let start = Instant::now();
    assert_eq!(
        place.drape("inspect a.obj --json").well().json()["faces"],
        1
    );
    assert!(start.elapsed() < AT_ONCE);
}

#[test]
fn coincident_faces_as_a_target() {
    for faces in [
        &QUADS[..],
        &["1 4 3", "5 6 7", "1 2 6", "2 3 7", "3 4 8", "4 1 5"],
    ] {
        let place = Workplace::new();
        place.write("target.obj", &coincident(faces));
        let start = Instant::now();
        let line = "transfer source.obj target.obj --config short.toml --initial affine -o out.obj";
        place.drape(line).well();
        assert!(start.elapsed() < AT_ONCE, "{:?}", start.elapsed());
    }
}

#[test]
fn coincident_faces_as_a_source() {
    let place = Workplace::new();
    place.write("source.obj", &coincident(&QUADS));
    let start = Instant::now();
    let refused = place.drape("transfer source.obj target.ply -o out.obj");
    assert_refused(&refused, &["source.obj", "face 0", "50000 times"]);
    place.drape("inspect source.obj").well();
    assert!(start.elapsed() < AT_ONCE, "{:?}", start.elapsed());
}

#[test]
fn a_thousand_landmarks_on_eight_vertices() {
    let place = Workplace::new();
    place.write(
        "source.obj",
        &(CUBE.to_owned() + &QUADS.map(|f| format!("f {f}\n")).concat()),
    );
    let corners = CUBE.lines().map(|line| line.trim_start_matches('v'));
    let lines = corners.enumerate().cycle().take(1000);
    let text: String = lines
        .map(|(row, corner)| format!("{row}{corner}\n"))
        .collect();
    place.write("lm.txt", &text);
    let start = Instant::now();
    let line = "transfer source.obj source.obj -l lm.txt --config short.toml -o out.obj";
    let ended = place.drape(line).well();
    assert!(ended.stderr.lines().count() < 50, "{}", ended.stderr);
    assert!(ended
        .stderr
        .contains("more pairs of landmarks share places"));
    assert!(start.elapsed() < AT_ONCE, "{:?}", start.elapsed());
}

#[cfg(unix)]
#[test]
fn a_device_without_an_end() {
    let place = Workplace::new();
    assert_refused(&place.drape("inspect /dev/zero"), &["/dev/zero", "device"]);
}
