//! Skinned glTF meshes are read in the pose that viewers show, and written back into their own frame.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use mesh_core::io::{Finding, MeshFile, Morphs};
use mesh_core::{Point3, Positions, Vector3};

use crate::io_support::{file, glb_file, rest, written};

/// A triangle of two joints: the first shifts by (0, 0, 5), the second turns a quarter about z. The third corner
/// follows both by half. The node of the mesh is shifted, which a skinned mesh ignores.
const JSON: &str = r#"{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
  "nodes": [{"mesh": 0, "skin": 0, "translation": [7, 7, 7]}, {"children": [2, 3]},
    {"translation": [0, 0, 5]}, {"rotation": [0, 0, 0.70710678, 0.70710678]}],
  "skins": [{"joints": [2, 3], "inverseBindMatrices": 4}],
  "meshes": [{"name": "one", "primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1, "JOINTS_0": 2, "WEIGHTS_0": 3},
    "targets": [{"POSITION": 5}]}]}],
  "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
    {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC3"},
    {"bufferView": 2, "componentType": 5121, "count": 3, "type": "VEC4"},
    {"bufferView": 3, "componentType": 5126, "count": 3, "type": "VEC4"},
    {"bufferView": 4, "componentType": 5126, "count": 2, "type": "MAT4"},
    {"componentType": 5126, "count": 3, "type": "VEC3"}],
  "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 36},
    {"buffer": 0, "byteOffset": 72, "byteLength": 12}, {"buffer": 0, "byteOffset": 84, "byteLength": 48},
    {"buffer": 0, "byteOffset": 132, "byteLength": 128}],
  "buffers": [{"byteLength": 260}]}"#;

fn buffer() -> Vec<u8> {
    let mut out = Vec::new();
    let mut push = |numbers: &[f32]| numbers.iter().for_each(|c| out.extend(c.to_le_bytes()));
    push(&[0., 0., 0., 1., 0., 0., 0., 1., 0.]);
    push(&[0., 0., 1., 0., 0., 1., 0., 0., 1.]);
    push(&[0.; 3]);
    push(&[1., 0., 0., 0., 1., 0., 0., 0., 0.5, 0.5, 0., 0.]);
    for _ in 0..2 {
        push(&[
            1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.,
        ]);
    }
    out[72..84].copy_from_slice(&[0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0]);
    out
}

fn read(json: &str) -> MeshFile {
    file("a.glb", glb_file(json, &buffer()))
}

fn is_close(a: &[Point3], b: &[Point3]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).norm() < 1e-5)
}

#[test]
fn joints_put_the_vertices_where_viewers_show_them() {
    let read = read(JSON);
    // v₂ = ½ (v + (0, 0, 5)) + ½ R v.
    let posed = [[0., 0., 5.], [0., 1., 0.], [-0.5, 0.5, 2.5]].map(Point3::from);
    assert!(
        is_close(&read.soup().positions, &posed),
        "{:?}",
        read.soup()
    );
    assert_eq!(read.findings(), []);
    assert_eq!(read.contents().n_skins, 1);
    assert!((read.vertex_normals().unwrap()[1] - Vector3::z()).norm() < 1e-6);
}

#[test]
fn what_is_written_shows_the_new_shape_in_the_same_pose() {
    let mut read = read(JSON);
    let bytes = written(&read, &rest(&read));
    assert_eq!(bytes, glb_file(JSON, &buffer()));
    let x: Positions = [[0., 0., 6.], [0., 3., 1.], [-0.5, 0.5, 2.5]]
        .map(Point3::from)
        .into_iter()
        .collect();
    let mut x = x;
    x.as_mut_slice()[2] = read.soup().positions[2];
    for morphs in [Morphs::Keep, Morphs::Carry, Morphs::Drop] {
        read.set_morphs(morphs);
        read.check_writable("a.glb").unwrap();
        let moved = file("a.glb", written(&read, &x));
        assert!(
            is_close(&moved.soup().positions, x.as_slice()),
            "{:?}",
            moved.soup()
        );
    }
    // In the mesh's own frame the second corner went from (1, 0, 0) to (3, 0, 1), and the third did not move.
    read.set_morphs(Morphs::Keep);
    let written = written(&read, &x);
    let data = &written[written.len() - 260..];
    let float = |at: usize| f32::from_le_bytes(data[at..at + 4].try_into().unwrap());
    let second = Point3::from([12, 16, 20].map(|at| f64::from(float(at))));
    assert!((second - Point3::new(3., 0., 1.)).norm() < 1e-5, "{second}");
    assert_eq!(&data[24..36], &buffer()[24..36]);
    assert_eq!(&data[72..], &buffer()[72..]);
}

#[test]
fn a_pose_that_only_rounding_tells_from_the_mesh_changes_no_bit() {
    let json = JSON
        .replace(
            r#"{"translation": [0, 0, 5]}"#,
            r#"{"translation": [0, 0, 1e-7]}"#,
        )
        .replace(
            r#"{"rotation": [0, 0, 0.70710678, 0.70710678]}"#,
            r#"{"rotation": [0, 0, 1e-8, 1]}"#,
        );
    let corners = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]].map(Point3::from);
    assert_eq!(read(&json).soup().positions, corners);
}

#[test]
fn a_skin_that_cannot_be_followed_is_told() {
    let unfollowed = Finding::SkinNotApplied {
        mesh: "one".to_owned(),
    };
    for (from, to) in [
        (r#""joints": [2, 3]"#, r#""joints": [2]"#),
        (r#""joints": [2, 3]"#, r#""joints": [2, 99]"#),
        (r#""nodes": [0, 1]"#, r#""nodes": [0]"#),
        (r#", "JOINTS_0": 2, "WEIGHTS_0": 3"#, ""),
        (
            r#""componentType": 5126, "count": 2, "type": "MAT4""#,
            r#""componentType": 5126, "count": 1, "type": "MAT4""#,
        ),
    ] {
        assert!(JSON.contains(from));
        let read = read(&JSON.replace(from, to));
        assert_eq!(read.findings(), std::slice::from_ref(&unfollowed), "{to}");
        assert_eq!(read.soup().positions[1], Point3::new(1., 0., 0.));
    }
}
