//! What the README says of files, line by line.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::io::Write;

use mesh_core::io::Format;

use crate::io_support::{bent, check_round_trip, file, refusal, rest, written, written_text};
use crate::{io_gltf, io_gltf_dialects, io_morphs};

const OBJ: &str = "# made by hand\r\nmtllib a b.mtl\r\no thing\r\nv 0 0 0 1 0.5 0\r\nv 1 0 0 # tip\r\nv 1 1 \\\r\n0\r\nv 0 1 0\r\n\
                   v 0.5 2 0\r\nvt 0 0\r\nvt 1 0\r\nvn 0 0 1\r\ng left arm\r\nusemtl red\r\ns 1\r\nf 1/1/1 2/2/1 3//1\r\n\
                   f -5 -3 -1 -2\r\nf 1 2 3 5 4\r\nl 1 2\r\nunknown statement\r\n";
const PLY: &str = "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                   property float nx\nproperty float ny\nproperty float nz\nproperty uchar red\nelement face 2\n\
                   property list uchar int vertex_indices\nproperty list uchar float texcoord\nelement tristrips 1\n\
                   property list int int vertex_indices\nelement material 1\nproperty int shine\nend_header\n\
                   0 0 0 0 0 1 9\n1 0 0 0 0 1 9\n1 1 0 0 0 1 9\n0 1 0 0 0 1 9\n3 0 1 2 2 .5 .25\n4 0 1 2 3 0\n5 0 1 2 -1 3\n7\n";
const NOFF: &str =
    "STCNOFF\n# by hand\n3 1 0\n0 0 0  0 0 1  1 0 0 1  0.5 0.5\n1 0 0  0 0 1  1 0 0 1  0.5 0.5\n\
                    0 1 0  0 0 1  1 0 0 1  0.5 0.5\n3 0 1 2  255 0 0\n";
const STL: &str = "solid first part\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n\
                   endsolid first part\nsolid second\nfacet normal 0 0 1\nouter loop\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 0\n\
                   endloop\nendfacet\nendsolid second\n";
const XYZ: &str = "x y z red nx ny nz\n0 0 0 9 0 0 1\n1 0 0 8 0 0 1\n";

/// The lines that differ where the vertices move, as they were.
fn changed_lines(name: &str, text: &str) -> Vec<String> {
    check_round_trip(name, text.as_bytes());
    let read = file(name, text);
    let moved = written_text(&read, &bent(&read));
    assert_eq!(moved.lines().count(), text.lines().count(), "{name}");
    let lines = text.lines().zip(moved.lines());
    lines
        .filter(|(a, b)| a != b)
        .map(|(a, _)| a.to_owned())
        .collect()
}

#[test]
fn obj_keeps_all_but_the_numbers_of_v_and_vn() {
    let read = file("a.obj", OBJ);
    assert_eq!(
        read.soup().faces,
        [vec![0, 1, 2], vec![0, 2, 4, 3], vec![0, 1, 2, 4, 3]]
    );
    let changed = changed_lines("a.obj", OBJ);
    assert_eq!(changed.len(), 7);
    let is_allowed =
        |line: &String| line.starts_with("v ") || line.starts_with("vn ") || line == "0";
    assert!(changed.iter().all(is_allowed), "{changed:?}");
    let moved = written_text(&read, &bent(&read));
    assert!(moved.contains(" 1 0.5 0\r\n") && moved.contains(" # tip\r\n"));
}

#[test]
fn ply_keeps_every_other_element_property_and_comment_and_the_encoding() {
    let read = file("a.ply", PLY);
    assert_eq!(
        read.soup().faces,
        [vec![0, 1, 2], vec![0, 1, 2, 3], vec![0, 1, 2]]
    );
    let changed = changed_lines("a.ply", PLY);
    assert_eq!(changed.len(), 4);
    assert!(
        changed.iter().all(|line| line.ends_with(" 0 0 1 9")),
        "{changed:?}"
    );
    for is_big in [false, true] {
        let bytes = binary_ply(is_big);
        check_round_trip("a.ply", &bytes);
        let read = file("a.ply", &bytes);
        let moved = written(&read, &bent(&read));
        let changed: Vec<usize> = (0..bytes.len()).filter(|&k| bytes[k] != moved[k]).collect();
        let vertices = bytes.len() - 13 - 3 * 13;
        assert_eq!(bytes.len(), moved.len());
        assert!(changed
            .iter()
            .all(|&k| k >= vertices && k < bytes.len() - 13 && (k - vertices) % 13 < 12));
    }
}

