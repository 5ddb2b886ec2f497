//! Morph targets of glTF files: carried to the new shape, kept, or dropped.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use mesh_core::io::{MeshFile, Morphs, WriteError};
use mesh_core::{Point3, Positions, Vector3};

use crate::io_support::{file, glb_file, rest, written};

/// A square of two triangles, split along its diagonal, under a node that doubles and shifts it. Its first morph target
/// lifts the corners and leans their normals; its second moves one corner, by a sparse accessor.
const JSON: &str = r#"{"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}],
  "nodes": [{"mesh": 0, "scale": [2, 2, 2], "translation": [1, 0, 0], "weights": [0, 1]}],
  "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}, "targets": [{"POSITION": 2, "NORMAL": 3}, {"POSITION": 4}]}],
    "weights": [0.5, 0], "extras": {"targetNames": ["smile", "blink"]}}],
  "animations": [{"samplers": [{"input": 5, "output": 6}], "channels": [{"sampler": 0, "target": {"node": 0, "path": "weights"}}]}],
  "accessors": [
    {"bufferView": 0, "componentType": 5126, "count": 6, "type": "VEC3", "min": [0,0,0], "max": [1,1,0]},
    {"bufferView": 1, "componentType": 5126, "count": 6, "type": "VEC3"},
    {"bufferView": 2, "componentType": 5126, "count": 6, "type": "VEC3", "min": [0,0,0.25], "max": [0,0,0.5]},
    {"bufferView": 3, "componentType": 5126, "count": 6, "type": "VEC3"},
    {"componentType": 5126, "count": 6, "type": "VEC3", "min": [0,0,0], "max": [0,1,0],
      "sparse": {"count": 1, "indices": {"bufferView": 4, "componentType": 5125}, "values": {"bufferView": 5}}},
    {"bufferView": 4, "componentType": 5126, "count": 1, "type": "SCALAR", "min": [0], "max": [0]},
    {"bufferView": 6, "componentType": 5126, "count": 2, "type": "SCALAR"}],
  "bufferViews": [
    {"buffer": 0, "byteLength": 72}, {"buffer": 0, "byteOffset": 72, "byteLength": 72},
    {"buffer": 0, "byteOffset": 144, "byteLength": 72}, {"buffer": 0, "byteOffset": 216, "byteLength": 72},
    {"buffer": 0, "byteOffset": 288, "byteLength": 4}, {"buffer": 0, "byteOffset": 292, "byteLength": 12},
    {"buffer": 0, "byteOffset": 304, "byteLength": 8}],
  "buffers": [{"byteLength": 312}]}"#;

const POSITIONS: [[f32; 3]; 6] = [
    [0., 0., 0.],
    [1., 0., 0.],
    [1., 1., 0.],
    [0., 0., 0.],
    [1., 1., 0.],
    [0., 1., 0.],
];

fn buffer() -> Vec<u8> {
    let lifts = [0.5f32, 0.25, 0.5, 0.5, 0.5, 0.25].map(|z| [0., 0., z]);
    let normals = [[0f32, 0., 1.]; 6];
    let leans = [[1f32, 0., 0.]; 6];
    let mut out: Vec<u8> = [POSITIONS, normals, lifts, leans]
        .iter()
        .flatten()
        .flatten()
        .flat_map(|c| c.to_le_bytes())
        .collect();
    out.extend(5u32.to_le_bytes());
    out.extend([0f32, 1., 0., 0., 1.].iter().flat_map(|c| c.to_le_bytes()));
    out
}

pub(crate) fn glb() -> Vec<u8> {
    glb_of(JSON)
}

fn glb_of(json: &str) -> Vec<u8> {
    glb_file(json, &buffer())
}

fn document(glb: &[u8]) -> String {
    String::from_utf8(glb[20..glb.len() - 8 - 312].to_vec()).unwrap()
}

/// Three numbers of the buffer, from byte `at` on.
fn vector(glb: &[u8], at: usize) -> Vector3 {
    let data = &glb[glb.len() - 312..];
    Vector3::from([0, 4, 8].map(|k| {
        let raw = data[at + k..at + k + 4].try_into().unwrap();
        f64::from(f32::from_le_bytes(raw))
    }))
}

fn with(morphs: Morphs) -> MeshFile {
    let mut read = file("a.glb", glb());
    read.set_morphs(morphs);
    read
}

/// The scene thrice as large, turned so that x, y, z become y, z, x.
fn turned(read: &MeshFile) -> Positions {
    rest(read).map(|p| Point3::new(3.0 * p.z, 3.0 * p.x, 3.0 * p.y))
}

