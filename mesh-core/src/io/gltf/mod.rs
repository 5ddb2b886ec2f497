//! glTF and GLB: the meshes of the scene as one soup. Written back, only POSITION, NORMAL, TANGENT and the bounds of
//! the positions differ; skins, joints, morph targets, texture coordinates, materials and animations stay as they are.

mod accessor;
mod bounds;
mod container;
mod extensions;
mod file;
mod frame;
mod json;
mod json_spans;
mod looks;
mod morphs;
mod nodes;
mod prune;
mod rewrite;
mod root;
mod scene;
mod unmovable;
mod write;

use std::path::Path;

use self::file::{GltfFile, Shown};
use super::contents::{Contents, Morphs};
use super::document::{Codec, Document, Geometry, Parsed, Unmovable};
use super::fault::Fault;
use super::looks::{NamedPicture, Rgb};
use super::text::Cursor;
use super::uvs::CornerUvs;
use crate::{Point3, PolygonSoup, Vector3};

pub(super) const GLTF: Codec = Codec {
    name: "glTF",
    extensions: &["gltf"],
    is_text: false,
    geometry: Geometry::Triangles,
    has_uvs: true,
    has_mark: is_document,
    is_always_marked: true,
    has_statement: |_| false,
    read,
    write: write::write_gltf,
};

pub(super) const GLB: Codec = Codec {
    name: "GLB",
    extensions: &["glb"],
    has_mark: container::is_glb,
    write: write::write_glb,
    ..GLTF
};

fn is_document(bytes: &[u8]) -> bool {
    let first = Cursor::new(bytes).word();
    first.is_some_and(|word| word.text.starts_with(b"{"))
}

fn read(bytes: Vec<u8>, path: &Path) -> Result<Parsed, Fault> {
    let Shown {
        file,
        soup,
        contents,
        findings,
    } = GltfFile::read(bytes, path)?;
    Ok(Parsed {
        soup,
        contents,
        findings,
        document: Box::new(file),
    })
}

impl Document for GltfFile {
    /// The normals as the file has them, turned with their nodes.
    fn vertex_normals(&self, soup: &PolygonSoup) -> Option<Vec<Vector3>> {
        let mut out = vec![Vector3::zeros(); soup.positions.len()];
        let mut any = false;
        for block in &self.blocks {
            let Some(normals) = &block.normals else {
                continue;
            };
            for row in block.rows.clone() {
                let in_block = row - block.rows.start;
                let n = Vector3::from(normals.get::<3>(&self.container, in_block));
                out[row] = match block.frame.linear(in_block) {
                    None => n,
                    Some(linear) => linear
                        .try_inverse()
                        .map_or_else(Vector3::zeros, |back| back.transpose() * n),
                };
                any = true;
            }
        }
        any.then_some(out)
    }

    /// The first set; (0, 0) at the lower left, where these files have it above.
    fn corner_uvs(&self, soup: &PolygonSoup) -> Option<CornerUvs> {
        let mut out = vec![[0.0; 2]; soup.positions.len()];
        let mut any = false;
        for block in &self.blocks {
            let Some(uvs) = &block.uvs else { continue };
            for row in block.rows.clone() {
                let uv = uvs.get::<2>(&self.container, row - block.rows.start);
                if uv.iter().all(|c| c.is_finite()) {
                    out[row] = [uv[0], 1.0 - uv[1]];
                }
                any = true;
            }
        }
        any.then(|| CornerUvs::of_vertices(out, soup))
    }

    fn vertex_colors(&self, n_vertices: usize) -> Option<Vec<Rgb>> {
        self.colors(n_vertices)
    }

    fn pictures(&self, contents: &Contents, _: usize, _: &Path) -> Vec<NamedPicture> {
        // What was read without looking at pictures can have faults in them: they are then not shown.
        self.pictures(&contents.materials).unwrap_or_default()
    }

    fn find_unmovable(&self, morphs: Morphs) -> Result<Option<Unmovable>, Fault> {
        unmovable::find_unmovable(self, morphs)
    }

    fn rewrite(
        &self,
        rest: &PolygonSoup,
        moved: &[Point3],
        morphs: Morphs,
    ) -> Result<Vec<u8>, Fault> {
        rewrite::rewrite(self, rest, moved, morphs)
    }
}
