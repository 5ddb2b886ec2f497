//! A new glTF or GLB file: one mesh of triangles.

use std::collections::HashMap;

use base64::engine::general_purpose::STANDARD;
use base64::Engine;

use crate::io::fault::Unwritable;
use crate::io::triangles::Triangles;
use crate::io::uvs::CornerUvs;
use crate::{Point3, PolygonSoup, Vector3};

/// The data of a new file.
struct Content {
    /// The vertex of the soup that each vertex of the file is.
    vertex_of: Vec<u32>,
    uvs: Option<Vec<[f64; 2]>>,
    indices: Vec<u32>,
    normals: Vec<Vector3>,
}

/// A new GLB of `soup`; vertices on a seam of texture coordinates are split there.
pub(super) fn write_glb(
    soup: &PolygonSoup,
    uvs: Option<&CornerUvs>,
) -> Result<Vec<u8>, Unwritable> {
    let (buffer, document) = parts(soup, uvs)?;
    let mut json = document("").into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut out = b"glTF".to_vec();
    let length = 28 + json.len() + buffer.len();
    for n in [2, length, json.len()] {
        out.extend_from_slice(&(n as u32).to_le_bytes());
    }
    out.extend_from_slice(b"JSON");
    out.extend_from_slice(&json);
    out.extend_from_slice(&(buffer.len() as u32).to_le_bytes());
    out.extend_from_slice(b"BIN\0");
    out.extend_from_slice(&buffer);
    Ok(out)
}

/// The same as one JSON document.
pub(super) fn write_gltf(
    soup: &PolygonSoup,
    uvs: Option<&CornerUvs>,
) -> Result<Vec<u8>, Unwritable> {
    let (buffer, document) = parts(soup, uvs)?;
    let data = STANDARD.encode(&buffer);
    Ok(document(&format!(
        ",\"uri\":\"data:application/octet-stream;base64,{data}\""
    ))
    .into_bytes())
}

fn parts(
    soup: &PolygonSoup,
    uvs: Option<&CornerUvs>,
) -> Result<(Vec<u8>, impl Fn(&str) -> String), Unwritable> {
    let content = Content::of(soup, uvs)?;
    let positions: Vec<Point3> = content
        .vertex_of
        .iter()
        .map(|&v| soup.positions[v as usize])
        .collect();
    let mut buffer = Vec::with_capacity(36 * positions.len() + 4 * content.indices.len());
    let mut push = |vertex: usize, c: f64| {
        let single = c as f32;
        buffer.extend_from_slice(&single.to_le_bytes());
        if single.is_finite() {
            Ok(())
        } else {
            Err(Unwritable::Vertex(vertex))
        }
    };
    for (&vertex, p) in content.vertex_of.iter().zip(&positions) {
        p.iter().try_for_each(|&c| push(vertex as usize, c))?;
    }
    for (row, n) in content.normals.iter().enumerate() {
        n.iter().try_for_each(|&c| push(row, c))?;
    }
    for (row, uv) in content.uvs.iter().flatten().enumerate() {
        // Rows run downwards in these files.
        let most = f64::from(f32::MAX);
        [uv[0], 1.0 - uv[1]]
            .iter()
            .try_for_each(|c| push(row, c.clamp(-most, most)))?;
    }
    for index in &content.indices {
        buffer.extend_from_slice(&index.to_le_bytes());
    }
    let n_bytes = buffer.len();
    let document = move |uri: &str| document(&content, &positions, n_bytes, uri);
    Ok((buffer, document))
}

impl Content {
    fn of(soup: &PolygonSoup, uvs: Option<&CornerUvs>) -> Result<Self, Unwritable> {
        let triangles = Triangles::of(soup)?;
        let mut content = Self {
            vertex_of: (0..soup.positions.len() as u32).collect(),
            uvs: None,
            indices: Vec::with_capacity(3 * triangles.corners.len()),
            normals: Vec::new(),
        };
        let mut split = uvs.map(|uvs| Split::new(uvs, soup.positions.len()));
        for (&face, corners) in triangles.faces.iter().zip(&triangles.corners) {
            for &corner in corners {
                let vertex = soup.faces[face][corner];
                let row = match &mut split {
                    None => vertex,
                    Some(split) => split.row(vertex, face, corner, &mut content.vertex_of),
                };
                content.indices.push(row);
            }
        }
        content.uvs = split.map(|split| {
            split
                .uv_of
                .into_iter()
                .map(Option::unwrap_or_default)
                .collect()
        });
        // A vertex without a triangle has no normal; one must be given, of length 1.
        let normal = |&v: &u32| {
            triangles.normals[v as usize]
                .try_normalize(0.5)
                .unwrap_or(Vector3::z())
        };
        content.normals = content.vertex_of.iter().map(normal).collect();
        Ok(content)
    }
}

