//! What is said, and how.

use super::{assert_refused, inspected, OBJ};
use crate::support::{run, Workplace};

#[test]
fn no_words_of_the_language_that_this_is_written_in() {
    let words = [
        "usize", "u32", "f64", "struct", "enum", "Void", "unwrap", "Err(",
    ];
    let place = Workplace::new();
    let is_plain = |ended: crate::support::Ended| {
        assert_eq!(ended.code, Some(2), "{}", ended.stderr);
        assert!(
            !words.iter().any(|word| ended.stderr.contains(word)),
            "{}",
            ended.stderr
        );
    };
    is_plain(inspected(
        "a.gltf",
        r#"{"asset": {"version": "2.0"}, "meshes": 5}"#,
    ));
    is_plain(inspected(
        "a.gltf",
        r#"{"asset": {"version": "2.0"}, "meshes": [{"primitives": -1}]}"#,
    ));
    for settings in [
        "seed = -1",
        "initial = 3",
        "[sampling]\nn_samples = \"x\"",
        "parametrization = 1",
        "overlap = \"no\"",
    ] {
        place.write("short.toml", settings);
        is_plain(place.transfer(""));
    }
    for landmarks in [
        r#"{"landmarks": 5}"#,
        r#"{"landmarks": [5]}"#,
        "[]",
        r#"{"source_vertices": [-1], "target_points": [[0,0,0]]}"#,
    ] {
        place.write("landmarks.json", landmarks);
        place.write("short.toml", "");
        is_plain(place.transfer(""));
    }
    place.write("a.session", r#"{"version": 1, "source": 5}"#);
    is_plain(place.drape("replay a.session -o out.obj"));
    is_plain(place.drape("--threads -1 presets"));
    is_plain(place.drape("landmarks suggest source.obj target.ply landmarks.json -n x"));
}

#[test]
fn formats_have_their_article() {
    assert_refused(
        &inspected("a.ply", "ply\nformat ascii 1.0\nend_header\n"),
        &["a PLY file"],
    );
    assert_refused(&inspected("a.obj", "# nothing\n"), &["an OBJ file"]);
}

#[test]
fn infinite_and_huge_coordinates_are_named_by_file_and_place() {
    for (number, words) in [
        ("inf", "is infinite"),
        ("nan", "is not a number"),
        ("1e999", "too large for a number"),
        ("1e155", "too large to measure with"),
    ] {
        let ended = inspected("a.obj", OBJ.replace("v 1 0 0", &format!("v {number} 0 0")));
        assert_refused(&ended, &["a.obj:2", number, words]);
    }
}

#[test]
fn the_row_and_the_file_are_the_right_ones() {
    let place = Workplace::new();
    place.write("target.ply", &OBJ.replace("f 1 2 3", "f 1 2 4"));
    assert_refused(
        &place.transfer(""),
        &["target.ply:4", "vertex 4", "3 vertices (counted from 1)"],
    );
}

#[test]
fn warnings_stand_apart_from_the_one_error_line() {
    let place = Workplace::new();
    place.write(
        "landmarks.json",
        r#"{"landmarks": [{"source": {"vertex": 0}, "target": {"point": [99, 0, 0]}}]}"#,
    );
    // The weight of the source's only part leaves nothing to drape: an error behind warnings.
    let ended = place.drape("transfer source.obj target.ply -l landmarks.json --config short.toml -o out.obj --free side9");
    let errors = ended
        .stderr
        .lines()
        .filter(|line| line.starts_with("error: "));
    assert_eq!(
        (ended.code, errors.count()),
        (Some(2), 1),
        "{}",
        ended.stderr
    );
    let others = ended
        .stderr
        .lines()
        .filter(|line| !line.starts_with("error: "));
    assert!(
        others.into_iter().all(|line| line.starts_with("warning: ")),
        "{}",
        ended.stderr
    );
}

#[test]
fn names_cannot_command_a_terminal() {
    let escape = "\u{1b}[31m";
    let place = Workplace::new();
    let named = place
        .read("landmarks.json")
        .replace("right", "ri\\u001b[31mght");
    place.write("landmarks.json", &named);
    let ended = place.transfer("").well();
    assert!(!ended.stdout.contains('\u{1b}') && !ended.stderr.contains('\u{1b}'));
    let missing = format!("{escape}.obj");
    let ended = run(&place.path(""), ["inspect", &missing]);
    assert_refused(&ended, &["\\u{1b}[31m.obj"]);
    let source = place
        .read("source.obj")
        .replace("g side0", &format!("g {escape}side"));
    place.write("source.obj", &source);
    let ended = place.drape("inspect source.obj").well();
    assert!(
        !ended.stdout.contains('\u{1b}') && ended.stdout.contains("\\u{1b}"),
        "{}",
        ended.stdout
    );
}
