//! The parts of a glTF or GLB file: the JSON document and the buffers it names.

use std::borrow::Cow;
use std::collections::HashSet;
use std::ops::Range;
use std::path::{Component, Path, PathBuf};

use base64::engine::general_purpose::STANDARD;
use base64::Engine;
use gltf::json::Root;

use super::accessor::Layout;
use super::json_spans::{items, member, root};
use super::prune::Edit;
use crate::io::error::{excerpt, Fault, ReadProblem};

const MAGIC: &[u8] = b"glTF";
const HEADER: usize = 12;
const CHUNK_HEADER: usize = 8;

/// A file taken apart.
pub(super) struct Container<'a> {
    bytes: &'a [u8],
    json: Range<usize>,
    pub(super) root: Root,
    pub(super) buffers: Vec<Cow<'a, [u8]>>,
    /// Where the binary chunk is, if the first buffer lives there.
    chunk: Option<Range<usize>>,
}

/// Whether the file is a GLB.
pub(in crate::io) fn is_glb(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

impl<'a> Container<'a> {
    /// Takes apart the content of the file called `path`; buffers in other files are read from its folder.
    pub(super) fn read(bytes: &'a [u8], path: &Path) -> Result<Self, Fault> {
        let (json, chunk) = if is_glb(bytes) {
            chunks(bytes)?
        } else {
            (0..bytes.len(), None)
        };
        let root = Root::from_slice(&bytes[json.clone()])
            .map_err(|e| Fault::whole(ReadProblem::Json(e.to_string())))?;
        check_extensions(&root)?;
        let mut container = Self {
            bytes,
            json,
            root,
            buffers: Vec::new(),
            chunk: None,
        };
        let mut files = HashSet::new();
        for (k, buffer) in container.root.buffers.iter().enumerate() {
            // One large file, named often enough, would fill any memory.
            let file = buffer.uri.as_deref().and_then(file_named);
            if let Some(file) = file.filter(|file| !files.insert(file.clone())) {
                let feature = format!("two buffers of the one file `{}`", file.display());
                return Err(unsupported(feature, "save the file as GLB"));
            }
            let data = match (&buffer.uri, &chunk) {
                (Some(uri), _) => Cow::Owned(load(uri, path)?),
                (None, Some(chunk)) if k == 0 => {
                    container.chunk = Some(chunk.clone());
                    Cow::Borrowed(&bytes[chunk.clone()])
                }
                (None, _) => Cow::Borrowed(&bytes[..0]),
            };
            container.buffers.push(data);
        }
        Ok(container)
    }

    /// The text of the document.
    pub(super) fn json(&self) -> &[u8] {
        &self.bytes[self.json.clone()]
    }

    /// All bytes there are for data.
    pub(super) fn n_bytes(&self) -> usize {
        self.bytes.len() + self.buffers.iter().map(|b| b.len()).sum::<usize>()
    }

    /// The file with new data in its buffers, and with `min` and `max` of some accessors replaced. The text of buffers
    /// that live elsewhere moves into the document.
    pub(super) fn with(
        &self,
        buffers: &[Option<Vec<u8>>],
        bounds: &[Bounds],
        mut edits: Vec<Edit>,
    ) -> Vec<u8> {
        let json = self.json();
        edits.extend(self.bounds_edits(json, bounds));
        let uris = self.array(json, "buffers");
        for (k, data) in buffers.iter().enumerate() {
            let uri = uris
                .get(k)
                .and_then(|object| member(json, object.clone(), "uri"));
            if let (Some(data), Some(uri)) = (data, uri) {
                let text = format!(
                    "\"data:application/octet-stream;base64,{}\"",
                    STANDARD.encode(data)
                );
                edits.push((uri, text));
            }
        }
        let json = edited(json, edits);
        let chunk = buffers.first().and_then(Option::as_deref);
        if is_glb(self.bytes) {
            self.glb(json, chunk)
        } else {
            json
        }
    }

    fn array(&self, json: &[u8], key: &str) -> Vec<Range<usize>> {
        member(json, root(json), key).map_or_else(Vec::new, |array| items(json, array))
    }

    fn bounds_edits(&self, json: &[u8], bounds: &[Bounds]) -> Vec<Edit> {
        let accessors = self.array(json, "accessors");
        let mut edits = Vec::new();
        for bound in bounds {
            for (key, [x, y, z]) in [("min", bound.min), ("max", bound.max)] {
                let object = accessors.get(bound.accessor).cloned();
                if let Some(span) = object.and_then(|object| member(json, object, key)) {
                    edits.push((span, format!("[{x},{y},{z}]")));
                }
            }
        }
        edits
    }

    fn glb(&self, mut json: Vec<u8>, chunk: Option<&[u8]>) -> Vec<u8> {
        if json != self.bytes[self.json.clone()] {
            json.truncate(json.trim_ascii_end().len());
            json.resize(json.len().next_multiple_of(4), b' ');
        }
        let length = self.bytes.len() - self.json.len() + json.len();
        let mut out = Vec::with_capacity(length);
        out.extend_from_slice(&self.bytes[..8]);
        // What follows the stated length of the file stays behind it.
        let stated = u32_at(self.bytes, 8) as usize - self.json.len() + json.len();
        out.extend_from_slice(&(stated as u32).to_le_bytes());
        out.extend_from_slice(&(json.len() as u32).to_le_bytes());
        out.extend_from_slice(&self.bytes[HEADER + 4..self.json.start]);
        out.extend_from_slice(&json);
        let behind = out.len();
        out.extend_from_slice(&self.bytes[self.json.end..]);
        if let (Some(data), Some(place)) = (chunk, &self.chunk) {
            let start = behind + place.start - self.json.end;
            out[start..start + data.len()].copy_from_slice(data);
        }
        out
    }
}

/// The smallest and largest coordinates of an accessor.
pub(super) struct Bounds {
    pub(super) accessor: usize,
    pub(super) min: [f32; 3],
    pub(super) max: [f32; 3],
}

impl Bounds {
    /// Those of all elements as they now stand in `buffers`; elements that are implied are zero.
    pub(super) fn of(accessor: usize, layout: &Layout, buffers: &[Vec<u8>]) -> Self {
        let (mut min, mut max) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for row in 0..layout.count {
            let values = match layout.slot(row) {
                None => [0.0; 3],
                Some((buffer, at)) => {
                    let raw = buffers[buffer][at..at + 12].as_chunks().0;
                    [0, 1, 2].map(|axis| f32::from_le_bytes(raw[axis]))
                }
            };
            for (axis, c) in values.into_iter().enumerate() {
                (min[axis], max[axis]) = (min[axis].min(c), max[axis].max(c));
            }
        }
        Self { accessor, min, max }
    }
}

fn edited(json: &[u8], mut edits: Vec<Edit>) -> Vec<u8> {
    edits.sort_by_key(|(span, _)| span.start);
    let mut splice = crate::io::text::Splice::new(json);
    for (span, text) in edits {
        splice.replace(span, text.as_bytes());
    }
    splice.finish()
}

fn u32_at(bytes: &[u8], at: usize) -> u32 {
    let raw = bytes.get(at..at + 4).and_then(|b| b.first_chunk());
    raw.map_or(0, |raw| u32::from_le_bytes(*raw))
}

type Chunks = (Range<usize>, Option<Range<usize>>);

/// The JSON chunk and the binary chunk of a GLB.
fn chunks(bytes: &[u8]) -> Result<Chunks, Fault> {
    let early = || {
        Fault::whole(ReadProblem::EndsEarly {
            expected: "the rest of a GLB",
        })
    };
    let version = u32_at(bytes, 4);
    if version != 2 {
        return Err(unsupported(
            format!("GLB version {version}"),
            "save it as glTF 2.0",
        ));
    }
    let stated = u32_at(bytes, 8) as usize;
    let chunk = |at: usize, kind: &[u8]| {
        let header = bytes.get(at..at + CHUNK_HEADER)?;
        let start = at + CHUNK_HEADER;
        let end = start.checked_add(u32_at(bytes, at) as usize)?;
        (&header[4..] == kind && end <= stated.min(bytes.len())).then_some(start..end)
    };
    let json = chunk(HEADER, b"JSON").ok_or_else(early)?;
    if stated > bytes.len() {
        return Err(early());
    }
    let binary = chunk(json.end, b"BIN\0");
    Ok((json, binary))
}

pub(super) fn unsupported(feature: String, advice: &'static str) -> Fault {
    Fault::whole(ReadProblem::Unsupported { feature, advice })
}

/// Compressed data would not be seen, or would be left behind when the mesh moves.
fn check_extensions(root: &Root) -> Result<(), Fault> {
    const COMPRESSED: [&str; 3] = [
        "KHR_draco_mesh_compression",
        "EXT_meshopt_compression",
        "KHR_meshopt_compression",
    ];
    let mut named = root.extensions_required.iter().chain(&root.extensions_used);
    match named.find(|name| COMPRESSED.contains(&name.as_str())) {
        None => Ok(()),
        Some(name) => Err(unsupported(
            format!("a glTF compressed with {name}"),
            "save it without mesh compression",
        )),
    }
}

fn load(uri: &str, path: &Path) -> Result<Vec<u8>, Fault> {
    let advice = "save the file as GLB";
    let shown = || format!("the buffer `{}`", excerpt(uri.as_bytes()));
    if let Some(data) = uri.strip_prefix("data:") {
        let text = data.split_once(";base64,").map(|(_, text)| text);
        return text
            .and_then(|text| STANDARD.decode(text).ok())
            .ok_or_else(|| unsupported(shown(), advice));
    }
    let file = file_named(uri).map(|name| path.with_file_name(name));
    let Some(file) = file.filter(|file| file.is_file()) else {
        return Err(unsupported(
            shown(),
            "put it in the same folder, or save the file as GLB",
        ));
    };
    std::fs::read(file).map_err(|e| Fault::whole(ReadProblem::Io(e)))
}

/// The file beside the document that `uri` names, if it names one.
fn file_named(uri: &str) -> Option<PathBuf> {
    if uri.starts_with("data:") || uri.contains("://") {
        return None;
    }
    let name = PathBuf::from(percent_decoded(uri));
    let parts = name.components().filter(|c| *c != Component::CurDir);
    parts
        .map(|c| matches!(c, Component::Normal(_)).then_some(c))
        .collect()
}

fn percent_decoded(uri: &str) -> String {
    let bytes = uri.as_bytes();
    let mut out = Vec::with_capacity(bytes.len());
    let mut k = 0;
    while k < bytes.len() {
        let hex = uri.get(k + 1..k + 3).filter(|_| bytes[k] == b'%');
        match hex.and_then(|hex| u8::from_str_radix(hex, 16).ok()) {
            Some(byte) => {
                out.push(byte);
                k += 3;
            }
            None => {
                out.push(bytes[k]);
                k += 1;
            }
        }
    }
    String::from_utf8_lossy(&out).into_owned()
}
