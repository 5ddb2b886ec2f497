//! glTF and GLB files survive.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use base64::engine::general_purpose::STANDARD;
use base64::Engine;
use mesh_core::io::{Format, MeshFile, WriteError};
use mesh_core::{Point3, Positions, Vector3};

use crate::io_support::{bent, file, glb_file, refusal, rest, written};

/// A square of two triangles whose diagonal is a seam (interleaved: position, normal, tangent, uv), one triangle with
/// normalised uvs and sparse positions, under nodes that turn, scale and shift.
fn buffer() -> Vec<u8> {
    let mut out = Vec::new();
    let corners = [[0., 0.], [1., 0.], [1., 1.], [0., 0.], [1., 1.], [0., 1.]];
    for [x, y] in corners {
        for c in [x, y, 0., 0., 0., 1., 1., 0., 0., -1., x, y] {
            out.extend((c as f32).to_le_bytes());
        }
    }
    assert_eq!(out.len(), 288);
    out.extend([0u8, 1, 2, 3, 4, 5, 0, 0]);
    for c in [0f32, 0., 0., 9., 9., 9., 0., 1., 0.] {
        out.extend(c.to_le_bytes());
    }
    assert_eq!(out.len(), 332);
    out.extend([1u8, 0, 0, 0]);
    for c in [1f32, 0., 0.] {
        out.extend(c.to_le_bytes());
    }
    out.extend([0u8, 0, 255, 0, 0, 255, 0, 0]);
    assert_eq!(out.len(), 356);
    out
}

const JSON: &str = r#"{ "asset": {"version": "2.0", "extras": {"min": [1, 2]}},
  "scene": 0, "scenes": [{"nodes": [1, 0]}],
  "nodes": [
    {"mesh": 0, "translation": [1, 2, 3], "scale": [2, 2, 2]},
    {"children": [2], "rotation": [0, 0, 0.7071067811865476, 0.7071067811865476]},
    {"mesh": 1, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 10,0,0,1], "name": "} ] \" odd"},
    {"name": "unused", "mesh": 0}
  ],
  "materials": [{"name": "paint"}, {}],
  "meshes": [
    {"name": "square", "primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1, "TANGENT": 2, "TEXCOORD_0": 3}, "indices": 4, "material": 1,
      "targets": [{"POSITION": 1}]}], "weights": [0.5]},
    {"primitives": [{"attributes": {"POSITION": 5, "TEXCOORD_0": 6}, "material": 0}]}
  ],
  "accessors": [
    {"bufferView": 0, "componentType": 5126, "count": 6, "type": "VEC3", "min": [0, 0, 0], "max": [1.0, 1.0, 0]},
    {"bufferView": 0, "byteOffset": 12, "componentType": 5126, "count": 6, "type": "VEC3"},
    {"bufferView": 0, "byteOffset": 24, "componentType": 5126, "count": 6, "type": "VEC4"},
    {"bufferView": 0, "byteOffset": 40, "componentType": 5126, "count": 6, "type": "VEC2"},
    {"bufferView": 1, "componentType": 5121, "count": 6, "type": "SCALAR"},
    {"bufferView": 2, "componentType": 5126, "count": 3, "type": "VEC3", "max": [1, 1, 0], "min": [0, 0, 0],
      "sparse": {"count": 1, "indices": {"bufferView": 3, "componentType": 5121}, "values": {"bufferView": 4}}},
    {"bufferView": 5, "componentType": 5121, "normalized": true, "count": 3, "type": "VEC2"}
  ],
  "bufferViews": [
    {"buffer": 0, "byteLength": 288, "byteStride": 48},
    {"buffer": 0, "byteOffset": 288, "byteLength": 8},
    {"buffer": 0, "byteOffset": 296, "byteLength": 36},
    {"buffer": 0, "byteOffset": 332, "byteLength": 4},
    {"buffer": 0, "byteOffset": 336, "byteLength": 12},
    {"buffer": 0, "byteOffset": 348, "byteLength": 8}
  ],
  "buffers": [{"byteLength": 356, "uri": "URI"}] }"#;

pub(crate) fn document(uri: &str) -> String {
    JSON.replace("URI", uri)
}

pub(crate) fn data_uri() -> String {
    format!(
        "data:application/octet-stream;base64,{}",
        STANDARD.encode(buffer())
    )
}

