//! What the tests of all formats share.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use mesh_core::io::{MeshFile, ReadError};
use mesh_core::{Point3, Positions, Vector3};

/// The file called `name` with this content.
pub(crate) fn file(name: &str, bytes: impl AsRef<[u8]>) -> MeshFile {
    MeshFile::from_bytes(name, bytes.as_ref().to_vec()).unwrap()
}

/// Why the file called `name` with this content is not read.
pub(crate) fn refusal(name: &str, bytes: impl AsRef<[u8]>) -> ReadError {
    match MeshFile::from_bytes(name, bytes.as_ref().to_vec()) {
        Ok(file) => panic!("{name} was read: {:?}", file.soup()),
        Err(error) => error,
    }
}

/// The positions as read.
pub(crate) fn rest(file: &MeshFile) -> Positions {
    Positions::from(file.soup().positions.clone())
}

/// The positions bent, so that each coordinate of each vertex changes, by numbers `f32` holds exactly.
pub(crate) fn bent(file: &MeshFile) -> Positions {
    let bend = |p: &Point3| {
        let q = p + Vector3::new(0.5 + p.y * p.z, 0.25 + p.x, 2.0 - p.y * p.x);
        q.map(|c| {
            if c.is_finite() {
                f64::from(c as f32)
            } else {
                1.0
            }
        })
    };
    rest(file).map(bend)
}

/// What writing `file` with the vertices at `x` gives.
pub(crate) fn written(file: &MeshFile, x: &Positions) -> Vec<u8> {
    file.to_bytes(file.path(), x).unwrap()
}

/// The same as text.
pub(crate) fn written_text(file: &MeshFile, x: &Positions) -> String {
    String::from_utf8(written(file, x)).unwrap()
}

/// Writing what was read gives the same bytes; writing `bent` positions gives a file that reads as these positions and
/// the same faces, and that turns into the first again when the first positions are written into it.
pub(crate) fn check_round_trip(name: &str, bytes: &[u8]) {
    let read = file(name, bytes);
    assert_eq!(written(&read, &rest(&read)), bytes, "{name} unchanged");

    let x = bent(&read);
    let moved = file(name, written(&read, &x));
    assert_eq!(moved.soup().positions, x.as_slice(), "{name} moved");
    assert_eq!(moved.soup().faces, read.soup().faces, "{name} moved");
    assert_eq!(moved.contents(), read.contents(), "{name} moved");

    let back = file(name, written(&moved, &rest(&read)));
    assert_eq!(back.soup(), read.soup(), "{name} moved back");
}

/// A GLB file of a JSON chunk and one buffer.
pub(crate) fn glb_file(json: &str, buffer: &[u8]) -> Vec<u8> {
    let mut json = json.to_owned().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut out = b"glTF".to_vec();
    for n in [2, 28 + json.len() + buffer.len(), json.len()] {
        out.extend((n as u32).to_le_bytes());
    }
    out.extend(b"JSON");
    out.extend(&json);
    out.extend((buffer.len() as u32).to_le_bytes());
    out.extend(b"BIN\0");
    out.extend(buffer);
    out
}
