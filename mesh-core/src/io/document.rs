//! What a format gives: a table of what its files can hold, and documents that know the way back.

use std::fmt;
use std::path::Path;

use super::contents::{Contents, Morphs};
use super::fault::{Fault, Unwritable};
use super::finding::Finding;
use super::looks::{NamedPicture, Rgb};
use super::uvs::CornerUvs;
use crate::{Point3, PolygonSoup, Vector3};

/// A format: how its files are told from others, what they can hold, and how they are read and made.
pub(super) struct Codec {
    /// The name people use.
    pub(super) name: &'static str,
    /// The extensions of its files, in lower case, the usual one first.
    pub(super) extensions: &'static [&'static str],
    /// Whether its files are text throughout.
    pub(super) is_text: bool,
    /// What its files hold.
    pub(super) geometry: Geometry,
    /// Whether texture coordinates go into its files, and can be taken from them.
    pub(super) has_uvs: bool,
    /// Whether bytes begin as no file of another format does.
    pub(super) has_mark: fn(&[u8]) -> bool,
    /// Whether every sound file of this format has its mark.
    pub(super) is_always_marked: bool,
    /// Whether the first statement of a file without a mark is one of this format.
    pub(super) has_statement: fn(&[u8]) -> bool,
    /// Reads the content of the file called so.
    pub(super) read: fn(Vec<u8>, &Path) -> Result<Parsed, Fault>,
    /// A new file.
    pub(super) write: fn(&PolygonSoup, Option<&CornerUvs>) -> Result<Vec<u8>, Unwritable>,
}

/// What the files of a format hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Geometry {
    /// Points in double precision.
    Points,
    /// Polygons of any arity over shared vertices, in double precision.
    Polygons,
    /// Triangles over shared vertices, in single precision.
    Triangles,
    /// Triangles with corners of their own, in single precision.
    SeparateTriangles,
}

impl Geometry {
    /// Whether polygons become triangles and coordinates single precision.
    pub(super) fn is_triangles(self) -> bool {
        matches!(self, Self::Triangles | Self::SeparateTriangles)
    }
}

/// A file as it was read.
pub(super) struct Parsed {
    pub(super) soup: PolygonSoup,
    pub(super) contents: Contents,
    pub(super) findings: Vec<Finding>,
    pub(super) document: Box<dyn Document>,
}

/// The bytes of a file and what was found in them: all but points and polygons, which come from it and go back into it.
pub(super) trait Document: fmt::Debug + Send + Sync {
    /// One normal per vertex of `soup`, of any length, if the file has normals.
    fn vertex_normals(&self, soup: &PolygonSoup) -> Option<Vec<Vector3>>;

    /// The values of a scalar that the file has at each vertex.
    fn vertex_scalars(&self, _name: &str) -> Option<Vec<f64>> {
        None
    }

    /// The texture coordinates that can go into a file of another format.
    fn corner_uvs(&self, _soup: &PolygonSoup) -> Option<CornerUvs> {
        None
    }

    /// One colour per vertex.
    fn vertex_colors(&self, _n_vertices: usize) -> Option<Vec<Rgb>> {
        None
    }

    /// The texture coordinates that are shown.
    fn shown_uvs(&self, soup: &PolygonSoup) -> Option<CornerUvs> {
        self.corner_uvs(soup)
    }

    /// The pictures on faces of a file in a folder.
    fn pictures(&self, _contents: &Contents, _n_faces: usize, _folder: &Path) -> Vec<NamedPicture> {
        Vec::new()
    }

    /// What keeps the vertices from being moved one by one, whatever their new positions.
    fn find_unmovable(&self, _morphs: Morphs) -> Result<Option<Unmovable>, Fault> {
        Ok(None)
    }

    /// The file with its vertices, which were at those of `rest`, at `moved`.
    fn rewrite(
        &self,
        rest: &PolygonSoup,
        moved: &[Point3],
        morphs: Morphs,
    ) -> Result<Vec<u8>, Fault>;
}

/// Something in a file that cannot take new positions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Unmovable {
    /// What it is.
    pub(super) feature: &'static str,
    /// What to do about it.
    pub(super) advice: &'static str,
}
