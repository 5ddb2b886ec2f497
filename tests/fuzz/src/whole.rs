//! The whole method on files that anyone may hand to it.

use mesh_core::io::MeshFile;
use mesh_core::shapes;
use mesh_draping::{Preset, Seams, Source, Target, Transfer};

/// Drapes what is in a file over a ball, and a ball over it, for ten iterations; the result goes into every format.
///
/// # Panics
/// If the settings are none, or a ball is no shape.
pub fn drape_both_ways(name: &str, bytes: &[u8]) {
    let Ok(file) = MeshFile::from_bytes(name, bytes.to_vec()) else {
        return;
    };
    let preset = Preset::from_toml("[[stages]]\nn_iterations = 10\n").expect("settings");
    let ball = shapes::icosphere(1);
    let ball_source = Source::of_soup(ball.clone(), Seams::EXACT).expect("a ball is a source");
    let ball_target = Target::of_soup(ball).expect("a ball is a target");
    if let Ok(target) = Target::of_file(file.clone()) {
        let _ = Transfer::new(&ball_source, &target, &[], preset.clone()).run();
    }
    let Ok(source) = Source::of_file(file, Seams::EXACT) else {
        return;
    };
    let Ok(outcome) = Transfer::new(&source, &ball_target, &[], preset).run() else {
        return;
    };
    let draped = source.spread(&outcome.draped);
    for other in [
        "a.obj", "a.ply", "a.off", "a.stl", "a.glb", "a.gltf", "a.xyz",
    ] {
        if let Some(Ok(bytes)) = source.file().map(|file| file.to_bytes(other, &draped)) {
            // A file of another format may hold no triangle, or coordinates beyond what is read.
            let _ = MeshFile::from_bytes(other, bytes);
        }
    }
}