/// Three vertices with a colour each, and a triangle.
fn binary_ply(is_big: bool) -> Vec<u8> {
    let order = if is_big { "big" } else { "little" };
    let mut out = format!(
        "ply\nformat binary_{order}_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
         property uchar red\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    )
    .into_bytes();
    for p in [[0f32, 0., 0.], [1., 0., 0.], [0., 1., 0.]] {
        p.iter().for_each(|c| {
            out.extend(if is_big {
                c.to_be_bytes()
            } else {
                c.to_le_bytes()
            })
        });
        out.push(200);
    }
    out.push(3);
    [0u32, 1, 2].iter().for_each(|v| {
        out.extend(if is_big {
            v.to_be_bytes()
        } else {
            v.to_le_bytes()
        })
    });
    out
}

#[test]
fn off_and_its_kin_keep_colours_uvs_and_comments() {
    let plain = |keyword: &str, columns: &str| {
        let row = |p: &str| format!("{p}{columns}\n");
        format!(
            "{keyword}\n3 1 0\n{}{}{}3 0 1 2\n",
            row("0 0 0"),
            row("1 0 0"),
            row("0 1 0")
        )
    };
    for (keyword, columns) in [
        ("OFF", ""),
        ("COFF", " 1 0 0 1"),
        ("NOFF", " 0 0 1"),
        ("STOFF", " 0.5 0.5"),
    ] {
        let text = plain(keyword, columns);
        assert_eq!(file("a.off", &text).soup().faces, [[0, 1, 2]]);
        assert_eq!(changed_lines("a.off", &text).len(), 3);
    }
    let changed = changed_lines("a.off", NOFF);
    assert_eq!(changed.len(), 3);
    let read = file("a.off", NOFF);
    let moved = written_text(&read, &bent(&read));
    assert_eq!(moved.matches("  1 0 0 1  0.5 0.5").count(), 3);
    assert!(moved.contains("# by hand") && moved.contains("  255 0 0"));
}

