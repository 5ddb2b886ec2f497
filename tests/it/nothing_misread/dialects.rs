//! What other programs read, and we once refused; and what is refused with advice.

use std::io::Write as _;

use super::{assert_refused, assert_triangle, gltf, gltf_with, inspected, ply, OBJ, PLY_FACE, STL};
use crate::support::Workplace;
use serde_json::json;

#[test]
fn extras_that_are_numbers_strings_or_lists() {
    for extras in [json!(3), json!("x"), json!([1, "x"])] {
        assert_triangle("a.gltf", gltf(&json!({"extras": extras})), 0.0);
        assert_triangle(
            "a.gltf",
            gltf(&json!({"nodes": [{"mesh": 0, "extras": extras}]})),
            0.0,
        );
    }
}

#[test]
fn animations_without_a_node_and_scenes_without_nodes() {
    let animation = json!([{"channels": [{"sampler": 0, "target": {"path": "pointer"}}],
                            "samplers": [{"input": 0, "output": 0}]}]);
    assert_triangle("a.gltf", gltf(&json!({"animations": animation})), 0.0);
    assert_triangle(
        "a.gltf",
        gltf(&json!({"scenes": [{"nodes": [0]}, {"name": "x"}]})),
        0.0,
    );
}

#[test]
fn whole_numbers_with_a_point() {
    let text = gltf(&json!({})).replace("\"count\":3", "\"count\":3.0");
    assert_triangle("a.gltf", text, 0.0);
}

#[test]
fn text_stl_with_comments_with_colours_and_on_one_line() {
    for text in [
        STL.replace("outer", "# c\n// c\n; c\nouter"),
        STL.replace("outer", "color 0.5 0.5 0.5\nouter"),
        STL.replace('\n', " "),
        format!("# on top\n{STL}"),
    ] {
        assert_triangle("a.stl", text, 0.0);
    }
}

#[test]
fn content_tells_the_format_before_the_extension_does() {
    assert_triangle("a.stl", OBJ, 0.0);
    assert_triangle("a.ply", OBJ, 0.0);
    assert_triangle("a.obj", gltf(&json!({})), 0.0);
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    packer
        .write_all(OBJ.as_bytes())
        .expect("a vector takes all");
    assert_triangle("a.off", packer.finish().expect("a vector takes all"), 0.0);
}

#[test]
fn ply_rows_with_more_columns() {
    assert_triangle("a.ply", ply(PLY_FACE, "3 0 1 2 255 0 0"), 0.0);
    assert_triangle(
        "a.ply",
        ply(PLY_FACE, "3 0 1 2").replace("1 0 0", "1 0 0 9"),
        0.0,
    );
}

#[test]
fn byte_order_marks_and_text_in_two_bytes() {
    for (name, text) in [
        ("a.ply", ply(PLY_FACE, "3 0 1 2")),
        ("a.gltf", gltf(&json!({}))),
        ("a.obj", OBJ.to_owned()),
    ] {
        assert_triangle(name, format!("\u{feff}{text}"), 0.0);
    }
    let wide = OBJ.encode_utf16().flat_map(u16::to_le_bytes);
    assert_triangle(
        "a.obj",
        [0xff, 0xfe].into_iter().chain(wide).collect::<Vec<u8>>(),
        0.0,
    );
}

#[test]
fn lenient_ply_and_obj() {
    let plain = ply(PLY_FACE, "3 0 1 2");
    for text in [
        plain.replacen("ply\n", "PLY \n", 1),
        plain.replace("vertex 3", "vertex 3.0"),
        plain.replace("3 0 1 2", "3 0.0 1.0 2.0"),
        plain.replace("1 0 0", "\n1 0 0"),
    ] {
        assert_triangle("a.ply", text, 0.0);
    }
    for text in [
        OBJ.replace("f 1 2 3", "f 1/ 2// 3///"),
        OBJ.replace('v', " v").replace('f', "\tf"),
        OBJ.replace("1 2 3", "1 2 3 # c"),
        format!("hello world\n// exported\n{OBJ}"),
        format!("f 1 2 3\n{}", OBJ.replace("f 1 2 3\n", "")),
        format!("{OBJ}\0\0\0"),
    ] {
        assert_triangle("a.obj", text, 0.0);
    }
}

#[test]
fn version_1_of_gltf_is_named() {
    let text = json!({"asset": {"version": "1.0"}, "meshes": {"m": {}}}).to_string();
    assert_refused(&inspected("a.gltf", text), &["a.gltf", "1.0"]);
}

#[test]
fn quantised_positions_are_a_target_and_no_source() {
    let place = Workplace::new();
    let rows = [[0u16, 0, 0, 0], [65535, 0, 0, 0], [0, 65535, 0, 0]];
    let positions: Vec<u8> = rows
        .iter()
        .flatten()
        .flat_map(|n| n.to_le_bytes())
        .collect();
    let name = "KHR_mesh_quantization";
    let changes = json!({"extensionsRequired": [name], "extensionsUsed": [name]});
    let text = gltf_with(&positions, 5123, &[0, 0, 1, 0, 2, 0], 5123, &changes);
    let text = text.replacen(
        "\"componentType\":5123",
        "\"componentType\":5123,\"normalized\":true",
        1,
    );
    assert_triangle("a.gltf", &text, 0.0);
    place.write("q.gltf", &text);
    place
        .drape("transfer source.obj q.gltf --config short.toml --initial affine -o out.obj")
        .well();
    let source = place.drape("transfer q.gltf target.ply -o out.gltf");
    assert_refused(&source, &["q.gltf", "quantised"]);
}

#[test]
fn what_is_compressed_is_refused_with_what_to_export_instead() {
    for name in ["KHR_draco_mesh_compression", "EXT_meshopt_compression"] {
        let changes = json!({"extensionsRequired": [name], "extensionsUsed": [name]});
        let place = Workplace::new();
        place.write("c.gltf", &gltf(&changes));
        for line in [
            "transfer source.obj c.gltf -o out.obj",
            "transfer c.gltf target.ply -o out.gltf",
        ] {
            assert_refused(&place.drape(line), &["c.gltf", "compress"]);
        }
    }
}
