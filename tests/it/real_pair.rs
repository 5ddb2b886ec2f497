//! A short drape of a real pair, where the data are present.

use std::path::{Path, PathBuf};

use crate::support::{run, Workplace};

/// The pairs, or nothing where they are not on this machine.
#[allow(clippy::print_stderr, reason = "a skipped test says so")]
fn data() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
    let data = std::env::var_os("DRAPE_DATA").map_or(beside, PathBuf::from);
    let pair = data.join("pairs/horse_wolf");
    if pair.is_dir() {
        return Some(pair);
    }
    eprintln!("skipped: no {}; set DRAPE_DATA", pair.display());
    None
}

#[test]
fn a_horse_becomes_a_wolf_and_keeps_its_file() {
    let Some(pair) = data() else {
        return;
    };
    let place = Workplace::new();
    place.write(
        "short.toml",
        "[[stages]]\nn_iterations = 60\n[[stages]]\nn_iterations = 30\n",
    );
    let path = |name: &str| pair.join(name).to_string_lossy().into_owned();
    let (source, target, landmarks) = (
        path("source.obj"),
        path("target.obj"),
        path("landmarks.json"),
    );
    let output = place.path("out.obj").to_string_lossy().into_owned();
    let config = place.path("short.toml").to_string_lossy().into_owned();
    let arguments = [
        "transfer", &source, &target, "-l", &landmarks, "--config", &config, "-o", &output,
        "--json",
    ];
    let json = run(&pair, arguments).well().json();
    assert!(
        json["figures"]["q_transfer"]
            .as_f64()
            .is_some_and(|q| q > 0.8),
        "{json:#}"
    );
    assert_eq!(json["figures"]["folds"], 0.0);
    assert_eq!(
        json["warnings"].as_array().map(Vec::len),
        Some(0),
        "{json:#}"
    );

    let text = |path: &str| std::fs::read_to_string(path).expect("a file");
    let kept = |text: String| -> Vec<String> {
        let is_kept = |line: &&str| !line.starts_with("v ") && !line.starts_with("vn ");
        text.lines().filter(is_kept).map(str::to_owned).collect()
    };
    assert_eq!(kept(text(&source)), kept(text(&output)));
}
