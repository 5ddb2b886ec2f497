//! The pictures and colours of a glTF file.

use std::collections::HashMap;

use base64::engine::general_purpose::STANDARD;
use base64::Engine as _;

use super::container::percent_decoded;
use super::file::GltfFile;
use super::json::document;
use crate::io::contents::NamedFaces;
use crate::io::fault::Fault;
use crate::io::looks::{NamedPicture, PictureAt, Rgb};

impl GltfFile {
    /// One colour per vertex, white where a mesh has none; linear, as the format has them, brought to the curve of
    /// screens.
    pub(super) fn colors(&self, n_vertices: usize) -> Option<Vec<Rgb>> {
        let mut out = vec![[1.0; 3]; n_vertices];
        let mut any = false;
        for block in &self.blocks {
            let Some(colors) = &block.colors else {
                continue;
            };
            for row in block.rows.clone() {
                let linear = colors.get::<3>(&self.container, row - block.rows.start);
                out[row] = linear.map(|c| to_screen(c) as f32);
            }
            any = true;
        }
        any.then_some(out)
    }

    /// The base colour's picture of each material that faces have.
    pub(super) fn pictures(&self, materials: &[NamedFaces]) -> Result<Vec<NamedPicture>, Fault> {
        let root = document(self.container.json())?;
        let images = root.objects("images", None)?;
        let textures = root.objects("textures", None)?;
        let mut picture_of = HashMap::new();
        for (row, material) in root.objects("materials", None)?.iter().enumerate() {
            let shading = material.object("pbrMetallicRoughness")?;
            let Some(base) = shading
                .map(|s| s.object("baseColorTexture"))
                .transpose()?
                .flatten()
            else {
                continue;
            };
            let texture = base.count("index")?.and_then(|k| textures.get(k));
            let image = texture.map(|t| t.count("source")).transpose()?.flatten();
            let Some(image) = image.and_then(|k| images.get(k)) else {
                continue;
            };
            let name = material.text("name")?;
            let name = name.unwrap_or_else(|| format!("material {row}"));
            let at = match (image.text("uri")?, image.count("bufferView")?) {
                (Some(uri), _) => of_uri(uri),
                (None, Some(view)) => self.view(view).map(PictureAt::Bytes),
                (None, None) => None,
            };
            if let Some(at) = at {
                picture_of.insert(name, at);
            }
        }
        let shown = materials.iter().filter_map(|material| {
            Some((
                material.faces.clone(),
                picture_of.get(&material.name)?.clone(),
            ))
        });
        Ok(shown.collect())
    }

    /// The bytes of a stretch of a buffer.
    fn view(&self, k: usize) -> Option<Vec<u8>> {
        let view = self.container.root.views.get(k)?;
        let end = view.offset.checked_add(view.length)?;
        let bytes = self.container.buffer(view.buffer)?.get(view.offset..end)?;
        Some(bytes.to_vec())
    }
}

/// A file, or what stands in the text itself.
fn of_uri(uri: String) -> Option<PictureAt> {
    match uri.strip_prefix("data:") {
        None => Some(PictureAt::File(percent_decoded(&uri))),
        Some(data) => {
            let (_, text) = data.split_once("base64,")?;
            Some(PictureAt::Bytes(STANDARD.decode(text.trim()).ok()?))
        }
    }
}

/// From linear light to the curve of screens (sRGB).
fn to_screen(linear: f64) -> f64 {
    let c = linear.clamp(0.0, 1.0);
    if c <= 0.003_130_8 {
        12.92 * c
    } else {
        1.055 * c.powf(1.0 / 2.4) - 0.055
    }
}
