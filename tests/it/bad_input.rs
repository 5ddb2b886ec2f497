//! Bad input gives one line that names file and place, exit code 2, and no output.

use crate::support::{Ended, Workplace};

fn assert_refused(place: &Workplace, ended: &Ended, expected: &[&str]) {
    let line = ended.stderr.trim_end();
    assert_eq!(ended.code, Some(2), "{line}");
    assert_eq!(line.lines().count(), 1, "{line}");
    assert!(line.starts_with("error: "), "{line}");
    for word in expected {
        assert!(line.contains(word), "`{line}` lacks `{word}`");
    }
    assert!(!place.exists("out.obj") && ended.stdout.is_empty());
}

/// Drapes with `content` in place of one of the standard files.
fn refused(name: &str, content: &[u8], expected: &[&str]) {
    let place = Workplace::new();
    std::fs::write(place.path(name), content).expect("a file is written");
    let ended = place.transfer("");
    assert_refused(&place, &ended, &[&[name], expected].concat());
}

#[test]
fn missing_files() {
    let place = Workplace::new();
    for name in ["source.obj", "target.ply", "landmarks.json", "short.toml"] {
        let content = std::fs::read(place.path(name)).expect("the file");
        std::fs::remove_file(place.path(name)).expect("the file is removed");
        let ended = place.transfer("");
        assert_refused(&place, &ended, &[name, "No such file"]);
        std::fs::write(place.path(name), content).expect("the file is back");
    }
}

#[test]
fn binary_junk() {
    let junk: Vec<u8> = (0..4096u32)
        .map(|k| (k.wrapping_mul(2_654_435_761) >> 13) as u8)
        .collect();
    refused("source.obj", &junk, &[]);
    refused("target.ply", &junk, &[]);
    refused("landmarks.json", &junk, &[]);
}

#[test]
fn empty_files_and_meshes_without_faces() {
    refused("source.obj", b"", &["empty"]);
    refused("source.obj", b"# nothing\n", &["no vertex"]);
    refused("source.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\n", &["no faces"]);
    refused(
        "source.obj",
        b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 2\n",
        &["three different corners"],
    );
    refused("target.ply", b"", &["empty"]);
}

#[test]
fn coordinates_that_are_not_finite() {
    refused(
        "source.obj",
        b"v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n",
        &[":2", "`nan` is not a number"],
    );
    refused(
        "target.ply",
        b"v 0 0 0\nv 1 0 0\nv 0 inf 0\nf 1 2 3\n",
        &["target.ply"],
    );
}

#[test]
fn indices_out_of_range() {
    refused(
        "source.obj",
        b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 7\n",
        &[":5", "7"],
    );
    refused(
        "source.obj",
        b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n",
        &[":4"],
    );
}

#[test]
fn landmarks() {
    let entry = |source: &str, target: &str| {
        format!(r#"{{"landmarks": [{{"name": "nose", "source": {source}, "target": {target}}}]}}"#)
    };
    let point = r#"{"point": [0, 0, 0]}"#;
    refused(
        "landmarks.json",
        entry(r#"{"vertex": 9999}"#, point).as_bytes(),
        &["landmark 0 (nose)", "9999"],
    );
    refused(
        "landmarks.json",
        entry(point, r#"{"vertex": 9999}"#).as_bytes(),
        &["landmark 0 (nose)", "9999"],
    );
    refused(
        "landmarks.json",
        entry(r#"{"face": 1, "barycentric": [1]}"#, point).as_bytes(),
        &["4 corners"],
    );
    refused(
        "landmarks.json",
        entry("{}", point).as_bytes(),
        &["landmark 0 (nose)"],
    );
    refused("landmarks.json", b"{\"landmarks\": [", &["line 1"]);
}

#[test]
fn options_and_settings() {
    let place = Workplace::new();
    assert_refused(&place, &place.transfer("--bogus"), &["--bogus"]);
    assert_refused(&place, &place.transfer("--preset best"), &["best"]);
    assert_refused(&place, &place.transfer("--seed x"), &["--seed", "x"]);
    assert_refused(&place, &place.drape("transfer source.obj"), &["TARGET"]);
    place.write("wrong.toml", "[sampling]\nn_sampels = 3\n");
    let ended = place.drape("transfer source.obj target.ply --config wrong.toml -o out.obj");
    assert_refused(&place, &ended, &["wrong.toml", "n_sampels"]);
    place.write("wrong.toml", "worst_share = 3\n");
    let ended = place
        .drape("transfer source.obj target.ply -l landmarks.json --config wrong.toml -o out.obj");
    assert_refused(&place, &ended, &["worst_share"]);
}

#[test]
fn outputs_that_cannot_be() {
    let place = Workplace::new();
    let to = |output: &str| place.drape(&format!("transfer source.obj target.ply -o {output}"));
    assert_refused(&place, &to("nowhere/a.obj"), &["nowhere"]);
    assert_refused(&place, &to("a.docx"), &["a.docx"]);
    assert_refused(&place, &to("source.obj"), &["source.obj", "input"]);
    assert!(place.read("source.obj").starts_with("# my mesh"));
}
