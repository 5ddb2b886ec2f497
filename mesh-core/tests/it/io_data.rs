//! The real files of the shared data survive.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::path::{Path, PathBuf};

use mesh_core::io::{self, Format};
use mesh_core::Positions;

use crate::io_support::{bent, check_round_trip, file, written_text};
use crate::skipped::skip;

/// The folder of real files: `DRAPE_DATA`, or `shared/data` beside the workspace.
fn data() -> Option<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
    let folder = std::env::var_os("DRAPE_DATA").map_or_else(beside, PathBuf::from);
    folder.is_dir().then_some(folder)
}

fn collect(folder: &Path, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().path())
        .collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            collect(&path, found);
        } else if Format::of_extension(&path).is_some_and(|f| f != Format::Xyz) {
            found.push(path);
        }
    }
}

/// All mesh files of the data; none, with a word on it, where the data is not there.
fn meshes() -> Vec<PathBuf> {
    let mut found = Vec::new();
    match data() {
        Some(folder) => collect(&folder, &mut found),
        None => skip("no real meshes beside the workspace and no DRAPE_DATA"),
    }
    found
}

#[test]
fn every_mesh_survives_the_round_trip() {
    for path in meshes() {
        let bytes = std::fs::read(&path).unwrap();
        check_round_trip(&path.to_string_lossy(), &bytes);
    }
}

#[test]
fn an_obj_differs_in_lines_of_positions_and_normals_only() {
    for path in meshes()
        .iter()
        .filter(|p| p.extension().is_some_and(|e| e == "obj"))
    {
        let text = String::from_utf8(std::fs::read(path).unwrap()).unwrap();
        let read = file(&path.to_string_lossy(), &text);
        let new = written_text(&read, &bent(&read));
        assert_eq!(new.split('\n').count(), text.split('\n').count());
        for (new, old) in new.split('\n').zip(text.split('\n')) {
            let is_free = old.starts_with("v ") || old.starts_with("vn ");
            assert!(
                new == old || is_free,
                "{}: {old} became {new}",
                path.display()
            );
        }
    }
}

#[test]
fn every_mesh_is_converted_to_every_format() {
    for path in meshes().iter().filter(|p| p.ends_with("source.obj")) {
        let read = io::read_mesh(path).unwrap();
        let x = Positions::from(read.soup().positions.clone());
        for name in ["other.off", "other.ply"] {
            let other = file(name, read.to_bytes(name, &x).unwrap());
            assert_eq!(other.soup(), read.soup(), "{} as {name}", path.display());
        }
        for name in ["other.glb", "other.gltf", "other.stl"] {
            let other = file(name, read.to_bytes(name, &x).unwrap());
            let n_triangles: usize = read.soup().faces.iter().map(|f| f.len() - 2).sum();
            let n_places = other.soup().weld(0.0).soup.positions.len();
            let found = (other.soup().faces.len(), n_places);
            let expected = (n_triangles, read.soup().positions.len());
            assert_eq!(found, expected, "{} as {name}", path.display());
        }
    }
}
