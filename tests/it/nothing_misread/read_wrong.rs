//! What was once read wrong with exit code 0.

use super::{
    assert_refused, assert_triangle, binary_stl, floats, gltf, gltf_with, inspected, ply, OBJ, STL,
};
use serde_json::json;

#[test]
fn points_with_decimal_commas_and_semicolons() {
    let found = inspected("a.xyz", "-1,5;-1,5;-1,5\n2,5;0,25;3\n")
        .well()
        .json();
    assert_eq!(found["box_min"], json!([-1.5, -1.5, -1.5]));
    assert_eq!(found["box_max"], json!([2.5, 0.25, 3.0]));
    assert_refused(&inspected("a.xyz", "1.5;2,5;3\n"), &["a.xyz:1"]);
}

#[test]
fn a_face_list_of_floats() {
    let text = ply("property list uchar float vertex_indices", "3 0 1 2");
    assert_triangle("a.ply", text, 0.0);
    let broken = ply("property list uchar float vertex_indices", "3 0 1 1.5");
    assert_refused(&inspected("a.ply", broken), &["a.ply", "1.5"]);
}

#[test]
fn an_stl_that_is_cut_short_or_counts_wrong() {
    let cut = &STL[..STL.find("endloop").unwrap_or(0)];
    assert_refused(&inspected("a.stl", cut), &["a.stl"]);
    let whole = binary_stl(2);
    assert_refused(&inspected("a.stl", &whole[..whole.len() - 10]), &["a.stl"]);
    for stated in [1, 3] {
        let ended = inspected("a.stl", binary_stl(stated)).well();
        assert_eq!(ended.json()["faces"], 2);
        let told = format!("states {stated} triangles, but there are 2");
        assert!(ended.stderr.contains(&told), "{}", ended.stderr);
    }
}

#[test]
fn a_skinned_gltf_stands_in_its_pose() {
    let uri = super::data_uri(&[&[0; 12][..], &floats(&[1., 0., 0., 0.].repeat(3))].concat());
    let mut document: serde_json::Value =
        serde_json::from_str(&gltf(&json!({}))).expect("a document");
    let add = |list: &mut serde_json::Value, items: serde_json::Value| {
        let list = list.as_array_mut().expect("a list");
        list.extend(items.as_array().into_iter().flatten().cloned());
    };
    add(
        &mut document["buffers"],
        json!([{"byteLength": 60, "uri": uri}]),
    );
    add(
        &mut document["bufferViews"],
        json!([{"buffer": 1, "byteLength": 12}, {"buffer": 1, "byteOffset": 12, "byteLength": 48}]),
    );
    add(
        &mut document["accessors"],
        json!([{"bufferView": 2, "componentType": 5121, "count": 3, "type": "VEC4"},
               {"bufferView": 3, "componentType": 5126, "count": 3, "type": "VEC4"}]),
    );
    document["nodes"] = json!([{"mesh": 0, "skin": 0}, {"translation": [0, 0, 5]}]);
    document["scenes"] = json!([{"nodes": [0, 1]}]);
    document["skins"] = json!([{"joints": [1]}]);
    let attributes = &mut document["meshes"][0]["primitives"][0]["attributes"];
    (attributes["JOINTS_0"], attributes["WEIGHTS_0"]) = (2.into(), 3.into());
    assert_triangle("a.gltf", document.to_string(), 5.0);
}

#[test]
fn a_gltf_that_shows_its_mesh_many_times() {
    let name = "EXT_mesh_gpu_instancing";
    let node = json!([{"mesh": 0, "extensions": {name: {"attributes": {"TRANSLATION": 0}}}}]);
    let required = gltf(&json!({"nodes": node, "extensionsRequired": [name]}));
    assert_refused(&inspected("a.gltf", required), &["a.gltf", name]);
    let used = inspected(
        "a.gltf",
        gltf(&json!({"nodes": node, "extensionsUsed": [name]})),
    )
    .well();
    assert!(used.stderr.contains(name), "{}", used.stderr);
}

#[test]
fn corners_of_a_gltf_as_floats() {
    let positions = floats(&[0., 0., 0., 1., 0., 0., 0., 1., 0.]);
    let text = gltf_with(&positions, 5126, &floats(&[0., 1., 2.]), 5126, &json!({}));
    assert_refused(&inspected("a.gltf", text), &["a.gltf"]);
}

#[test]
fn what_every_format_is_read_as() {
    for (name, text) in [
        ("a.obj", OBJ),
        ("a.stl", STL),
        ("a.gltf", &gltf(&json!({}))),
    ] {
        assert_triangle(name, text, 0.0);
    }
    assert_triangle("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", 0.0);
    assert_triangle("a.ply", ply(super::PLY_FACE, "3 0 1 2"), 0.0);
}
