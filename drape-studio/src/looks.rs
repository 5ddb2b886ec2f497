//! What the page needs to show a shape as it was scanned: colours, texture coordinates of its triangles, pictures.

use std::ops::Range;

use axum::body::Bytes;
use mesh_core::io::{Looks, Rgb};
use serde_json::{json, Value};

use crate::seams::{Seams, Uv};

/// The looks of a shape, as bytes.
#[derive(Clone, Debug, Default)]
pub(crate) struct DisplayedLooks {
    /// Red, green, blue and 255 of each vertex.
    pub(crate) colors: Option<Bytes>,
    /// Where the vertices are on the pictures.
    places: Option<DrawnPlaces>,
    /// The pictures, and the rows of the triangles that show them.
    pictures: Vec<(Vec<Range<usize>>, Bytes)>,
}

/// Vertices as they are drawn with pictures, as bytes.
#[derive(Clone, Debug)]
struct DrawnPlaces {
    /// Two f32 for each vertex and each copy of one; both −1 where it has no place.
    uvs: Bytes,
    n_copies: usize,
    /// The vertex of each copy, as u32.
    copies: Bytes,
    /// The corners of the triangles, as u32; nothing where there are no copies, for they are the vertices then.
    corners: Bytes,
}

/// The triangles that are shown: the row of the face of each, its corners as rows of the file, and as vertices.
pub(crate) struct ShownTriangle {
    pub(crate) face: usize,
    pub(crate) rows: [usize; 3],
    pub(crate) vertices: [u32; 3],
}

/// Where a corner has no coordinates.
const NO_UV: Uv = [-1.0, -1.0];

impl DisplayedLooks {
    /// Of a file with such faces; `rows` tells for each vertex that is shown its row in the file, `triangles` what is
    /// shown, in the order of the faces.
    pub(crate) fn new(
        looks: Looks,
        faces: &[Vec<u32>],
        rows: impl ExactSizeIterator<Item = usize>,
        triangles: &[ShownTriangle],
    ) -> Self {
        let n_vertices = rows.len();
        let colors = looks.vertex_colors.as_ref();
        let uvs = looks.corner_uvs.as_ref();
        Self {
            colors: colors.map(|colors| color_bytes(colors, rows)),
            places: uvs.map(|uvs| {
                let places = triangles
                    .iter()
                    .map(|t| (t.vertices, places(uvs, faces, t)));
                DrawnPlaces::new(&Seams::new(n_vertices, places))
            }),
            pictures: looks
                .pictures
                .into_iter()
                .map(|p| (triangle_ranges(&p.faces, triangles), p.bytes.into()))
                .collect(),
        }
    }

    /// What the page is told of them: whether there are colours, the triangles of each picture, and how many vertices
    /// are drawn more than once.
    pub(crate) fn state(&self) -> Value {
        let has_pictures = self.places.is_some();
        let ranges = self.pictures.iter().filter(|_| has_pictures);
        let ranges: Vec<Vec<[usize; 2]>> = ranges
            .map(|(ranges, _)| ranges.iter().map(|r| [r.start, r.end]).collect())
            .collect();
        let n_copies = self.places.as_ref().map_or(0, |p| p.n_copies);
        json!({ "colors": self.colors.is_some(), "pictures": ranges, "copies": n_copies })
    }

    /// The bytes called so: `colors`, `uvs`, `copies`, `corners`, or the number of a picture.
    pub(crate) fn bytes(&self, what: &str) -> Option<Bytes> {
        let places = self.places.as_ref();
        match what {
            "colors" => self.colors.clone(),
            "uvs" => places.map(|p| p.uvs.clone()),
            "copies" => places.map(|p| p.copies.clone()),
            "corners" => places.map(|p| p.corners.clone()),
            _ => {
                let row: usize = what.parse().ok()?;
                self.pictures.get(row).map(|(_, bytes)| bytes.clone())
            }
        }
    }
}

impl DrawnPlaces {
    fn new(seams: &Seams) -> Self {
        let uvs = seams.uvs.iter().flat_map(|uv| uv.unwrap_or(NO_UV));
        let corners: &[[u32; 3]] = if seams.copies.is_empty() {
            &[]
        } else {
            &seams.corners
        };
        Self {
            uvs: uvs.flat_map(f32::to_le_bytes).collect(),
            n_copies: seams.copies.len(),
            copies: row_bytes(&seams.copies),
            corners: row_bytes(corners.as_flattened()),
        }
    }
}

fn row_bytes(rows: &[u32]) -> Bytes {
    rows.iter().flat_map(|row| row.to_le_bytes()).collect()
}

fn color_bytes(colors: &[Rgb], rows: impl Iterator<Item = usize>) -> Bytes {
    let byte = |c: f32| (c.clamp(0.0, 1.0) * 255.0).round() as u8;
    let rgba = rows.flat_map(|row| {
        let [r, g, b] = colors.get(row).copied().unwrap_or([1.0; 3]).map(byte);
        [r, g, b, u8::MAX]
    });
    rgba.collect::<Vec<u8>>().into()
}

/// The places of the corners of a triangle on the pictures.
fn places(uvs: &[Vec<Option<[f64; 2]>>], faces: &[Vec<u32>], triangle: &ShownTriangle) -> [Uv; 3] {
    let face = faces.get(triangle.face).zip(uvs.get(triangle.face));
    triangle.rows.map(|row| {
        let uv = face.and_then(|(face, uvs)| {
            let corner = face.iter().position(|&v| v as usize == row)?;
            *uvs.get(corner)?
        });
        uv.map_or(NO_UV, |uv| uv.map(|c| c as f32))
    })
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
        let triangle = |face, vertices: [u32; 3]| ShownTriangle {
            face,
            rows: vertices.map(|v| v as usize),
            vertices,
        };
        let triangles = [
            triangle(0, [0, 1, 2]),
            triangle(0, [0, 2, 3]),
            triangle(1, [3, 2, 4]),
        ];
        let shown = DisplayedLooks::new(looks, &faces, 0..5, &triangles);
        assert_eq!(
            shown.state(),
            json!({ "colors": true, "pictures": [[[0, 2]]], "copies": 2 })
        );
        assert_eq!(&shown.bytes("colors").unwrap()[..4], &[0, 128, 255, 255]);
        let uvs = shown.bytes("uvs").unwrap();
        let number = |k: usize| f32::from_le_bytes(*uvs[4 * k..].first_chunk().unwrap());
        // The fourth vertex is the fourth corner of the quad; the fifth is in the triangle without a picture alone.
        assert_eq!([6, 7, 8, 9].map(number), [3.0, 0.5, -1.0, -1.0]);
        // The two that are on the picture as well are drawn a second time.
        assert_eq!(shown.bytes("copies").unwrap(), row_bytes(&[3, 2]));
        let corners = row_bytes(&[0, 1, 2, 0, 2, 3, 5, 6, 4]);
        assert_eq!(shown.bytes("corners").unwrap(), corners);
        assert_eq!(shown.bytes("0").unwrap().as_ref(), [1, 2]);
        assert!(shown.bytes("1").is_none() && shown.bytes("x").is_none());
    }

    #[test]
    fn pictures_are_told_by_their_first_bytes() {
        assert_eq!(kind_of(b"\x89PNG\r\n"), "image/png");
        assert_eq!(kind_of(b"<svg"), "application/octet-stream");
    }
}