fn glb_of(json: &str) -> Vec<u8> {
    glb_file(json, &buffer())
}

pub(crate) fn glb() -> Vec<u8> {
    glb_of(&JSON.replace(r#", "uri": "URI""#, ""))
}

fn close(a: &[Point3], b: &[Point3], tolerance: f64) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).norm() <= tolerance)
}

#[test]
fn the_scene_is_one_soup() {
    for (name, bytes, format) in [
        ("a.gltf", document(&data_uri()).into_bytes(), Format::Gltf),
        ("a.glb", glb(), Format::Glb),
    ] {
        let read = file(name, &bytes);
        assert_eq!(read.format(), format);
        let expected = [[1., 2.], [3., 2.], [3., 4.], [1., 2.], [3., 4.], [1., 4.]]
            .map(|[x, y]| Point3::new(x, y, 3.));
        assert_eq!(read.soup().positions[..6], expected);
        // The parent turns (x, y) to (−y, x), rounded.
        let turned = [[0., 10., 0.], [0., 11., 0.], [-1., 10., 0.]].map(Point3::from);
        assert!(
            close(&read.soup().positions[6..], &turned, 1e-6),
            "{:?}",
            &read.soup().positions[6..]
        );
        assert_eq!(read.soup().faces, [[0, 1, 2], [3, 4, 5], [6, 7, 8]]);

        let contents = read.contents();
        assert_eq!((contents.n_uvs, contents.n_normals), (9, 6));
        let names: Vec<_> = contents
            .objects
            .iter()
            .map(|o| (o.name.as_str(), o.n_faces()))
            .collect();
        assert_eq!(names, [("square", 2), ("mesh 1", 1)]);
        let names: Vec<_> = contents
            .materials
            .iter()
            .map(|o| (o.name.as_str(), o.n_faces()))
            .collect();
        assert_eq!(names, [("paint", 1), ("material 1", 2)]);
        let normals = read.vertex_normals().unwrap();
        assert_eq!((normals[0], normals[8]), (Vector3::z(), Vector3::zeros()));
        assert_eq!(read.soup().weld(0.0).soup.positions.len(), 7);
    }
}

#[test]
fn only_positions_normals_tangents_and_bounds_change() {
    let bytes = glb();
    let read = file("a.glb", &bytes);
    assert_eq!(written(&read, &rest(&read)), bytes);
    read.check_writable("b.glb").unwrap();

    // The square stands up: (x, y, z) ↦ (z, x, y) around the node's frame; the other mesh stays.
    let mut x = rest(&read);
    for p in &mut x.as_mut_slice()[..6] {
        *p = Point3::new(p.z + 1.0, p.x, p.y);
    }
    let new = written(&read, &x);
    let moved = file("a.glb", &new);
    assert!(close(&moved.soup().positions, x.as_slice(), 1e-6));
    assert_eq!(
        moved.soup().positions[6..],
        read.soup().positions[6..],
        "what did not move keeps its bytes"
    );
    assert_eq!(
        (&moved.soup().faces, moved.contents()),
        (&read.soup().faces, read.contents())
    );
    assert!((moved.vertex_normals().unwrap()[0] - Vector3::x()).norm() < 1e-6);

    let data = &new[new.len() - 356..];
    let float = |at: usize| f32::from_le_bytes(data[at..at + 4].try_into().unwrap());
    assert_eq!(
        [24, 28, 32, 36].map(float),
        [0., 1., 0., -1.],
        "the tangent turned, its sign is kept"
    );
    assert_eq!(
        (data[40..48].to_vec(), &data[288..]),
        (buffer()[40..48].to_vec(), &buffer()[288..])
    );

    let text = |bytes: &[u8]| {
        String::from_utf8_lossy(&bytes[20..bytes.len() - 364])
            .trim_end()
            .to_owned()
    };
    let (old, new_text) = (text(&bytes), text(&new));
    let changed: Vec<_> = old
        .lines()
        .zip(new_text.lines())
        .filter(|(a, b)| a != b)
        .collect();
    let line = r#"    {"bufferView": 0, "componentType": 5126, "count": 6, "type": "VEC3", "min": [1.5,-0.5,-0.5], "max": [1.5,0.5,0.5]},"#;
    assert_eq!(changed.len(), 1, "{changed:?}");
    assert_eq!(changed[0].1, line);
    assert_eq!(new.len() % 4, 0);
}

