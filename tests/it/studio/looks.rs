//! What was scanned is seen: pictures, colours of vertices, wrinkles; and from where one looks.

use std::f64::consts::{FRAC_PI_2, PI};
use std::fs;
use std::io::Write as _;

use flate2::write::ZlibEncoder;
use flate2::{Compression, Crc};
use serde_json::json;

use super::browser::{browser, Page};
use super::page::{lose_graphics, middle, pixel, probed};
use super::server::Server;
use crate::support::Workplace;

/// A bitmap of one colour.
fn bitmap([red, green, blue]: [u8; 3]) -> Vec<u8> {
    let side = 4_u32;
    let mut bytes = b"BM".to_vec();
    for n in [54 + 3 * side * side, 0, 54, 40, side, side] {
        bytes.extend(n.to_le_bytes());
    }
    bytes.extend([1, 0, 24, 0]);
    bytes.extend([0; 24]);
    bytes.extend([blue, green, red].repeat((side * side) as usize));
    bytes
}

/// The target of the standard pair as text, green all over.
fn green_scan(place: &Workplace) {
    let soup =
        mesh_core::io::read_soup(place.path("target.ply")).expect("the workplace has a target");
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\nelement face {}\n\
         property list uchar int vertex_indices\nend_header\n",
        soup.positions.len(),
        soup.faces.len()
    );
    for p in &soup.positions {
        text += &format!("{} {} {} 10 220 10\n", p.x, p.y, p.z);
    }
    for f in &soup.faces {
        text += &format!("3 {} {} {}\n", f[0], f[1], f[2]);
    }
    place.write("green.ply", &text);
}

/// A picture of one colour as PNG.
fn png([red, green, blue]: [u8; 3]) -> Vec<u8> {
    let side = 4_u32;
    let row = [vec![0], [red, green, blue].repeat(side as usize)].concat();
    let mut packed = ZlibEncoder::new(Vec::new(), Compression::fast());
    packed
        .write_all(&row.repeat(side as usize))
        .expect("bytes are packed");
    let packed = packed.finish().expect("bytes are packed");
    let header = [
        &side.to_be_bytes()[..],
        &side.to_be_bytes(),
        &[8, 2, 0, 0, 0],
    ]
    .concat();
    let mut bytes = b"\x89PNG\r\n\x1a\n".to_vec();
    for (name, content) in [(b"IHDR", header), (b"IDAT", packed), (b"IEND", Vec::new())] {
        bytes.extend((content.len() as u32).to_be_bytes());
        let chunk = [&name[..], &content].concat();
        let mut sum = Crc::new();
        sum.update(&chunk);
        bytes.extend(chunk);
        bytes.extend(sum.sum().to_be_bytes());
    }
    bytes
}

/// A ball as GLB, with a picture of its base colour inside.
fn glb(picture: &[u8]) -> Vec<u8> {
    let soup = mesh_core::shapes::icosphere(3);
    let numbers = |all: Vec<f64>| {
        all.iter()
            .flat_map(|&x| (x as f32).to_le_bytes())
            .collect::<Vec<u8>>()
    };
    let positions = numbers(
        soup.positions
            .iter()
            .flat_map(|p| [p.x, p.y, p.z])
            .collect(),
    );
    let uvs = numbers(
        soup.positions
            .iter()
            .flat_map(|p| [0.5 + 0.4 * p.x, 0.5 + 0.4 * p.y])
            .collect(),
    );
    let corners = soup.faces.iter().flatten();
    let corners: Vec<u8> = corners.flat_map(|v| v.to_le_bytes()).collect();
    let mut padded = picture.to_vec();
    padded.resize(picture.len().next_multiple_of(4), 0);
    let parts = [positions, uvs, corners, padded];
    let mut views = Vec::new();
    let mut at = 0;
    for part in &parts {
        views.push(json!({ "buffer": 0, "byteOffset": at, "byteLength": part.len() }));
        at += part.len();
    }
    views[3]["byteLength"] = json!(picture.len());
    let n = soup.positions.len();
    let text = json!({
        "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "TEXCOORD_0": 1 }, "indices": 2, "material": 0 }] }],
        "materials": [{ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }],
        "textures": [{ "source": 0 }], "images": [{ "bufferView": 3, "mimeType": "image/png" }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": n, "type": "VEC3", "min": [-1, -1, -1], "max": [1, 1, 1] },
            { "bufferView": 1, "componentType": 5126, "count": n, "type": "VEC2" },
            { "bufferView": 2, "componentType": 5125, "count": 3 * soup.faces.len(), "type": "SCALAR" }],
        "bufferViews": views, "buffers": [{ "byteLength": at }],
    });
    let mut text = text.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let content = parts.concat();
    let mut bytes = b"glTF".to_vec();
    let total = 28 + text.len() + content.len();
    for n in [2, total as u32, text.len() as u32] {
        bytes.extend(n.to_le_bytes());
    }
    bytes.extend(b"JSON");
    bytes.extend(text);
    bytes.extend((content.len() as u32).to_le_bytes());
    bytes.extend(b"BIN\0");
    bytes.extend(content);
    bytes
}

