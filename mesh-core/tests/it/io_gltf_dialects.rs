//! glTF documents as other programs write them, and what must not be read at all.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use mesh_core::io::{Finding, WriteError};
use mesh_core::Point3;

use crate::io_support::{bent, file, glb_file, refusal, rest, written};

/// One triangle; three `u16` corners behind the positions.
pub(crate) const JSON: &str = r#"{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
  "nodes": [{"mesh": 0}], "meshes": [{"name": "one", "primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
  "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
    {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}],
  "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 6}],
  "buffers": [{"byteLength": 44}]}"#;

pub(crate) fn buffer() -> Vec<u8> {
    let positions = [0f32, 0., 0., 1., 0., 0., 0., 1., 0.];
    let mut out: Vec<u8> = positions.iter().flat_map(|c| c.to_le_bytes()).collect();
    out.extend([0u8, 0, 1, 0, 2, 0, 0, 0]);
    out
}

/// The document with some text replaced.
pub(crate) fn with(changes: &[(&str, &str)]) -> String {
    changes.iter().fold(JSON.to_owned(), |json, (from, to)| {
        assert!(json.contains(from), "{from}");
        json.replace(from, to)
    })
}

fn check_triangle(json: &str) {
    let bytes = glb_file(json, &buffer());
    let read = file("a.glb", &bytes);
    let corners = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]].map(Point3::from);
    assert_eq!(read.soup().positions, corners, "{json}");
    assert_eq!(read.soup().faces, [[0, 1, 2]], "{json}");
    assert_eq!(written(&read, &rest(&read)), bytes);
    let x = bent(&read);
    let moved = written(&read, &x);
    assert_eq!(
        file("a.glb", moved).soup().positions,
        x.as_slice(),
        "{json}"
    );
}

