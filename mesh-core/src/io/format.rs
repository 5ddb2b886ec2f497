//! Which format a file is in: by content first, by extension second.

use std::path::Path;

use super::text::{number, Cursor};
use super::{gltf, gzip, off, stl, xyz};

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

impl Format {
    /// The name people use.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Obj => "OBJ",
            Self::Off => "OFF",
            Self::Ply => "PLY",
            Self::Stl => "STL",
            Self::Xyz => "XYZ",
            Self::Gltf => "glTF",
            Self::Glb => "GLB",
        }
    }

    /// The format that the extension of `path` names, a final `.gz` aside.
    pub fn of_extension(path: &Path) -> Option<Self> {
        let inner = gzip::inner_path(path);
        let path = inner.as_deref().unwrap_or(path);
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        Some(match extension.as_str() {
            "obj" => Self::Obj,
            "off" | "coff" | "noff" | "cnoff" | "stoff" => Self::Off,
            "ply" => Self::Ply,
            "stl" => Self::Stl,
            "gltf" => Self::Gltf,
            "glb" => Self::Glb,
            "xyz" | "xyzn" | "pts" | "asc" | "csv" | "txt" => Self::Xyz,
            _ => return None,
        })
    }

    /// The format of a file of these bytes; OBJ has no mark of its own, so there the extension speaks first.
    pub(super) fn detect(bytes: &[u8], path: &Path) -> Option<Self> {
        Self::of_mark(bytes)
            .or_else(|| Self::of_extension(path))
            .or_else(|| Self::of_first_statement(bytes))
    }

    fn of_mark(bytes: &[u8]) -> Option<Self> {
        if bytes.starts_with(b"ply") && matches!(bytes.get(3), Some(b'\n' | b'\r')) {
            return Some(Self::Ply);
        }
        if stl::is_binary(bytes) || stl::is_text(bytes) {
            return Some(Self::Stl);
        }
        if gltf::is_glb(bytes) {
            return Some(Self::Glb);
        }
        let first = Cursor::new(bytes).word()?;
        if first.text.starts_with(b"{") {
            return Some(Self::Gltf);
        }
        off::keyword_prefix(first.text).map(|_| Self::Off)
    }

    fn of_first_statement(bytes: &[u8]) -> Option<Self> {
        let mut cursor = Cursor::new(bytes);
        let keyword = cursor.word()?.text;
        let is_vertex = |mut line: Cursor<'_>| {
            (0..3).all(|_| line.field().is_some_and(|f| number(f.text).is_some()))
        };
        match keyword {
            b"v" if is_vertex(cursor) => Some(Self::Obj),
            b"mtllib" | b"usemtl" | b"o" | b"g" | b"s" | b"vn" | b"vt" => Some(Self::Obj),
            _ => xyz::is_points(bytes).then_some(Self::Xyz),
        }
    }

    /// Whether files of this format are text throughout.
    pub(super) const fn is_text(self) -> bool {
        matches!(self, Self::Obj | Self::Off | Self::Xyz)
    }
}
