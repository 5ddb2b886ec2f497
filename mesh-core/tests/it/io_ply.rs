//! PLY files survive, in any encoding.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use mesh_core::io::Place;
use mesh_core::Vector3;

use crate::io_support::{bent, check_round_trip, file, refusal, rest, written, written_text};

/// A square pyramid's slope with odd columns: names, lists before positions, strips, edges, comments.
const RICH: &str = "ply\nformat ascii 1.0\ncomment one\\\nobj_info two\nelement vertex 4\nproperty uchar red\n\
property list uchar short tags\nproperty double x\nproperty float nx\nproperty float ny\nproperty float nz\n\
property float y\nproperty float z\ncomment three\nproperty float s\nelement empty 1000000000000\nelement face 2\n\
property list uchar float texcoord\nproperty list uint8 int32 corners\nproperty char flag\nelement edge 1\n\
property int vertex1\nproperty int vertex2\nend_header\n\
255 2 -1 7 0.0 0 0 1 0 0 .5\n0 0 1 0 0 1 0 0 nan\n0 1 4 1 0 0 1 1 0 .5\n9 0 0 0 0 1 1 1e-1 .5\n\
0 4 0 1 2 3 -1\n2 0.5 0.5 3 0 1 2 +1\n0 1\n";

#[test]
fn ascii_with_odd_columns() {
    check_round_trip("rich.ply", RICH.as_bytes());
    let read = file("rich.ply", RICH);
    assert_eq!(read.soup().faces, [vec![0, 1, 2, 3], vec![0, 1, 2]]);
    let contents = read.contents();
    assert_eq!(
        (contents.n_comments, contents.n_colors, contents.n_normals),
        (2, 4, 4)
    );
    assert_eq!((contents.n_lines_and_points, contents.n_uvs), (1, 4));

    let mut x = rest(&read);
    x.as_mut_slice()[2].x = 8.0;
    let text = written_text(&read, &x);
    assert!(text.contains("\n0 1 4 8 "), "{text}");
    let same = |a: &str, b: &str| a.lines().zip(b.lines()).filter(|(a, b)| a == b).count();
    assert_eq!(
        same(&text, RICH),
        RICH.lines().count() - 4,
        "only vertices differ"
    );
}

/// RICH in a binary encoding, with the coordinates of `y` as `y_type`.
fn binary(is_big: bool, y_type: &str) -> Vec<u8> {
    let order = if is_big {
        "binary_big_endian"
    } else {
        "binary_little_endian"
    };
    let (header, body) = RICH.split_once("end_header\n").unwrap();
    let header = header
        .replace("ascii", order)
        .replace("float y", &format!("{y_type} y"));
    let mut out = format!("{header}end_header\n").into_bytes();
    for (row, line) in body.lines().enumerate() {
        let words: Vec<&str> = line.split(' ').collect();
        let list_end = |at: usize| at + 1 + words[at].parse::<usize>().unwrap();
        let mut kinds: Vec<&str> = Vec::new();
        match row {
            0..4 => {
                kinds.extend(["u8", "u8"]);
                kinds.resize(list_end(1), "short");
                kinds.extend([
                    "double", "float", "float", "float", y_type, "float", "float",
                ]);
            }
            4..6 => {
                kinds.push("u8");
                kinds.resize(list_end(0), "float");
                kinds.push("u8");
                kinds.resize(list_end(list_end(0)), "int");
                kinds.push("i8");
            }
            _ => kinds.extend(["int", "int"]),
        }
        for (kind, word) in kinds.iter().zip(&words) {
            let mut bytes = encoded(kind, word.parse().unwrap());
            if is_big {
                bytes.reverse();
            }
            out.extend(bytes);
        }
    }
    out
}

fn encoded(kind: &str, x: f64) -> Vec<u8> {
    match kind {
        "u8" => vec![x as u8],
        "i8" => vec![x as i8 as u8],
        "short" => (x as i16).to_le_bytes().to_vec(),
        "int" => (x as i32).to_le_bytes().to_vec(),
        "float" => (x as f32).to_le_bytes().to_vec(),
        _ => x.to_le_bytes().to_vec(),
    }
}

#[test]
fn binary_in_both_orders() {
    let ascii = file("rich.ply", RICH);
    for is_big in [false, true] {
        let bytes = binary(is_big, "float");
        check_round_trip("rich.ply", &bytes);
        let read = file("rich.ply", &bytes);
        assert_eq!(read.soup().faces, ascii.soup().faces);
        assert_eq!(read.contents(), ascii.contents());
        assert_eq!(written(&read, &bent(&read)).len(), bytes.len());
    }
}

