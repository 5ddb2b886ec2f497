//! Meshes with a picture, as GLB.

use std::io::Write as _;

use flate2::write::ZlibEncoder;
use flate2::{Compression, Crc};
use mesh_core::PolygonSoup;
use serde_json::json;

/// Triangles and the coordinates of each vertex in the picture.
pub(crate) struct Painted {
    pub(crate) soup: PolygonSoup,
    pub(crate) uvs: Vec<[f64; 2]>,
}

/// A small ball.
pub(crate) fn ball() -> Painted {
    let soup = mesh_core::shapes::icosphere(3);
    let uvs = soup.positions.iter();
    Painted {
        uvs: uvs.map(|p| [0.5 + 0.4 * p.x, 0.5 + 0.4 * p.y]).collect(),
        soup,
    }
}

/// A square picture as PNG, its colours by column and row.
pub(crate) fn png(side: u32, color: impl Fn([u32; 2]) -> [u8; 3]) -> Vec<u8> {
    let mut packed = ZlibEncoder::new(Vec::new(), Compression::fast());
    for y in 0..side {
        let row: Vec<u8> = [0]
            .into_iter()
            .chain((0..side).flat_map(|x| color([x, y])))
            .collect();
        packed.write_all(&row).expect("bytes are packed");
    }
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

/// A mesh as GLB, with a picture of its base colour inside.
pub(crate) fn glb(Painted { soup, uvs }: &Painted, picture: &[u8]) -> Vec<u8> {
    let bytes = |x: f64| (x as f32).to_le_bytes();
    let numbers = soup.positions.iter().flat_map(|p| [p.x, p.y, p.z]);
    let positions: Vec<u8> = numbers.flat_map(bytes).collect();
    let uvs: Vec<u8> = uvs.iter().flatten().copied().flat_map(bytes).collect();
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
