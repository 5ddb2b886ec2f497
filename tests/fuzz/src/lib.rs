//! What each fuzz target asserts of bytes that anyone may hand to a reader: they are read or refused, and what was
//! read can be written back.

use mesh_core::io::{Format, MeshFile, Morphs};
use mesh_core::{Point3, Positions};

/// Reads `bytes` as a file called `name`; where that works, writes them back unchanged, changed and converted.
///
/// # Panics
/// If a file that was read is not written back as it was, or not read again with the positions it was given.
pub fn survive(name: &str, bytes: &[u8]) {
    let Ok(mut file) = MeshFile::from_bytes(name, bytes.to_vec()) else {
        return;
    };
    file.soup().check().expect("what was read is sound");
    let rest = Positions::from(file.soup().positions.clone());
    let is_packed = bytes.starts_with(&[0x1F, 0x8B]);
    if !file.keeps_format(name) {
        // The content spoke louder than the name.
        let _ = file.to_bytes(name, &rest);
        return;
    }
    let unchanged = file
        .to_bytes(name, &rest)
        .expect("what was read is written");
    assert!(
        is_packed || unchanged == bytes,
        "unchanged positions change the file"
    );
    let _ = (
        file.vertex_normals(),
        file.soup().weld(0.0),
        file.soup().weld(0.25),
    );
    convert(&file, &rest);

    let moved: Positions = (0..rest.len())
        .map(|row| Point3::new(1.5, -0.25, row as f64 + 0.5))
        .collect();
    let written = file.to_bytes(name, &moved);
    if matches!(file.format(), Format::Gltf | Format::Glb) {
        // Wild transforms may have no way back: it is enough that nothing breaks.
        for morphs in [Morphs::Carry, Morphs::Drop] {
            file.set_morphs(morphs);
            if let Ok(bytes) = file.to_bytes(name, &moved) {
                MeshFile::from_bytes(name, bytes).expect("what is written is read");
            }
        }
        return;
    }
    let again =
        MeshFile::from_bytes(name, written.expect("it is written moved")).expect("and read again");
    assert_eq!(again.soup().positions, moved.as_slice());
    assert_eq!(again.soup().faces, file.soup().faces);
}

/// Writes a file in every other format; what is written is read.
fn convert(file: &MeshFile, rest: &Positions) {
    for other in [
        "a.obj", "a.ply", "a.off", "a.stl", "a.glb", "a.gltf", "a.xyz",
    ] {
        if file.keeps_format(other) {
            continue;
        }
        let _ = file.lost_in(other);
        // Single precision may be too small for some coordinates.
        if let Ok(bytes) = file.to_bytes(other, rest) {
            let has_triangles = other != "a.stl" || bytes.len() > 84;
            assert!(
                !has_triangles || MeshFile::from_bytes(other, bytes).is_ok(),
                "{other} is read"
            );
        }
    }
}

/// A GLB of the document before the first zero byte and the buffer behind it.
pub fn glb(bytes: &[u8]) -> Vec<u8> {
    let (document, buffer) = match bytes.iter().position(|&b| b == 0) {
        Some(end) => (&bytes[..end], &bytes[end + 1..]),
        None => (bytes, &[][..]),
    };
    let padded = |part: &[u8], filler: u8| {
        let mut part = part.to_vec();
        part.resize(part.len().next_multiple_of(4), filler);
        part
    };
    let (document, buffer) = (padded(document, b' '), padded(buffer, 0));
    let mut out = b"glTF\x02\0\0\0".to_vec();
    out.extend(((28 + document.len() + buffer.len()) as u32).to_le_bytes());
    out.extend((document.len() as u32).to_le_bytes());
    out.extend(b"JSON");
    out.extend(document);
    out.extend((buffer.len() as u32).to_le_bytes());
    out.extend(b"BIN\0");
    out.extend(buffer);
    out
}

#[cfg(feature = "drape")]
mod command;
#[cfg(feature = "drape")]
mod drape;
#[cfg(feature = "drape")]
mod whole;
#[cfg(feature = "drape")]
pub use command::Place;
#[cfg(feature = "drape")]
pub use drape::{load_warp, read_landmarks, read_settings};
#[cfg(feature = "drape")]
pub use whole::drape_both_ways;

/// The folder that this process works in.
#[cfg(feature = "drape")]
pub fn place() -> &'static Place {
    static PLACE: std::sync::OnceLock<Place> = std::sync::OnceLock::new();
    let folder = || std::env::temp_dir().join(format!("drape-fuzz-{}", std::process::id()));
    PLACE.get_or_init(|| Place::new(&folder()))
}
