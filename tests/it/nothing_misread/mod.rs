//! Nothing misread, nothing hung: for each dialect, limit and message the smallest input that shows it, through the
//! command.
//!
//! | what | tests |
//! |---|---|
//! | read wrong with exit code 0 | `read_wrong` |
//! | settings, threads and coordinates that broke the program | `limits` |
//! | work that grew with the square of the input | `hangs` |
//! | refused although other programs read it | `dialects` |
//! | messages | `messages` |
//! | weights, outputs, pipes, requirements: what the command promises | `contract`, `pipes` |
//!
//! The readers' own tests (`mesh-core/tests/it/io_*.rs`) look closer, and the README's table of formats is held line by line
//! by `io_readme.rs` there.

mod contract;
mod dialects;
mod hangs;
mod limits;
mod messages;
mod pipes;
mod read_wrong;

use base64::engine::general_purpose::STANDARD;
use base64::Engine as _;

use crate::support::{Ended, Workplace};
use serde_json::{json, Value};

const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const ROWS: &str = "0 0 0\n1 0 0\n0 1 0\n";
const STL: &str = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n\
                   endsolid a\n";

/// What `drape inspect` says of a file.
fn inspected(name: &str, bytes: impl AsRef<[u8]>) -> Ended {
    let place = Workplace::new();
    std::fs::write(place.path(name), bytes).expect("a file is written");
    place.drape(&format!("inspect {name} --json"))
}

/// The file is read as one triangle with corners at the origin, at x = 1 and at y = 1, moved by `z`.
fn assert_triangle(name: &str, bytes: impl AsRef<[u8]>, z: f64) -> Ended {
    let ended = inspected(name, bytes).well();
    let found = ended.json();
    assert_eq!(found["faces"], 1, "{name}");
    let bounds = json!([[0.0, 0.0, z], [1.0, 1.0, z]]);
    assert_eq!(
        json!([found["box_min"], found["box_max"]]),
        bounds,
        "{name}"
    );
    ended
}

/// One error line with these words, exit code 2.
fn assert_refused(ended: &Ended, words: &[&str]) {
    let line = ended.stderr.trim_end();
    assert_eq!((ended.code, line.lines().count()), (Some(2), 1), "{line}");
    assert!(line.starts_with("error: "), "{line}");
    for word in words {
        assert!(line.contains(word), "`{line}` lacks `{word}`");
    }
}

/// A triangle as PLY; the header of its faces and their row may be others.
fn ply(face_header: &str, face: &str) -> String {
    let coordinates = "property float x\nproperty float y\nproperty float z\n";
    format!(
        "ply\nformat ascii 1.0\nelement vertex 3\n{coordinates}element face 1\n{face_header}\nend_header\n{ROWS}{face}\n"
    )
}

const PLY_FACE: &str = "property list uchar int vertex_indices";

/// Two triangles as binary STL whose header states so many.
fn binary_stl(stated: u32) -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes.extend(stated.to_le_bytes());
    for k in [0.0f32, 2.0] {
        let numbers = [0., 0., 1., k, 0., 0., k + 1., 0., 0., k, 1., 0.];
        bytes.extend(numbers.iter().flat_map(|n| n.to_le_bytes()));
        bytes.extend([0, 0]);
    }
    bytes
}

/// A triangle as a glTF document with these members in the place of its own.
fn gltf(changes: &Value) -> String {
    gltf_with(
        &floats(&[0., 0., 0., 1., 0., 0., 0., 1., 0.]),
        5126,
        &[0, 0, 1, 0, 2, 0, 0, 0],
        5123,
        changes,
    )
}

fn floats(numbers: &[f32]) -> Vec<u8> {
    numbers.iter().flat_map(|n| n.to_le_bytes()).collect()
}

/// A document of three positions and three corners in these components.
fn gltf_with(
    positions: &[u8],
    of_positions: u32,
    corners: &[u8],
    of_corners: u32,
    changes: &Value,
) -> String {
    let data = [positions, corners].concat();
    let n = positions.len();
    let stride = n / 3;
    let mut document = json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": of_positions, "count": 3, "type": "VEC3"},
            {"bufferView": 1, "componentType": of_corners, "count": 3, "type": "SCALAR"}],
        "bufferViews": [
            {"buffer": 0, "byteLength": n, "byteStride": stride},
            {"buffer": 0, "byteOffset": n, "byteLength": data.len() - n}],
        "buffers": [{"byteLength": data.len(), "uri": data_uri(&data)}],
    });
    for (key, value) in changes.as_object().into_iter().flatten() {
        document[key] = value.clone();
    }
    document.to_string()
}

fn data_uri(bytes: &[u8]) -> String {
    format!(
        "data:application/octet-stream;base64,{}",
        STANDARD.encode(bytes)
    )
}