#[test]
fn whole_number_columns_become_doubles_when_vertices_move() {
    for is_big in [false, true] {
        let bytes = binary(is_big, "short");
        let read = file("whole.ply", &bytes);
        assert_eq!(written(&read, &rest(&read)), bytes);
        let mut x = rest(&read);
        x.as_mut_slice()[0].y = 1.0 / 3.0;
        let moved = file("whole.ply", written(&read, &x));
        assert_eq!(moved.soup().positions, x.as_slice());
        assert_eq!(moved.soup().faces, read.soup().faces);
    }
}

#[test]
fn strips_become_triangles_that_turn_alike() {
    let text = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                element tristrips 1\nproperty list int int vertex_indices\nend_header\n\
                0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 0 1 2\n";
    let read = file("strips.ply", text);
    assert_eq!(read.soup().faces, [[0, 1, 2], [2, 1, 3], [0, 1, 2]]);
    check_round_trip("strips.ply", text.as_bytes());
}

#[test]
fn faces_may_come_first_and_lines_may_end_in_two_bytes() {
    let text = "ply\r\nformat ascii 1.0\r\nelement face 1\r\nproperty list uchar int vertex_index\r\nelement vertex 3\r\n\
                property float z\r\nproperty float y\r\nproperty float x\r\nend_header\r\n3 0 1 2\r\n1 2 3\r\n4 5 6\r\n7 8 0\r\n";
    let read = file("first.ply", text);
    assert_eq!(read.soup().positions[0], [3.0, 2.0, 1.0].into());
    check_round_trip("first.ply", text.as_bytes());
}

#[test]
fn normals_of_a_cloud_are_read_and_kept() {
    let text = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n\
                property float nx\nproperty float ny\nproperty float nz\nend_header\n0 0 0 0 2 0\n";
    let read = file("cloud.ply", text);
    assert_eq!(read.vertex_normals().unwrap(), [Vector3::y()]);
    assert!(written_text(&read, &bent(&read)).ends_with(" 0 2 0\n"));
}

fn with(from: &str, to: &str) -> String {
    assert!(RICH.contains(from));
    RICH.replacen(from, to, 1)
}

#[test]
fn each_fault_of_a_text_is_told() {
    for (text, says) in [
        (
            with("vertex 4", "vertex 4000000000"),
            "4000000000 rows of `vertex` are promised",
        ),
        (with("format ascii 1.0\n", ""), "a `format` line"),
        (
            with("end_header", "end_of_header"),
            ":24: expected a line of a PLY header",
        ),
        (with("property float z\n", ""), "without `x`, `y` and `z`"),
        (
            with("property double x", "property quad x"),
            "a type like uchar",
        ),
        (
            with("\n0 4 0 1 2 3", "\n0 4 0 1 2 4"),
            ":29: a face names vertex 4, but there are 4",
        ),
        (with("\n0 4 0 1 2 3", "\n0 4 0 1 2 -3"), "names vertex -3"),
        (
            with("\n0 4 0 1 2 3", "\n0 4000000000 0 1 2 3"),
            "items of a list are promised",
        ),
        (
            with("\n0 4 0 1 2 3", "\n0 -4 0 1 2 3"),
            "the length of a list",
        ),
        (
            with("\n0 4 0 1 2 3", "\n0 4 0 1 2 x"),
            ":29: expected a number, found `x`",
        ),
        (
            with("0.0 0 0 1 0 0 .5", "nan 0 0 1 0 0 .5"),
            "`nan` is not a number",
        ),
        (
            "ply\nformat ascii 1.0\nelement vertex 1".to_owned(),
            "ends where `end_header`",
        ),
        (
            "ply\nproperty int x\nend_header\n".to_owned(),
            "an `element` line before",
        ),
    ] {
        let message = refusal("bad.ply", text).to_string();
        assert!(message.contains(says), "{message}");
    }
}

#[test]
fn each_fault_of_a_binary_names_its_element() {
    let bytes = binary(false, "float");
    let body = bytes
        .windows(11)
        .position(|w| w == b"end_header\n")
        .unwrap()
        + 11;
    let mut bad = bytes.clone();
    bad[body + 6..body + 14].copy_from_slice(&f64::NAN.to_le_bytes());
    let error = refusal("bad.ply", &bad);
    let place = |element: &str, row| Place::Row {
        element: element.to_owned(),
        row,
    };
    assert_eq!(error.place, place("vertex", 0), "{error}");

    let error = refusal("bad.ply", &bytes[..bytes.len() - 1]);
    assert!(
        error.to_string().contains("1 rows of `edge` are promised"),
        "{error}"
    );
    let mut bad = bytes.clone();
    let edge = bytes.len() - 8;
    bad[edge - 5] = 200;
    let error = refusal("bad.ply", &bad);
    assert_eq!(error.place, place("face", 1), "{error}");
}
