//! Files that keep less strictly to their formats, as other programs write and read them: read as they are meant, and
//! written back as they were.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use mesh_core::io::{Format, MeshFile};
use mesh_core::Point3;

use crate::io_support::{bent, check_round_trip, file, refusal, rest, written, written_text};

const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                   element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
const STL: &str =
    "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n\
                   endfacet\nendsolid a\n";

fn corners() -> [Point3; 3] {
    [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]].map(Point3::from)
}

/// It is read as one triangle, and survives.
fn check_triangle(name: &str, bytes: impl AsRef<[u8]>) -> MeshFile {
    let read = file(name, &bytes);
    assert_eq!(read.soup().positions, corners(), "{name}");
    assert_eq!(read.soup().faces, [[0, 1, 2]], "{name}");
    check_round_trip(name, bytes.as_ref());
    read
}

#[test]
fn decimal_commas_between_semicolons() {
    let text = "-1,5;-1,5;-1,5\n2;0,25;3;7,5\n";
    let read = file("a.xyz", text);
    let expected = [[-1.5, -1.5, -1.5], [2., 0.25, 3.]].map(Point3::from);
    assert_eq!(read.soup().positions, expected);
    check_round_trip("a.xyz", text.as_bytes());
    let mut x = rest(&read);
    x.as_mut_slice()[1].y = 0.5;
    assert_eq!(written_text(&read, &x), text.replace("0,25", "0,5"));
}

#[test]
fn decimal_commas_between_blanks() {
    let text = "-1,5 -1,5 -1,5\n2 0,25 3\n";
    let read = file("a.xyz", text);
    let expected = [[-1.5, -1.5, -1.5], [2., 0.25, 3.]].map(Point3::from);
    assert_eq!(read.soup().positions, expected);
    check_round_trip("a.xyz", text.as_bytes());
}

#[test]
fn commas_that_may_be_either_are_refused() {
    for text in [
        "1,5;2,5\n",
        "1,2,3;4,5,6\n",
        "1.5;2,5;3\n",
        "0.1,0.2 0.3,0.4 0.5,0.6\n",
    ] {
        let message = refusal("a.xyz", text).to_string();
        assert!(
            message.contains("a.xyz:1: expected either decimal commas"),
            "{message}"
        );
    }
    for text in [
        "1, 2, 3\n",
        "1,2,3\n",
        "1 ,2 ,3\n",
        "1,2,3;\n",
        "1;2;3\n",
        "1,2,3 255,0,0\n",
    ] {
        let read = file("a.xyz", text);
        assert_eq!(read.soup().positions, [Point3::new(1., 2., 3.)], "{text}");
    }
}

#[test]
fn a_face_list_of_floats_is_read() {
    let text = PLY.replace("uchar int", "uchar float");
    check_triangle("a.ply", &text);
    let broken = text.replace("3 0 1 2", "3 0 1 1.5");
    let message = refusal("a.ply", broken).to_string();
    assert!(
        message.contains("a.ply:13: expected the row of a vertex, found `1.5`"),
        "{message}"
    );
}

#[test]
fn faces_without_a_list_of_corners_are_refused() {
    let text = PLY
        .replace("list uchar int vertex_indices", "uchar red")
        .replace("3 0 1 2", "9");
    let message = refusal("a.ply", text).to_string();
    assert!(
        message.contains("without a list `vertex_indices` in its element `face`"),
        "{message}"
    );
}

#[test]
fn rows_of_a_ply_may_have_more_columns_than_its_header_names() {
    let two = PLY.replace("face 1", "face 2");
    let text = two.replace("3 0 1 2\n", "3 0 1 2 255 0 0\n3 2 1 0 0 0 255\n");
    let read = file("a.ply", &text);
    assert_eq!(read.soup().faces, [[0, 1, 2], [2, 1, 0]]);
    check_round_trip("a.ply", text.as_bytes());
    check_triangle("a.ply", PLY.replace("1 0 0\n", "1 0 0 9 9\n"));
    // All rows on one line, and a row on two lines, are as they were.
    let body = PLY.find("0 0 0\n").unwrap();
    check_triangle(
        "a.ply",
        format!("{}{}", &PLY[..body], PLY[body..].replace('\n', " ")),
    );
    check_triangle("a.ply", PLY.replace("3 0 1 2", "3 0 1\n2"));
}

