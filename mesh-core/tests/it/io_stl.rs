//! STL files survive, text and binary.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use mesh_core::io::{Format, MeshFile};
use mesh_core::{shapes, Point3, PolygonSoup};

use crate::io_support::{bent, check_round_trip, file, refusal, rest, written, written_text};

const TEXT: &str = "solid two parts\n  facet normal 0 0 1\n    outer loop\n      vertex 0 0 0\n      vertex 1 0 0\n\
      vertex 0 1 0\n    endloop\n  endfacet\nendsolid two parts\nsolid\nFACET NORMAL 0 0 1\nOUTER LOOP\n\
      VERTEX 1.0 0 -0.0\nVERTEX 1 1 0\nVERTEX 0 1e0 0\nENDLOOP\nENDFACET\nendsolid";

/// A binary file whose header is `header`.
fn binary(header: &str, soup: &PolygonSoup) -> Vec<u8> {
    let mut out = header.as_bytes().to_vec();
    out.resize(80, 0);
    out.extend((soup.faces.len() as u32).to_le_bytes());
    for (k, face) in soup.faces.iter().enumerate() {
        out.extend([0; 12]);
        for &v in face {
            let p: Point3 = soup.positions[v as usize];
            p.iter().for_each(|&c| out.extend((c as f32).to_le_bytes()));
        }
        out.extend((k as u16).to_le_bytes());
    }
    out
}

#[test]
fn equal_corners_are_one_vertex() {
    let read = file("two.stl", TEXT);
    assert_eq!(read.soup().faces, [[0, 1, 2], [1, 3, 2]]);
    let solids: Vec<_> = read
        .contents()
        .objects
        .iter()
        .map(|o| (o.name.as_str(), o.n_faces()))
        .collect();
    assert_eq!(solids, [("two parts", 1), ("", 1)]);
    check_round_trip("two.stl", TEXT.as_bytes());

    let mut x = rest(&read);
    x.as_mut_slice()[3].x = 2.0;
    assert_eq!(
        written_text(&read, &x),
        TEXT.replace("VERTEX 1 1 0", "VERTEX 2 1 0"),
        "the normal is as it was"
    );
    x.as_mut_slice()[0].z = -1.0;
    let text = written_text(&read, &x);
    assert!(
        text.contains("vertex 0 0 -1") && text.contains("FACET NORMAL 0 0 1\n"),
        "{text}"
    );
    assert!(!text.contains("facet normal 0 0 1"), "{text}");
}

#[test]
fn binary_is_read_by_its_length_even_where_it_begins_like_a_text() {
    for header in ["made somewhere", "solid made somewhere\nfacet normal"] {
        let bytes = binary(header, &shapes::icosphere(1));
        let read = file("any.name", &bytes);
        assert_eq!(read.format(), Format::Stl);
        assert_eq!(
            (read.soup().positions.len(), read.soup().faces.len()),
            (42, 80)
        );
        assert!(read.soup().clone().into_halfedge().unwrap().0.n_edges() == 120);
        check_round_trip("any.stl", &bytes);
        let moved = written(&read, &bent(&read));
        let attribute = |bytes: &[u8], row: usize| bytes[84 + 50 * row + 48];
        assert_eq!(
            (moved.len(), attribute(&moved, 7), &moved[..84]),
            (bytes.len(), 7, &bytes[..84])
        );
        assert!(moved[84..96].iter().any(|&b| b != 0), "the normal is new");
    }
}

#[test]
fn facets_without_corners_and_bytes_behind_the_last_are_kept() {
    let text = "solid a\nfacet normal 0 0 0\nendfacet\nfacet\nvertex 1 2 3\nendfacet\nendsolid\n";
    assert_eq!(file("a.stl", text).soup().faces, [vec![], vec![0]]);
    check_round_trip("a.stl", text.as_bytes());
    let mut bytes = binary("x", &shapes::tetrahedron());
    bytes.extend(b"more");
    check_round_trip("a.stl", &bytes);
}

#[test]
fn faults() {
    let mut bytes = binary("x", &shapes::tetrahedron());
    bytes[84 + 50 + 12..84 + 50 + 16].copy_from_slice(&f32::NAN.to_le_bytes());
    for (bytes, says) in [
        (
            bytes.clone(),
            "bad.stl: triangle 1 (counted from 0): the coordinate `NaN`",
        ),
        (bytes[..150].to_vec(), "4 triangles are promised"),
        (bytes[..50].to_vec(), "ends where the number of triangles"),
        (
            TEXT.replace("OUTER", "INNER").into_bytes(),
            "bad.stl:12: expected a word of an STL file, found `INNER`",
        ),
        (
            TEXT.replace("1e0", "inf").into_bytes(),
            "bad.stl:15: the coordinate `inf`",
        ),
        (TEXT.replace("1e0 0", "1").into_bytes(), "found `ENDLOOP`"),
    ] {
        let message = refusal("bad.stl", bytes).to_string();
        assert!(message.contains(says), "{message}");
    }
}

#[test]
fn it_converts_to_and_from_others() {
    let stl = MeshFile::from_bytes("a.stl", TEXT.into()).unwrap();
    assert!(stl.check_writable("b.stl").is_ok());
    assert_eq!(
        file("a.obj", stl.to_bytes("a.obj", &rest(&stl)).unwrap()).soup(),
        stl.soup()
    );
    let obj = file("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
    let bytes = obj.to_bytes("a.stl", &rest(&obj)).unwrap();
    assert_eq!(bytes.len(), 84 + 2 * 50);
    let read = file("a.stl", bytes);
    assert_eq!(read.format(), Format::Stl);
    assert_eq!(
        (read.soup().positions.len(), read.soup().faces.len()),
        (4, 2)
    );
}