#[test]
fn the_picture_inside_a_glb_is_seen() {
    let Some(browser) = browser() else { return };
    let place = Workplace::new();
    fs::write(place.path("red.glb"), glb(&png([220, 20, 20]))).unwrap();
    fs::write(place.path("green.glb"), glb(&png([20, 200, 20]))).unwrap();
    let server = Server::start(&place.path(""), &["red.glb", "green.glb"]);
    let page = Page::open(&browser, &server.url, [1280, 800]);
    page.wait("studio.views.result.shape?.paint && studio.views.target.shape.paint");
    page.press("input[name=style][value=shaded]");
    probed(&page);
    for (side, channel) in [("source", 0), ("target", 1), ("result", 0)] {
        let color = pixel(&page, side);
        assert!(is_mostly(&page, side, channel), "{side} {color:?}");
    }
}

fn is_mostly(page: &Page, side: &str, channel: usize) -> bool {
    let color = pixel(page, side);
    (0..3).all(|k| k == channel || color[k] + 60 < color[channel])
}

#[test]
fn a_textured_creature_is_marked_from_its_texture() {
    let Some(browser) = browser() else { return };
    let place = Workplace::new();
    green_scan(&place);
    place.write("not_there.mtl", "newmtl skin\nmap_Kd skin.bmp\n");
    fs::write(place.path("skin.bmp"), bitmap([220, 20, 20])).unwrap();
    let server = Server::start(&place.path(""), &[]);
    let page = Page::open(&browser, &server.url, [1280, 800]);
    page.wait("studio.state");
    let files = ["source.obj", "not_there.mtl", "skin.bmp"].map(|name| place.path(name));
    page.drop_files(middle(&page, "source"), &files);
    page.wait("studio.views.source.shape?.paint");
    page.drop_files(middle(&page, "target"), &[place.path("green.ply")]);
    page.wait("studio.views.target.shape?.paint && studio.views.result.shape");
    page.press("input[name=style][value=shaded]");
    probed(&page);
    assert!(
        is_mostly(&page, "source", 0),
        "{:?}",
        pixel(&page, "source")
    );
    assert!(
        is_mostly(&page, "target", 1),
        "{:?}",
        pixel(&page, "target")
    );
    assert!(
        is_mostly(&page, "result", 0),
        "{:?}",
        pixel(&page, "result")
    );
    for side in ["source", "target"] {
        page.click(middle(&page, side));
        page.wait(&format!("studio.state.landmarks[0]?.{side}"));
    }

    // Wrinkles and clay have no pictures.
    page.key("v", 86, 0);
    page.wait("studio.preferences.look === 'matcap'");
    probed(&page);
    assert!(!is_mostly(&page, "source", 0));
    page.key("v", 86, 0);
    page.key("v", 86, 0);
    page.wait("studio.preferences.look === 'scan'");
    // The graphics card forgets the pictures, too.
    lose_graphics(&page);
    assert!(
        is_mostly(&page, "source", 0),
        "{:?}",
        pixel(&page, "source")
    );
}

#[test]
fn cameras_look_from_all_sides_with_and_without_perspective() {
    let Some(browser) = browser() else { return };
    let place = Workplace::new();
    let server = Server::start(&place.path(""), &["source.obj", "target.ply"]);
    let page = Page::open(&browser, &server.url, [1280, 800]);
    page.wait("studio.views.result.shape");
    for (key, [yaw, pitch]) in [
        ("1", [0.0, 0.0]),
        ("2", [PI, 0.0]),
        ("4", [-FRAC_PI_2, 0.0]),
        ("8", [0.0, -FRAC_PI_2]),
    ] {
        page.key(key, 0, 0);
        let look = page.value("[studio.views.source.camera.yaw, studio.views.source.camera.pitch]");
        let off = |k: usize, x: f64| (look[k].as_f64().unwrap() - x).abs() < 1e-3;
        assert!(off(0, yaw) && off(1, pitch), "{key}: {look}");
    }
    page.press("[data-look=front]");
    for is_flat in [false, true] {
        // A place is picked where it is drawn.
        let apart = page.value(
            "(async () => { const view = studio.views.source; const r = view.element.getBoundingClientRect(); \
             const at = { clientX: r.left + 0.6 * r.width, clientY: r.top + 0.45 * r.height }; \
             const hit = await studio.link.ask('query', { do: 'pick', shape: 'source', ray: view.ray(at) }); \
             const seen = view.project(view.shape.place(hit.source).point); \
             return Math.hypot(seen.x + r.left - at.clientX, seen.y + r.top - at.clientY); })()",
        );
        assert!(
            apart.as_f64().is_some_and(|d| d < 1.0),
            "{is_flat}: {apart}"
        );
        page.key("5", 0, 0);
    }
    assert_eq!(
        page.value("studio.views.target.camera.isFlat"),
        json!(false)
    );
    // The wheel comes nearer to what is under the pointer.
    let kept = page.value(
        "(() => { const view = studio.views.target; const r = view.element.getBoundingClientRect(); const p = view.shape.point(0); \
         const before = view.project(p); const at = { clientX: r.left + before.x, clientY: r.top + before.y }; \
         const d = view.camera.distance; \
         view.element.dispatchEvent(new WheelEvent('wheel', { ...at, deltaY: -300, cancelable: true, bubbles: true })); \
         return [view.camera.distance < d]; })()",
    );
    assert_eq!(kept, json!([true]));
    // One view large, and all again.
    page.key("x", 88, 0);
    page.wait("studio.views.list.filter((v) => v.element.offsetParent).length === 1 && studio.views.list.some((v) => v.box.width > 700)");
    page.key("x", 88, 0);
    page.wait("studio.views.list.every((v) => v.box.width > 200)");
}
