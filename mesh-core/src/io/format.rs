//! Which format a file is in: by content first, by extension second.

use std::path::Path;

use super::document::Codec;
use super::{gltf, gzip, obj, off, ply, stl, xyz};

/// A mesh format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Format {
    /// Wavefront OBJ.
    Obj,
    /// Geomview OFF and its kin.
    Off,
    /// PLY, in any encoding.
    Ply,
    /// STL, text or binary.
    Stl,
    /// A list of points, one a line.
    Xyz,
    /// glTF 2.0 as a JSON document.
    Gltf,
    /// glTF 2.0 as one binary file.
    Glb,
}

/// All formats, in the order in which content is tried.
const ALL: [Format; 7] = [
    Format::Ply,
    Format::Stl,
    Format::Glb,
    Format::Gltf,
    Format::Off,
    Format::Obj,
    Format::Xyz,
];

impl Format {
    /// The name people use.
    pub fn name(self) -> &'static str {
        self.codec().name
    }

    /// The usual extension of its files, without a point.
    pub fn extension(self) -> &'static str {
        self.codec().extensions[0]
    }

    /// The format that the extension of `path` names, a final `.gz` aside.
    pub fn of_extension(path: &Path) -> Option<Self> {
        let inner = gzip::inner_path(path);
        let path = inner.as_deref().unwrap_or(path);
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        let is_named = |format: &Self| format.codec().extensions.contains(&extension.as_str());
        ALL.into_iter().find(is_named)
    }

    /// The format of a file of these bytes: the one whose mark they bear, or else the one that the extension names
    /// unless its files all bear a mark, or else the one whose statement comes first.
    pub(super) fn detect(bytes: &[u8], path: &Path) -> Option<Self> {
        let named = Self::of_extension(path);
        let marked = ALL.into_iter().find(|f| (f.codec().has_mark)(bytes));
        marked
            .or_else(|| named.filter(|f| !f.codec().is_always_marked))
            .or_else(|| ALL.into_iter().find(|f| (f.codec().has_statement)(bytes)))
            .or(named)
    }

    /// How files of this format are read and made.
    pub(super) fn codec(self) -> &'static Codec {
        match self {
            Self::Obj => &obj::CODEC,
            Self::Off => &off::CODEC,
            Self::Ply => &ply::CODEC,
            Self::Stl => &stl::CODEC,
            Self::Xyz => &xyz::CODEC,
            Self::Gltf => &gltf::GLTF,
            Self::Glb => &gltf::GLB,
        }
    }
}