#[test]
fn extras_may_be_anything() {
    for extras in ["3", "\"x\"", "[1, {}]", "null", "true", "{\"a\": []}"] {
        let member = format!(r#""extras": {extras}, "#);
        check_triangle(&with(&[
            (r#"{"version""#, &format!(r#"{{{member}"version""#)),
            (r#"{"mesh": 0}"#, &format!(r#"{{{member}"mesh": 0}}"#)),
            (r#"{"name": "one""#, &format!(r#"{{{member}"name": "one""#)),
        ]));
    }
}

#[test]
fn animations_without_a_node_and_scenes_without_nodes() {
    check_triangle(&with(&[
        (
            r#""meshes""#,
            r#""animations": [{"channels": [{"sampler": 0, "target": {"path": "pointer"}}], "samplers": []}], "meshes""#,
        ),
        (
            r#"[{"nodes": [0]}]"#,
            r#"[{"nodes": [0]}, {"name": "empty"}, {}]"#,
        ),
    ]));
    let empty = with(&[(r#"[{"nodes": [0]}]"#, "[{}]")]);
    assert_eq!(
        file("a.glb", glb_file(&empty, &buffer()))
            .soup()
            .faces
            .len(),
        1
    );
}

#[test]
fn whole_numbers_may_be_written_with_a_point() {
    check_triangle(&with(&[
        (r#""count": 3"#, r#""count": 3.0"#),
        (r#""mesh": 0"#, r#""mesh": 0.0"#),
        ("5126", "5126.0"),
        (r#""byteLength": 36"#, r#""byteLength": 3.6e1"#),
        (r#"[{"nodes": [0]}]"#, r#"[{"nodes": [0.0]}]"#),
    ]));
    let message = refusal(
        "a.glb",
        glb_file(&with(&[(r#""count": 3"#, r#""count": 3.5"#)]), &buffer()),
    )
    .to_string();
    assert_eq!(
        message,
        "a.glb: accessor 0 (counted from 0): expected a whole number, found `3.5`"
    );
}

#[test]
fn documents_with_a_byte_order_mark_and_escaped_keys() {
    let uri = "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIAAAA=";
    let json = with(&[(
        r#"{"byteLength": 44}"#,
        &format!(r#"{{"byteLength": 44, "\u0075ri": "{uri}"}}"#),
    )]);
    let bytes = ["\u{FEFF}", &json].concat();
    let read = file("a.gltf", &bytes);
    assert_eq!(written(&read, &rest(&read)), bytes.as_bytes());
    let x = bent(&read);
    let moved = written(&read, &x);
    assert!(moved.starts_with("\u{FEFF}{".as_bytes()));
    assert_eq!(file("a.gltf", moved).soup().positions, x.as_slice());
}

#[test]
fn version_1_is_named_in_either_container() {
    let json = r#"{"asset": {"version": "1.0"}, "meshes": {"m": {}}, "scene": "s"}"#;
    let message = refusal("a.gltf", json).to_string();
    assert_eq!(
        message,
        "a.gltf: glTF version 1.0 cannot be read; save it as glTF 2.0"
    );
    let newer = with(&[(r#"{"version""#, r#"{"minVersion": "2.1", "version""#)]);
    assert!(refusal("a.gltf", newer).to_string().contains("version 2.1"));
}

#[test]
fn required_extensions_that_are_not_understood_are_refused_by_name() {
    let required = |name: &str| {
        let list =
            format!(r#""extensionsUsed": ["{name}"], "extensionsRequired": ["{name}"], "asset""#);
        with(&[(r#""asset""#, &list)])
    };
    for name in ["EXT_mesh_gpu_instancing", "KHR_node_visibility", "ACME_new"] {
        let message = refusal("a.glb", glb_file(&required(name), &buffer())).to_string();
        let expected = format!(
            "a.glb: a glTF that requires the extension {name} cannot be read; export it without"
        );
        assert_eq!(message, expected);
    }
    for name in [
        "KHR_materials_unlit",
        "KHR_texture_transform",
        "KHR_mesh_quantization",
    ] {
        check_triangle(&required(name));
    }
}

#[test]
fn extensions_in_use_that_would_show_another_shape_are_told() {
    let json = with(&[(
        r#""asset""#,
        r#""extensionsUsed": ["EXT_mesh_gpu_instancing"], "asset""#,
    )]);
    let read = file("a.glb", glb_file(&json, &buffer()));
    let name = "EXT_mesh_gpu_instancing".to_owned();
    assert_eq!(read.findings(), [Finding::ExtensionPassedOver { name }]);
}

#[test]
fn morph_targets_in_effect_at_rest_are_told() {
    let targets = |weights: &str| {
        with(&[(
            r#""indices": 1}]"#,
            &format!(r#""indices": 1, "targets": [{{"POSITION": 0}}]}}], "weights": [{weights}]"#),
        )])
    };
    let findings = |weights| {
        file("a.glb", glb_file(&targets(weights), &buffer()))
            .findings()
            .to_vec()
    };
    assert_eq!(findings("0, 0.0"), []);
    assert_eq!(
        findings("0, 0.5"),
        [Finding::MorphsNotApplied {
            mesh: "one".to_owned()
        }]
    );
}

#[test]
fn corners_as_floats_are_refused() {
    let mut floats = buffer()[..36].to_vec();
    floats.extend([0f32, 1., 2.].iter().flat_map(|c| c.to_le_bytes()));
    let json = with(&[
        ("5123", "5126"),
        (r#""byteLength": 6"#, r#""byteLength": 12"#),
    ]);
    let message = refusal("a.glb", glb_file(&json, &floats)).to_string();
    assert!(
        message.starts_with(
            "a.glb: accessor 1 (counted from 0): a list of corners that are no whole numbers"
        ),
        "{message}"
    );
}

/// Positions as whole numbers, scaled by their node (KHR_mesh_quantization): read, but not written.
#[test]
fn quantised_positions_are_read_as_a_target() {
    let mut bytes: Vec<u8> = [0u16, 0, 0, 0, 65535, 0, 0, 0, 0, 65535, 0, 0]
        .iter()
        .flat_map(|c| c.to_le_bytes())
        .collect();
    bytes.extend([0u8; 12]);
    bytes.extend(&buffer()[36..]);
    let json = with(&[
        (
            r#""bufferView": 0, "componentType": 5126"#,
            r#""bufferView": 0, "normalized": true, "componentType": 5123"#,
        ),
        (
            r#"{"buffer": 0, "byteLength": 36}"#,
            r#"{"buffer": 0, "byteLength": 24, "byteStride": 8}"#,
        ),
        (r#"{"mesh": 0}"#, r#"{"mesh": 0, "scale": [2, 2, 2]}"#),
        (
            r#""asset""#,
            r#""extensionsUsed": ["KHR_mesh_quantization"], "extensionsRequired": ["KHR_mesh_quantization"], "asset""#,
        ),
    ]);
    let read = file("a.glb", glb_file(&json, &bytes));
    let corners = [[0., 0., 0.], [2., 0., 0.], [0., 2., 0.]].map(Point3::from);
    assert_eq!(read.soup().positions, corners);
    assert!(matches!(
        read.check_writable("a.glb"),
        Err(WriteError::Unsupported { .. })
    ));
}

#[test]
fn messages_speak_of_the_document_and_not_of_the_program() {
    for (from, to, says) in [
        (
            r#""mesh": 0"#,
            r#""mesh": "x""#,
            "a.glb: node 0 (counted from 0): expected a whole number, found `\"x\"`",
        ),
        (
            r#""mesh": 0"#,
            r#""mesh": -1"#,
            "expected a whole number, found `-1`",
        ),
        (
            r#""VEC3""#,
            r#""VEC9""#,
            "a.glb: accessor 0 (counted from 0): expected a type like SCALAR or VEC3, found `VEC9`",
        ),
        (
            "5126",
            "5124",
            "expected a component type between 5120 and 5126, found `5124`",
        ),
        (
            r#"{"mesh": 0}"#,
            "3",
            "a.glb: node 0 (counted from 0): expected an object, found `3`",
        ),
        (r#"[{"mesh": 0}]"#, "{}", "expected a list, found `{}`"),
        (
            r#"{"mesh": 0}"#,
            r#"{"mesh": 0, "mesh": 1}"#,
            "expected each key once in an object, found `mesh`",
        ),
        (
            r#""buffers""#,
            r#""buffers": 1,"#,
            "not a glTF document: key must be a string at line",
        ),
    ] {
        let message = refusal("a.glb", glb_file(&with(&[(from, to)]), &buffer())).to_string();
        assert!(message.contains(says), "{message}");
        for word in ["usize", "u32", "struct", "Void", "u64"] {
            assert!(!message.contains(word), "{message}");
        }
    }
}