#[test]
fn targets_are_counted() {
    let read = with(Morphs::Keep);
    let contents = read.contents();
    let counts = (
        contents.n_morph_targets,
        contents.n_animations,
        contents.n_skins,
    );
    assert_eq!(counts, (2, 1, 0));
    let lost = read.lost_in("a.obj").unwrap();
    assert!(
        lost.contains("2 morph targets") && lost.contains("1 animation"),
        "{lost}"
    );
}

#[test]
fn kept_targets_keep_their_bytes() {
    let read = with(Morphs::Keep);
    let (old, new) = (glb(), written(&read, &turned(&read)));
    assert_eq!(old[old.len() - 168..], new[new.len() - 168..]);
    assert!(document(&new).contains(r#""min": [0,0,0.25], "max": [0,0,0.5]"#));
}

#[test]
fn carried_targets_turn_and_grow_with_the_shape() {
    let read = with(Morphs::Carry);
    assert_eq!(written(&read, &rest(&read)), glb(), "nothing moved");

    read.check_writable("a.glb").unwrap();
    let new = written(&read, &turned(&read));
    assert!(
        (vector(&new, 144) - Vector3::new(1.5, 0.0, 0.0)).norm() < 1e-6,
        "a lift along z goes along x"
    );
    assert!((vector(&new, 156) - Vector3::new(0.75, 0.0, 0.0)).norm() < 1e-6);
    assert!(
        (vector(&new, 216)
            - Vector3::new(0.0, 2f64.sqrt().recip(), 0.0)
            - Vector3::new(2f64.sqrt().recip() - 1.0, 0.0, 0.0))
        .norm()
            < 1e-6,
        "the normal leans along y"
    );
    assert!(
        (vector(&new, 292) - Vector3::new(0.0, 0.0, 3.0)).norm() < 1e-6,
        "the sparse one along z"
    );
    let text = document(&new);
    assert!(
        text.contains(r#""min": [0.75,0,0], "max": [1.5,0,0]"#),
        "{text}"
    );
    assert_eq!(
        text.matches(r#""type": "VEC3", "min": [0,0,0], "max": [0,0,3]"#)
            .count(),
        1,
        "{text}"
    );
    assert_eq!(file("a.glb", &new).contents(), read.contents());
}

#[test]
fn the_two_sides_of_a_seam_stay_together_under_every_weight() {
    let read = with(Morphs::Carry);
    let mut x = rest(&read);
    x.as_mut_slice()[1] += Vector3::new(0.5, -1.0, 2.0);
    x.as_mut_slice()[5] += Vector3::new(-2.0, 1.0, 0.0);
    let new = written(&read, &x);
    for [a, b] in [[0, 3], [2, 4]] {
        assert_eq!(vector(&new, 12 * a), vector(&new, 12 * b));
        assert_eq!(vector(&new, 144 + 12 * a), vector(&new, 144 + 12 * b));
        assert_ne!(vector(&new, 144 + 12 * a), Vector3::new(0.0, 0.0, 0.5));
    }
}

#[test]
fn dropped_targets_leave_the_document_and_nothing_else_does() {
    let read = with(Morphs::Drop);
    for x in [rest(&read), turned(&read)] {
        let new = written(&read, &x);
        let text = document(&new);
        for gone in ["\"targets\"", "\"weights\"", "\"animations\""] {
            assert!(!text.contains(gone), "{text}");
        }
        assert!(text.contains("targetNames"));
        let again = file("a.glb", &new);
        assert_eq!(again.soup().faces, read.soup().faces);
        assert_eq!(
            (
                again.contents().n_morph_targets,
                again.contents().n_animations
            ),
            (0, 0)
        );
        assert_eq!(new[new.len() - 168..], glb()[glb().len() - 168..]);
    }
}

#[test]
fn what_cannot_be_carried_is_told_before_the_work() {
    let told = |json: &str| {
        let mut read = file("a.glb", glb_of(json));
        assert!(read.check_writable("a.glb").is_ok());
        read.set_morphs(Morphs::Carry);
        match read.check_writable("a.glb") {
            Err(WriteError::Unsupported { feature, .. }) => feature,
            other => panic!("{other:?}"),
        }
    };
    let quantised = JSON.replace(
        r#""bufferView": 3, "componentType": 5126"#,
        r#""bufferView": 3, "componentType": 5122"#,
    );
    assert!(told(&quantised).contains("quantised"));
    let shared = JSON.replace(r#""NORMAL": 3}, "#, r#""NORMAL": 1}, "#);
    assert!(told(&shared).contains("shares its numbers"));
    let shared = JSON.replace(r#"{"POSITION": 4}"#, r#"{"NORMAL": 2}"#);
    assert!(told(&shared).contains("shares its numbers"));
}
