//! The readers that are not of mesh files.

use mesh_core::{shapes, Point3};
use mesh_draping::{landmarks, Preset, Seams, Source};

/// Reads a landmark file for a small mesh.
///
/// # Panics
/// If a landmark that was read has a place that is not finite.
pub fn read_landmarks(text: &str) {
    let source = Source::of_soup(shapes::open_grid(2, 2), Seams::EXACT).expect("a grid is a mesh");
    let target = [Point3::new(1.0, 2.0, 3.0), Point3::new(4.0, 5.0, 6.0)];
    if let Ok(landmarks) = landmarks::parse(text, Some("a\nb\n"), &source, &target) {
        for landmark in landmarks {
            assert!(landmark.target.iter().all(|c| c.is_finite()));
        }
    }
}

/// Reads a settings file, and what it settles on once more.
///
/// # Panics
/// If the settings that were read are not those that are written.
pub fn read_settings(text: &str) {
    if let Ok(preset) = Preset::from_toml(text) {
        let again = Preset::from_toml(&preset.to_toml()).expect("settings read what they write");
        if preset.drape.check().is_ok() {
            assert_eq!(again, preset);
        }
    }
}

/// Loads a warp and sends two points through it.
///
/// # Panics
/// If there is no folder for temporary files.
pub fn load_warp(bytes: &[u8]) {
    let shared_memory = std::path::Path::new("/dev/shm");
    let folder = if shared_memory.is_dir() {
        shared_memory.to_owned()
    } else {
        std::env::temp_dir()
    };
    let path = folder.join(format!("drape-fuzz-{}.drape", std::process::id()));
    // The last eight bytes are a checksum of all before, which chance would not meet.
    let content = &bytes[..bytes.len().saturating_sub(8)];
    let checksum = content
        .iter()
        .fold(0xcbf2_9ce4_8422_2325_u64, |hash, &byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
        });
    let whole = [content, &checksum.to_le_bytes()].concat();
    std::fs::write(&path, whole).expect("a temporary file is written");
    if let Ok(warp) = neural_drape::Warp::load(&path) {
        let _ = warp.apply(&[Point3::origin(), Point3::new(1.0, -2.0, 0.5)]);
    }
}