/// Vertices split where corners have different texture coordinates: the first keeps the row, others are appended.
struct Split<'a> {
    uvs: &'a CornerUvs,
    uv_of: Vec<Option<[f64; 2]>>,
    row_at: HashMap<(u32, [u64; 2]), u32>,
}

impl<'a> Split<'a> {
    fn new(uvs: &'a CornerUvs, n_vertices: usize) -> Self {
        Self {
            uvs,
            uv_of: vec![None; n_vertices],
            row_at: HashMap::new(),
        }
    }

    fn row(&mut self, vertex: u32, face: usize, corner: usize, vertex_of: &mut Vec<u32>) -> u32 {
        let uv = self.uvs.at(face, corner).unwrap_or_default();
        let known = self.row_at.entry((vertex, uv.map(f64::to_bits)));
        *known.or_insert_with(|| {
            let own = &mut self.uv_of[vertex as usize];
            if own.is_none() {
                *own = Some(uv);
                return vertex;
            }
            self.uv_of.push(Some(uv));
            vertex_of.push(vertex);
            vertex_of.len() as u32 - 1
        })
    }
}

fn document(content: &Content, positions: &[Point3], n_bytes: usize, uri: &str) -> String {
    let (n, n_indices) = (positions.len(), content.indices.len());
    let bound = |start: f32, pick: fn(f32, f32) -> f32| {
        [0, 1, 2].map(|axis| positions.iter().map(|p| p[axis] as f32).fold(start, pick))
    };
    let [min, max] = [
        bound(f32::INFINITY, f32::min),
        bound(f32::NEG_INFINITY, f32::max),
    ];
    let mut views = vec![12 * n, 12 * n];
    let mut accessors = vec![
        format!("\"componentType\":5126,\"count\":{n},\"type\":\"VEC3\",\"min\":{min:?},\"max\":{max:?}"),
        format!("\"componentType\":5126,\"count\":{n},\"type\":\"VEC3\""),
    ];
    let mut attributes = "\"POSITION\":0,\"NORMAL\":1".to_owned();
    if content.uvs.is_some() {
        views.push(8 * n);
        accessors.push(format!(
            "\"componentType\":5126,\"count\":{n},\"type\":\"VEC2\""
        ));
        attributes += ",\"TEXCOORD_0\":2";
    }
    // Some readers pass over texture coordinates where there is no material.
    let mut primitive = format!("\"attributes\":{{{attributes}}},\"material\":0");
    if n_indices == 0 {
        primitive += ",\"mode\":0";
    } else {
        primitive += &format!(",\"indices\":{}", views.len());
        views.push(4 * n_indices);
        accessors.push(format!(
            "\"componentType\":5125,\"count\":{n_indices},\"type\":\"SCALAR\""
        ));
    }
    let mut offset = 0;
    let views: Vec<String> = views
        .iter()
        .map(|length| {
            let view = format!("{{\"buffer\":0,\"byteOffset\":{offset},\"byteLength\":{length}}}");
            offset += length;
            view
        })
        .collect();
    let accessors: Vec<String> = accessors
        .iter()
        .enumerate()
        .map(|(view, rest)| format!("{{\"bufferView\":{view},{rest}}}"))
        .collect();
    format!(
        "{{\"asset\":{{\"version\":\"2.0\"}},\"scene\":0,\"scenes\":[{{\"nodes\":[0]}}],\"nodes\":[{{\"mesh\":0}}],\
         \"meshes\":[{{\"primitives\":[{{{primitive}}}]}}],\"materials\":[{{\"pbrMetallicRoughness\":{{\"metallicFactor\":0}}}}],\"accessors\":[{}],\"bufferViews\":[{}],\
         \"buffers\":[{{\"byteLength\":{n_bytes}{uri}}}]}}",
        accessors.join(","),
        views.join(",")
    )
}