#[test]
fn a_document_takes_its_buffer_in() {
    let folder = std::env::temp_dir().join(format!("mesh_core_gltf_{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("a.gltf");
    std::fs::write(folder.join("my data.bin"), buffer()).unwrap();
    std::fs::write(&path, document("my%20data.bin")).unwrap();

    let read = mesh_core::io::read_mesh(&path).unwrap();
    let x = bent(&read);
    let unchanged = read.to_bytes(&path, &rest(&read)).unwrap();
    let moved = read.to_bytes(&path, &x).unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    assert_eq!(unchanged, document("my%20data.bin").into_bytes());
    let moved = file("alone.gltf", moved);
    assert!(close(&moved.soup().positions, x.as_slice(), 1e-4));
}

#[test]
fn seams_stay_smooth() {
    // The square becomes a ridge along its diagonal: both copies of the ends of the seam get one normal.
    let read = file("a.glb", glb());
    let mut x = rest(&read);
    x.as_mut_slice()[1].z += 1.0;
    x.as_mut_slice()[5].z += 2.0;
    let normals = file("a.glb", written(&read, &x)).vertex_normals().unwrap();
    assert_eq!((normals[0], normals[2]), (normals[3], normals[4]));
    assert_ne!(normals[1], normals[5]);
}

#[test]
fn what_cannot_move_is_told_before_the_work() {
    let told = |json: String| match file("a.glb", glb_of(&json.replace(r#", "uri": "URI""#, "")))
        .check_writable("a.glb")
    {
        Err(WriteError::Unsupported { feature, .. }) => feature.to_owned(),
        other => panic!("{other:?}"),
    };
    assert!(
        told(JSON.replace(r#""nodes": [1, 0]"#, r#""nodes": [1, 0, 3]"#))
            .contains("more than once")
    );
    assert!(
        told(JSON.replace(r#""scale": [2, 2, 2]"#, r#""scale": [2, 0, 2]"#)).contains("flattened")
    );
    let implied = JSON.replace(
        r#"{"bufferView": 2, "componentType": 5126"#,
        r#"{"componentType": 5126"#,
    );
    assert!(told(implied).contains("implied"));
    let quantised = JSON.replacen(
        r#"{"bufferView": 0, "componentType": 5126"#,
        r#"{"bufferView": 0, "normalized": true, "componentType": 5122"#,
        1,
    );
    assert!(told(quantised).contains("quantised"));
    let two_sets = JSON.replace(
        r#""targets": [{"POSITION": 1}]}]"#,
        r#""targets": [{"POSITION": 1}]}, {"attributes": {"POSITION": 0, "NORMAL": 7}, "indices": 4}]"#,
    );
    let two_sets = two_sets.replace(
        r#""count": 3, "type": "VEC2"}
  ]"#,
        r#""count": 3, "type": "VEC2"},
    {"bufferView": 0, "byteOffset": 24, "componentType": 5126, "count": 6, "type": "VEC3"}
  ]"#,
    );
    assert!(told(two_sets).contains("share positions but not normals"));
}

#[test]
fn faults() {
    let bad = |from: &str, to: &str| {
        assert!(document(&data_uri()).contains(from));
        refusal("bad.gltf", document(&data_uri()).replacen(from, to, 1)).to_string()
    };
    for (message, says) in [
        (bad(r#""count": 6"#, r#""count": 7"#), "accessor 0"),
        (
            bad(r#""count": 6"#, r#""count": 99999999999"#),
            "99999999999 elements are promised",
        ),
        (
            bad(r#""byteStride": 48"#, r#""byteStride": 4"#),
            "accessor 0",
        ),
        (
            bad(
                r#""byteLength": 288"#,
                r#""byteLength": 18446744073709551615"#,
            ),
            "accessor 0",
        ),
        (
            bad(
                r#""asset""#,
                r#""extensionsRequired": ["KHR_draco_mesh_compression"], "asset""#,
            ),
            "without mesh compression",
        ),
        (bad(r#""POSITION": 0"#, r#""POSITION": 70"#), "accessor 70"),
        (bad(r#"{"mesh": 0,"#, r#"{"mesh": 9,"#), "mesh 9"),
        (
            bad("data:application/octet-stream", "../secret"),
            "put it in the same folder",
        ),
        (bad("base64,", "base64,*"), "save the file as GLB"),
        (bad("}]", "}"), "not a glTF document"),
    ] {
        assert!(message.contains(says), "{message}");
    }
    let mut bytes = glb();
    let at = bytes.len() - 68;
    bytes[at] = 9;
    assert!(refusal("bad.glb", &bytes)
        .to_string()
        .contains("names vertex 9"));
    assert!(refusal("bad.glb", &glb()[..200])
        .to_string()
        .contains("ends where"));
    assert!(refusal("bad.glb", b"glTF\x01\0\0\0")
        .to_string()
        .contains("version 1"));
    let cycle = document(&data_uri()).replace(r#""children": [2]"#, r#""children": [1, 2, 2]"#);
    assert_eq!(file("cycle.gltf", cycle).soup().faces.len(), 3);
}

#[test]
fn it_converts_to_plain_formats() {
    let read = file("a.glb", glb());
    let x = Positions::from(read.soup().positions.clone());
    assert!(read.check_writable("a.gltf").is_ok());
    let obj = MeshFile::from_bytes("a.obj", read.to_bytes("a.obj", &x).unwrap()).unwrap();
    assert_eq!(obj.soup(), read.soup());
    let ply = read.lost_in("a.ply").unwrap();
    assert!(ply.contains("9 texture coordinates"), "{ply}");
    let told = read.lost_in("a.obj").unwrap();
    assert!(!told.contains("texture coordinates"), "{told}");
    // Floats of the first mesh, whole numbers of the second, each seen from below.
    let text = String::from_utf8(read.to_bytes("a.obj", &x).unwrap()).unwrap();
    let uvs: Vec<&str> = text.lines().filter(|l| l.starts_with("vt")).collect();
    assert_eq!(uvs[..3], ["vt 0 1", "vt 1 1", "vt 1 0"]);
    assert_eq!(uvs[6..], ["vt 0 1", "vt 1 1", "vt 0 0"]);
}

#[test]
fn two_buffers_of_one_file_are_refused() {
    let folder = std::env::temp_dir().join(format!("mesh_core_gltf_twice_{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("a.bin"), buffer()).unwrap();
    let json = document("a.bin").replace(
        r#""buffers": ["#,
        r#""buffers": [{"byteLength": 356, "uri": "./%61.bin"}, "#,
    );
    let error = MeshFile::from_bytes(folder.join("a.gltf"), json.into_bytes()).unwrap_err();
    std::fs::remove_dir_all(&folder).unwrap();
    assert!(
        error
            .to_string()
            .contains("two buffers of the one file `a.bin`"),
        "{error}"
    );
}

/// Work that grew with the square of the file: no scene, and so each node asked whether any other names it as a child.
#[test]
fn many_nodes_without_a_scene_are_read_at_once() {
    let nodes = vec!["{}"; 200_000].join(",");
    let scene = r#""scene": 0, "scenes": [{"nodes": [1, 0]}],"#;
    let json = document(&data_uri())
        .replace(scene, "")
        .replace(
            r#""nodes": ["#,
            &format!(r#""nodes": [{{"mesh": 0}}, {nodes}, "#),
        )
        .replace(r#""children": [2]"#, r#""children": []"#);
    let start = std::time::Instant::now();
    assert_eq!(file("a.gltf", json).soup().faces.len(), 7);
    assert!(start.elapsed().as_secs() < 5);
}

/// Found by fuzzing: the new positions overwrote the indices of the faces, and the file did not read any more.
#[test]
fn positions_that_share_bytes_with_indices_are_refused() {
    let json = document(&data_uri()).replace(
        r#"{"buffer": 0, "byteOffset": 288, "byteLength": 8}"#,
        r#"{"buffer": 0, "byteOffset": 4, "byteLength": 8}"#,
    );
    let read = file("a.gltf", json.clone());
    assert_eq!(written(&read, &rest(&read)), json.into_bytes());
    let error = read.to_bytes("a.gltf", &bent(&read)).unwrap_err();
    assert!(error.to_string().contains("share bytes"), "{error}");
}
