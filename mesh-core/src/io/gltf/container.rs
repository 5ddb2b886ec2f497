//! The parts of a glTF or GLB file: the JSON document and the buffers it names.

use std::collections::HashSet;
use std::ops::Range;
use std::path::{Component, Path, PathBuf};

use base64::engine::general_purpose::STANDARD;
use base64::Engine;

use super::extensions::check_extensions;
use super::json_spans::{edited, items, member, root, Edit};
use super::root::Root;
use crate::io::error::ReadProblem;
use crate::io::fault::{excerpt, Fault};
use crate::io::printable::printable;
use crate::io::text::Cursor;

const MAGIC: &[u8] = b"glTF";
const HEADER: usize = 12;
const CHUNK_HEADER: usize = 8;

/// A file taken apart.
#[derive(Debug)]
pub(super) struct Container {
    path: PathBuf,
    bytes: Vec<u8>,
    json: Range<usize>,
    pub(super) root: Root,
    buffers: Vec<Buffer>,
}

/// Where the bytes of a buffer are.
#[derive(Debug)]
enum Buffer {
    /// In the file itself: its binary chunk, or nowhere.
    Chunk(Range<usize>),
    /// In another file or in the text of the document.
    Loaded(Vec<u8>),
}

/// Whether the file is a GLB.
pub(in crate::io) fn is_glb(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

impl Container {
    /// Takes apart the content of the file called `path`; buffers in other files are read from its folder.
    pub(super) fn read(bytes: Vec<u8>, path: &Path) -> Result<Self, Fault> {
        let (json, chunk) = if is_glb(&bytes) {
            chunks(&bytes)?
        } else {
            (Cursor::new(&bytes).at()..bytes.len(), None)
        };
        let root = Root::read(&bytes[json.clone()])?;
        check_extensions(&root)?;
        Ok(Self {
            path: path.to_owned(),
            buffers: buffers(&root, chunk, path)?,
            bytes,
            json,
            root,
        })
    }

    /// The path it was read from.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// All bytes of the file.
    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The same without what was found in them.
    pub(super) fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }

    /// The bytes of buffer number `k`, if the document has so many.
    pub(super) fn buffer(&self, k: usize) -> Option<&[u8]> {
        self.buffers.get(k).map(|buffer| match buffer {
            Buffer::Chunk(range) => &self.bytes[range.clone()],
            Buffer::Loaded(bytes) => bytes,
        })
    }

    /// The bytes of all buffers.
    pub(super) fn buffers(&self) -> impl Iterator<Item = &[u8]> {
        (0..self.buffers.len()).filter_map(|k| self.buffer(k))
    }

    /// The text of the document.
    pub(super) fn json(&self) -> &[u8] {
        &self.bytes[self.json.clone()]
    }

    /// All bytes there are for data.
    pub(super) fn n_bytes(&self) -> usize {
        self.bytes.len() + self.buffers().map(<[u8]>::len).sum::<usize>()
    }

    /// The file with new data in its buffers and with some pieces of the document replaced. The text of buffers that
    /// live elsewhere moves into the document.
    pub(super) fn with(&self, buffers: &[Option<Vec<u8>>], mut edits: Vec<Edit>) -> Vec<u8> {
        let json = self.json();
        let objects =
            member(json, root(json), "buffers").map_or_else(Vec::new, |all| items(json, all));
        for (data, object) in buffers.iter().zip(objects) {
            if let Some((data, uri)) = data.as_ref().zip(member(json, object, "uri")) {
                let data = STANDARD.encode(data);
                let text = format!("\"data:application/octet-stream;base64,{data}\"");
                edits.push((uri, text));
            }
        }
        let json = edited(json, edits);
        if is_glb(&self.bytes) {
            self.glb(json, buffers.first().and_then(Option::as_deref))
        } else {
            [&self.bytes[..self.json.start], &json].concat()
        }
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
        let stated = u32_at(&self.bytes, 8) as usize - self.json.len() + json.len();
        out.extend_from_slice(&(stated as u32).to_le_bytes());
        out.extend_from_slice(&(json.len() as u32).to_le_bytes());
        out.extend_from_slice(&self.bytes[HEADER + 4..self.json.start]);
        out.extend_from_slice(&json);
        let behind = out.len();
        out.extend_from_slice(&self.bytes[self.json.end..]);
        if let (Some(data), Some(Buffer::Chunk(place))) = (chunk, self.buffers.first()) {
            let start = behind + place.start - self.json.end;
            out[start..start + data.len()].copy_from_slice(data);
        }
        out
    }
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
        return Err(Fault::unsupported(
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

/// The buffers that the document names; the first may be the binary chunk of the file.
fn buffers(root: &Root, chunk: Option<Range<usize>>, path: &Path) -> Result<Vec<Buffer>, Fault> {
    let mut files = HashSet::new();
    let mut buffers = Vec::with_capacity(root.buffer_uris.len());
    for uri in &root.buffer_uris {
        // One large file, named often enough, would fill any memory.
        let file = uri.as_deref().and_then(file_named);
        if let Some(file) = file.filter(|file| !files.insert(file.clone())) {
            let feature = format!(
                "two buffers of the one file `{}`",
                printable(&file.to_string_lossy())
            );
            return Err(Fault::unsupported(feature, "save the file as GLB"));
        }
        buffers.push(match uri {
            Some(uri) => Buffer::Loaded(load(uri, path)?),
            None if buffers.is_empty() => Buffer::Chunk(chunk.clone().unwrap_or_default()),
            None => Buffer::Chunk(0..0),
        });
    }
    Ok(buffers)
}

fn load(uri: &str, path: &Path) -> Result<Vec<u8>, Fault> {
    let advice = "save the file as GLB";
    let shown = || format!("the buffer `{}`", excerpt(uri.as_bytes()));
    if let Some(data) = uri.strip_prefix("data:") {
        let text = data.split_once(";base64,").map(|(_, text)| text);
        return text
            .and_then(|text| STANDARD.decode(text).ok())
            .ok_or_else(|| Fault::unsupported(shown(), advice));
    }
    let file = file_named(uri).map(|name| path.with_file_name(name));
    let Some(file) = file.filter(|file| file.is_file()) else {
        return Err(Fault::unsupported(
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

/// A name as a URI writes it, with its `%20` and the like as what they stand for.
pub(super) fn percent_decoded(uri: &str) -> String {
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
