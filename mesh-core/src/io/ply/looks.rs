//! The looks that a PLY file gives its surface: the picture that a comment names, coordinates of vertices or corners.

use super::body::Body;
use super::header::{Element, Kind, Property};
use super::PlyFile;
use crate::io::document::Document as _;
use crate::io::fault::Fault;
use crate::io::uvs::CornerUvs;
use crate::PolygonSoup;

/// What programs call the texture coordinates of vertices.
const UV_NAMES: [[&str; 2]; 3] = [["u", "v"], ["s", "t"], ["texture_u", "texture_v"]];
/// A comment with this word names a picture.
const PICTURE: &str = "comment TextureFile ";

impl PlyFile {
    /// The name of the picture, if a comment tells one.
    pub(super) fn picture(&self) -> Option<String> {
        let text = String::from_utf8_lossy(&self.bytes[..self.header.body]);
        let mut lines = text.lines();
        let name = lines.find_map(|line| line.trim().strip_prefix(PICTURE).map(str::to_owned))?;
        Some(name.trim().to_owned())
    }

    /// Coordinates of corners, else of vertices.
    pub(super) fn uvs(&self, soup: &PolygonSoup) -> Option<CornerUvs> {
        let of_corners = self.corner_uvs().ok().flatten();
        let of_corners = of_corners.filter(|uvs| uvs.faces.len() == soup.faces.len());
        of_corners.or_else(|| {
            let rows = UV_NAMES.iter().find_map(|[u, v]| {
                let (u, v) = (self.vertex_scalars(u)?, self.vertex_scalars(v)?);
                Some(u.into_iter().zip(v).map(|(u, v)| [u, v]).collect())
            })?;
            Some(CornerUvs::of_vertices(rows, soup))
        })
    }

    /// The list `texcoord` of the faces: u and v of each corner.
    fn corner_uvs(&self) -> Result<Option<CornerUvs>, Fault> {
        let mut body = Body::new(&self.bytes, &self.header);
        for element in &self.header.elements {
            let is_face = element.name == "face" && element.properties.iter().any(is_texcoord);
            if is_face {
                return read_lists(&mut body, element).map(Some);
            }
            body.skip_element(element)?;
        }
        Ok(None)
    }
}

fn is_texcoord(property: &Property) -> bool {
    property.name == "texcoord" && matches!(property.kind, Kind::List { .. })
}

fn read_lists<'a>(body: &mut Body<'a>, element: &'a Element) -> Result<CornerUvs, Fault> {
    let (mut rows, mut faces) = (Vec::new(), Vec::new());
    let mut values = Vec::new();
    body.each_row(element, |body, _| {
        values.clear();
        for property in &element.properties {
            match property.kind {
                Kind::List { count, item } if is_texcoord(property) => {
                    for _ in 0..body.list_length(count, item)? {
                        values.push(body.value_or_nan(item)?);
                    }
                }
                kind => body.skip(kind)?,
            }
        }
        let corner = |uv: &[f64]| {
            let row = rows.len() as u32;
            rows.push([uv[0], uv[1]]);
            Some(row).filter(|_| uv.iter().all(|c| c.is_finite()))
        };
        faces.push(values.chunks_exact(2).map(corner).collect());
        Ok(())
    })?;
    Ok(CornerUvs { rows, faces })
}