#[test]
fn stl_keeps_solids_attribute_bytes_and_header() {
    let read = file("a.stl", STL);
    assert_eq!(
        read.soup().positions.len(),
        4,
        "equal corners become one vertex"
    );
    let changed = changed_lines("a.stl", STL);
    let is_allowed = |line: &String| line.starts_with("vertex") || line.starts_with("facet normal");
    assert!(changed.iter().all(is_allowed), "{changed:?}");
    let triangle = file("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let mut bytes = triangle.to_bytes("b.stl", &rest(&triangle)).unwrap();
    bytes[..6].copy_from_slice(b"header");
    let n = bytes.len();
    bytes[n - 2..].copy_from_slice(&[7, 8]);
    check_round_trip("b.stl", &bytes);
    let read = file("b.stl", &bytes);
    let moved = written(&read, &bent(&read));
    assert_eq!(
        (&moved[..84], &moved[n - 2..]),
        (&bytes[..84], &[7u8, 8][..])
    );
}

#[test]
fn gltf_keeps_nodes_uvs_skins_materials_animations_extras_and_morph_targets() {
    let kept = [
        "\"skins\"",
        "\"nodes\"",
        "\"materials\"",
        "\"animations\"",
        "\"extras\"",
        "\"targets\"",
    ];
    for bytes in [io_gltf::glb(), io_morphs::glb()] {
        let read = file("a.glb", &bytes);
        let moved = written(&read, &bent(&read));
        let json = |bytes: &[u8]| {
            let n = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
            String::from_utf8(bytes[20..20 + n].to_vec()).unwrap()
        };
        let (before, after) = (json(&bytes), json(&moved));
        let lines = before
            .lines()
            .zip(after.lines())
            .filter(|(a, b)| a.trim_end() != b.trim_end());
        assert!(lines
            .into_iter()
            .all(|(a, _)| a.contains("\"min\"") && a.contains("VEC3")));
        for key in kept.iter().filter(|key| before.contains(*key)) {
            assert!(after.contains(key), "{key}");
        }
    }
}

#[test]
fn points_between_blanks_commas_or_semicolons_keep_all_other_columns() {
    for text in [
        XYZ.to_owned(),
        XYZ.replace(' ', ","),
        XYZ.replace(' ', ";"),
        XYZ.replace(' ', "\t"),
    ] {
        let read = file("a.xyz", &text);
        assert_eq!(
            (
                read.soup().positions.len(),
                read.vertex_normals().map(|n| n.len())
            ),
            (2, Some(2))
        );
        assert_eq!(changed_lines("a.xyz", &text).len(), 2);
        let separator = &text[1..2];
        let kept = [
            separator, "9", separator, "0", separator, "0", separator, "1\n",
        ]
        .concat();
        assert!(written_text(&read, &bent(&read)).contains(&kept));
    }
}

#[test]
fn any_file_may_be_packed_with_gzip() {
    let glb = io_gltf::glb();
    for (name, bytes) in [
        ("a.obj", OBJ.as_bytes()),
        ("a.ply", PLY.as_bytes()),
        ("a.off", NOFF.as_bytes()),
        ("a.stl", STL.as_bytes()),
        ("a.xyz", XYZ.as_bytes()),
        ("a.glb", &glb),
    ] {
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        encoder.write_all(bytes).unwrap();
        let packed = encoder.finish().unwrap();
        let read = file(&format!("{name}.gz"), &packed);
        assert_eq!(read.soup(), file(name, bytes).soup());
        assert_eq!(read.to_bytes(name, &rest(&read)).unwrap(), bytes);
    }
}

#[test]
fn coordinates_that_did_not_change_keep_their_very_text() {
    let read = file("a.obj", "v 1.50 -0.0 3e0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let mut x = rest(&read);
    x.as_mut_slice()[0].z = 4.0;
    assert_eq!(
        written_text(&read, &x),
        "v 1.50 -0.0 4\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
    );
}

#[test]
fn what_is_compressed_is_refused_with_advice() {
    for name in ["KHR_draco_mesh_compression", "EXT_meshopt_compression"] {
        let list = format!(r#""extensionsUsed": ["{name}"], "asset""#);
        let json = io_gltf_dialects::with(&[(r#""asset""#, &list)]);
        let message = refusal("a.gltf", json).to_string();
        let expected = format!("a.gltf: a glTF compressed with {name} cannot be read; save it without mesh compression");
        assert_eq!(message, expected);
    }
}

#[test]
fn what_formats_hand_on_and_hold() {
    let read = file("a.obj", OBJ);
    let x = rest(&read);
    let with_uvs = |name: &str| {
        file(name, read.to_bytes(name, &x).unwrap())
            .contents()
            .has_uvs()
    };
    assert!(with_uvs("a.glb") && with_uvs("a.gltf"));
    assert!(["a.ply", "a.off", "a.stl"]
        .iter()
        .all(|name| !with_uvs(name)));
    for (name, format, corners) in [
        ("a.ply", Format::Ply, 5),
        ("a.off", Format::Off, 5),
        ("a.stl", Format::Stl, 3),
        ("a.glb", Format::Glb, 3),
        ("a.gltf", Format::Gltf, 3),
        ("a.xyz", Format::Xyz, 0),
    ] {
        let converted = file(name, read.to_bytes(name, &x).unwrap());
        assert_eq!(converted.format(), format);
        let most = converted
            .soup()
            .faces
            .iter()
            .map(Vec::len)
            .max()
            .unwrap_or(0);
        assert_eq!(most, corners, "{name}");
        assert!(read.lost_in(name).is_some_and(|line| !line.contains('\n')));
    }
    assert_eq!(read.lost_in("b.obj"), None);
}