#[test]
fn a_byte_order_mark_is_passed_over() {
    let marked = |text: &str| ["\u{FEFF}", text].concat();
    for (name, text) in [
        ("a.ply", PLY),
        ("a.obj", OBJ),
        ("a.stl", STL),
        ("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
    ] {
        check_triangle(name, marked(text));
    }
}

#[test]
fn lenient_headers_of_ply() {
    check_triangle("a.ply", PLY.replacen("ply\n", "PLY \n", 1));
    check_triangle("a.ply", PLY.replace("vertex 3", "vertex 3.0"));
    check_triangle("a.ply", PLY.replace("uchar int", "uint64 int64"));
    check_triangle("a.ply", PLY.replace("3 0 1 2", "3 0.0 1.0 2.0"));
    let halves: Vec<u8> = [0u16, 0, 0, 0x3C00, 0, 0, 0, 0x3C00, 0]
        .iter()
        .flat_map(|h| h.to_le_bytes())
        .collect();
    let header = &PLY[..PLY.find("0 0 0\n").unwrap()];
    let header = header
        .replace("ascii", "binary_little_endian")
        .replace("float ", "float16 ");
    let bytes = [
        header.as_bytes(),
        &halves,
        &[3],
        &[0u32, 1, 2].map(u32::to_le_bytes).concat(),
    ]
    .concat();
    check_triangle("a.ply", bytes);
}

#[test]
fn obj_in_two_bytes_a_character() {
    for is_big in [false, true] {
        let units = "\u{FEFF}# Löwe\n".encode_utf16().chain(OBJ.encode_utf16());
        let bytes: Vec<u8> = units
            .flat_map(|u| {
                if is_big {
                    u.to_be_bytes()
                } else {
                    u.to_le_bytes()
                }
            })
            .collect();
        let read = check_triangle("a.obj", &bytes);
        assert_eq!(read.contents().n_comments, 1);
        let message = refusal("a.obj", &bytes[..bytes.len() - 1]).to_string();
        assert!(message.contains("UTF-16"), "{message}");
    }
}

#[test]
fn obj_with_zeros_behind_it_and_odd_corners() {
    check_triangle("a.obj", [OBJ.as_bytes(), &[0; 3]].concat());
    check_triangle("a.obj", OBJ.replace("f 1 2 3", "f 1/ 2// 3///"));
    check_triangle("a.obj", ["// exported\nhello world\n", OBJ].concat());
    let message = refusal("a.obj", OBJ.replace("v 1", "v \0 1")).to_string();
    assert!(
        message.contains("binary data in what should be text; is this really an OBJ file"),
        "{message}"
    );
}

#[test]
fn text_stl_with_comments_colours_and_all_on_one_line() {
    for remark in ["# c", "// c", "; c", "color 0.5 0.5 0.5", "COMMENT c"] {
        check_triangle("a.stl", STL.replace("outer", &format!("{remark}\nouter")));
    }
    check_triangle("a.stl", ["# c\n", STL].concat());
    let line = check_triangle("a.stl", STL.replace('\n', " "));
    assert_eq!(line.contents().objects[0].name, "a");
    let two = [STL, STL].concat().replace('\n', " ");
    assert_eq!(file("a.stl", &two).soup().faces.len(), 2);
    check_round_trip("a.stl", two.as_bytes());
    let odd = STL.replacen("solid a\n", "solid facet normal\n", 1);
    assert_eq!(
        check_triangle("a.stl", odd).contents().objects[0].name,
        "facet normal"
    );
    check_triangle("a.stl", STL.replace("vertex 1 0 0", "vertex 1 0 0 255 0 0"));
    check_triangle("a.stl", STL.replace(" normal 0 0 1", ""));
}

#[test]
fn the_content_tells_the_format_whatever_the_extension() {
    use std::io::Write;
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(OBJ.as_bytes()).unwrap();
    let packed = encoder.finish().unwrap();
    let named = ["mtllib a.mtl\no a\n", OBJ].concat();
    for name in [
        "a.stl", "a.ply", "a.off", "a.glb", "a.gltf", "a.xyz", "a.txt", "a",
    ] {
        for bytes in [OBJ.as_bytes(), named.as_bytes(), &packed] {
            let read = file(name, bytes);
            assert_eq!(
                (read.format(), read.soup().faces.len()),
                (Format::Obj, 1),
                "{name}"
            );
        }
        assert_eq!(file(name, PLY).format(), Format::Ply, "{name}");
        assert_eq!(file(name, STL).format(), Format::Stl, "{name}");
    }
    for name in ["a.stl", "a.ply", "a.glb", "a"] {
        assert_eq!(file(name, "0 0 0\n1 2 3\n").format(), Format::Xyz, "{name}");
    }
    // What is written goes by the name.
    let read = file("a.stl", OBJ);
    assert!(!read.keeps_format("b.stl") && read.keeps_format("b.obj"));
    assert_eq!(
        file("b.stl", read.to_bytes("b.stl", &bent(&read)).unwrap()).format(),
        Format::Stl
    );
    assert_eq!(written(&file("a.obj", OBJ), &rest(&read)), OBJ.as_bytes());
}
