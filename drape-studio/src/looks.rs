//! What the page needs to show a shape as it was scanned: colours, texture coordinates of its triangles, pictures.

use std::ops::Range;

use axum::body::Bytes;
use mesh_core::io::{Looks, Rgb};
use serde_json::{json, Value};

/// The looks of a shape, as bytes.
#[derive(Clone, Debug, Default)]
pub(crate) struct DisplayedLooks {
    /// Red, green, blue and 255 of each vertex.
    pub(crate) colors: Option<Bytes>,
    /// Two f32 for each corner of each triangle; both −1 where it has none.
    pub(crate) uvs: Option<Bytes>,
    /// The pictures, and the rows of the triangles that show them.
    pictures: Vec<(Vec<Range<usize>>, Bytes)>,
}

/// The triangles that are shown: the row of the face of each, and its corners as rows of the file.
pub(crate) struct ShownTriangle {
    pub(crate) face: usize,
    pub(crate) corners: [usize; 3],
}

/// Where a corner has no coordinates.
const NO_UV: [f64; 2] = [-1.0, -1.0];

impl DisplayedLooks {
    /// Of a file with such faces; `rows` tells for each vertex that is shown its row in the file, `triangles` what is
    /// shown, in the order of the faces.
    pub(crate) fn new(
        looks: Looks,
        faces: &[Vec<u32>],
        rows: impl Iterator<Item = usize>,
        triangles: &[ShownTriangle],
    ) -> Self {
        let colors = looks.vertex_colors.as_ref();
        let uvs = looks.corner_uvs.as_ref();
        Self {
            colors: colors.map(|colors| color_bytes(colors, rows)),
            uvs: uvs.map(|uvs| uv_bytes(uvs, faces, triangles)),
            pictures: looks
                .pictures
                .into_iter()
                .map(|p| (triangle_ranges(&p.faces, triangles), p.bytes.into()))
                .collect(),
        }
    }

    /// What the page is told of them: whether there are colours, and the triangles of each picture.
    pub(crate) fn state(&self) -> Value {
        let has_pictures = self.uvs.is_some();
        let ranges = self.pictures.iter().filter(|_| has_pictures);
        let ranges: Vec<Vec<[usize; 2]>> = ranges
            .map(|(ranges, _)| ranges.iter().map(|r| [r.start, r.end]).collect())
            .collect();
        json!({ "colors": self.colors.is_some(), "pictures": ranges })
    }

    /// The bytes called so: `colors`, `uvs`, or the number of a picture.
    pub(crate) fn bytes(&self, what: &str) -> Option<Bytes> {
        match what {
            "colors" => self.colors.clone(),
            "uvs" => self.uvs.clone(),
            _ => {
                let row: usize = what.parse().ok()?;
                self.pictures.get(row).map(|(_, bytes)| bytes.clone())
            }
        }
    }
}

fn color_bytes(colors: &[Rgb], rows: impl Iterator<Item = usize>) -> Bytes {
    let byte = |c: f32| (c.clamp(0.0, 1.0) * 255.0).round() as u8;
    let rgba = rows.flat_map(|row| {
        let [r, g, b] = colors.get(row).copied().unwrap_or([1.0; 3]).map(byte);
        [r, g, b, u8::MAX]
    });
    rgba.collect::<Vec<u8>>().into()
}

fn uv_bytes(
    uvs: &[Vec<Option<[f64; 2]>>],
    faces: &[Vec<u32>],
    triangles: &[ShownTriangle],
) -> Bytes {
    let mut bytes = Vec::with_capacity(24 * triangles.len());
    for triangle in triangles {
        for row in triangle.corners {
            let corners = faces.get(triangle.face);
            let corner = corners.and_then(|f| f.iter().position(|&v| v as usize == row));
            let uv = corner.and_then(|c| *uvs.get(triangle.face)?.get(c)?);
            for c in uv.unwrap_or(NO_UV) {
                bytes.extend((c as f32).to_le_bytes());
            }
        }
    }
    bytes.into()
}

/// Rows of the triangles of some faces, where triangles are in the order of their faces.
fn triangle_ranges(faces: &[Range<usize>], triangles: &[ShownTriangle]) -> Vec<Range<usize>> {
    let first = |face: usize| triangles.partition_point(|t| t.face < face);
    faces.iter().map(|r| first(r.start)..first(r.end)).collect()
}

/// The kind of a picture by its first bytes.
pub(crate) fn kind_of(bytes: &[u8]) -> &'static str {
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => "image/png",
        [0xff, 0xd8, ..] => "image/jpeg",
        [b'R', b'I', b'F', b'F', ..] => "image/webp",
        [b'B', b'M', ..] => "image/bmp",
        _ => "application/octet-stream",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh_core::io::Picture;

    #[test]
    fn a_quad_shows_its_picture_with_both_triangles() {
        let faces = vec![vec![0, 1, 2, 3], vec![3, 2, 4]];
        let uv = |k: usize| Some([k as f64, 0.5]);
        let looks = Looks {
            vertex_colors: Some(vec![[0.0, 0.5, 1.0]; 5]),
            corner_uvs: Some(vec![(0..4).map(uv).collect(), vec![None; 3]]),
            pictures: vec![Picture {
                faces: std::iter::once(0..1).collect(),
                bytes: vec![1, 2],
            }],
        };
        let triangle = |face, corners| ShownTriangle { face, corners };
        let triangles = [
            triangle(0, [0, 1, 2]),
            triangle(0, [0, 2, 3]),
            triangle(1, [3, 2, 4]),
        ];
        let shown = DisplayedLooks::new(looks, &faces, 0..5, &triangles);
        assert_eq!(
            shown.state(),
            json!({ "colors": true, "pictures": [[[0, 2]]] })
        );
        assert_eq!(&shown.bytes("colors").unwrap()[..4], &[0, 128, 255, 255]);
        let uvs = shown.bytes("uvs").unwrap();
        let number = |k: usize| f32::from_le_bytes(*uvs[4 * k..].first_chunk().unwrap());
        // The last corner of the second triangle is the fourth of the quad.
        assert_eq!([number(10), number(11), number(12)], [3.0, 0.5, -1.0]);
        assert_eq!(shown.bytes("0").unwrap().as_ref(), [1, 2]);
        assert!(shown.bytes("1").is_none() && shown.bytes("x").is_none());
    }

    #[test]
    fn pictures_are_told_by_their_first_bytes() {
        assert_eq!(kind_of(b"\x89PNG\r\n"), "image/png");
        assert_eq!(kind_of(b"<svg"), "application/octet-stream");
    }
}
