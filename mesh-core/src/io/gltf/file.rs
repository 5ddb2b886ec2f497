//! A glTF file as it was read: its parts, and where the numbers of its vertices stand.

use std::path::Path;

use super::container::Container;
use super::scene::{Block, Scene};
use crate::io::contents::Contents;
use crate::io::fault::Fault;
use crate::io::finding::Finding;
use crate::PolygonSoup;

/// What a rewrite needs to know of a file.
#[derive(Debug)]
pub(super) struct GltfFile {
    pub(super) container: Container,
    pub(super) blocks: Vec<Block>,
}

/// A file and what it shows.
pub(super) struct Shown {
    pub(super) file: GltfFile,
    pub(super) soup: PolygonSoup,
    pub(super) contents: Contents,
    pub(super) findings: Vec<Finding>,
}

impl GltfFile {
    /// Reads the content of the file called `path`: the vertices of each mesh where its node puts them, and their
    /// triangles.
    pub(super) fn read(bytes: Vec<u8>, path: &Path) -> Result<Shown, Fault> {
        let container = Container::read(bytes, path)?;
        let scene = Scene::read(&container)?;
        Ok(Shown {
            file: Self {
                container,
                blocks: scene.blocks,
            },
            soup: scene.soup,
            contents: scene.contents,
            findings: scene.findings,
        })
    }
}
