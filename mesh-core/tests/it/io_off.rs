//! OFF files and their kin survive.

use mesh_core::io::{Format, Place};
use mesh_core::Vector3;

use crate::io_support::{check_round_trip, file, refusal, rest, written_text};

const PLAIN: &str = "OFF # a comment\n# another\n\n4 2 0\n0 0 0\n1 0 0 255 0 0\n\n1 1 0 # corner\n0 1 0\n3 0 1 2 0.5 0.5 0.5\n3 0 2 3\n";

#[test]
fn comments_and_colours_survive() {
    check_round_trip("plain.off", PLAIN.as_bytes());
    let read = file("plain.off", PLAIN);
    assert_eq!(
        (read.soup().positions.len(), &read.soup().faces[1]),
        (4, &vec![0, 2, 3])
    );
    let mut x = rest(&read);
    x.as_mut_slice()[1].y = -2.5;
    assert_eq!(
        written_text(&read, &x),
        PLAIN.replace("1 0 0 255 0 0", "1 -2.5 0 255 0 0")
    );
}

#[test]
fn every_kind_is_read_by_its_mark() {
    for head in ["OFF", "COFF", "NOFF", "STOFF", "STCNOFF"] {
        let text = format!(
            "{head}\n3 1 0\n0 0 0 0 0 1 .5 .5\n1 0 0 0 0 1 .5 .5\n0 1 0 0 0 1 .5 .5\n3 0 1 2\n"
        );
        let read = file("kind.anything", &text);
        assert_eq!(read.format(), Format::Off, "{head}");
        assert_eq!(read.contents().n_normals > 0, head.contains('N'), "{head}");
        assert_eq!(read.contents().n_uvs > 0, head.starts_with("ST"), "{head}");
        check_round_trip("kind.off", text.as_bytes());
    }
    for text in [
        "OFF3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2",
        "3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2",
    ] {
        check_round_trip("loose.off", text.as_bytes());
    }
}

#[test]
fn normals_follow_the_shape() {
    let text = "NOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 -1\n3 0 1 2\n";
    let read = file("n.off", text);
    assert_eq!(
        read.vertex_normals().unwrap(),
        [Vector3::z(), Vector3::z(), -Vector3::z()]
    );
    let x = rest(&read).map(|p| p.coords.zxy().into());
    assert_eq!(
        written_text(&read, &x),
        "NOFF\n3 1 0\n0 0 0 1 0 0\n0 1 0 1 0 0\n0 0 1 -1 0 0\n3 0 1 2\n"
    );
}

#[test]
fn each_fault_names_its_line() {
    for (text, line, says) in [
        (
            "OFF\n1000000000 2 0\n0 0 0\n",
            3,
            "1000000000 vertices are promised",
        ),
        (
            "OFF\n1 900000000 0\n0 0 0\n3 0 0 0\n",
            4,
            "900000000 faces are promised",
        ),
        (
            "OFF\n1 1 0\n0 0 0\n500000000 0 0 0\n",
            4,
            "corners are promised",
        ),
        ("OFF\n1 1 0\n0 0 nan\n3 0 0 0\n", 3, "`nan` is not a number"),
        (
            "OFF\n1 1 0\n0 0 0\n3 0 0 1\n",
            4,
            "names vertex 1, but there are 1",
        ),
        ("OFF\n1 1 0\n0 0 0\n3 0 0 -1\n", 4, "names vertex -1"),
        ("OFF\n1 1 0\n0 0 0\n3 0 0", 4, "3 corners are promised"),
        (
            "OFF\n1 1 0\n0 0 0\n3 0    0",
            4,
            "ends where the row of a vertex",
        ),
        ("OFF\n-1 1 0\n0 0 0\n", 2, "found `-1`"),
        ("4OFF\n1 1 0\n0 0 0 1\n", 1, "more than three dimensions"),
        ("OFF BINARY\n", 1, "binary OFF"),
    ] {
        let error = refusal("bad.off", text);
        let message = error.to_string();
        assert!(
            error.place == Place::Line(line) && message.contains(says),
            "{message}"
        );
    }
}
