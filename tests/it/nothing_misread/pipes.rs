//! `-` in the place of files.

use std::io::Write as _;
use std::process::{Command, Output, Stdio};

use crate::support::Workplace;

/// Runs `drape` in the folder with `input` on its standard input.
fn piped(place: &Workplace, line: &str, input: &[u8]) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_drape-under-test"))
        .args(line.split_whitespace())
        .current_dir(place.path(""))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the command starts");
    // A command that refuses its options reads nothing.
    let _ = child.stdin.take().expect("a pipe").write_all(input);
    child.wait_with_output().expect("the command ends")
}

fn words(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn a_source_comes_and_a_result_goes_through_pipes() {
    let place = Workplace::new();
    place.transfer("").well();
    let source = place.read("source.obj");
    let line = "transfer - target.ply -l landmarks.json --config short.toml -o -";
    let output = piped(&place, line, source.as_bytes());
    assert_eq!(output.status.code(), Some(0), "{}", words(&output));
    assert_eq!(
        String::from_utf8_lossy(&output.stdout),
        place.read("out.obj")
    );
    assert!(words(&output).contains("Q_transfer"));

    let output = piped(&place, &format!("{line} --format ply"), source.as_bytes());
    assert!(output.stdout.starts_with(b"ply\n"), "{}", words(&output));
    assert!(words(&output).contains("from OBJ to PLY"));
}

#[test]
fn every_command_with_one_mesh_takes_it_from_a_pipe() {
    let place = Workplace::new();
    place.transfer("--warp a.drape").well();
    let target = std::fs::read(place.path("target.ply")).expect("the target");
    for line in [
        "inspect -",
        "init source.obj - -l landmarks.json -o -",
        "metrics source.obj out.obj -",
        "landmarks check source.obj - landmarks.json",
        "apply a.drape - -o - --format off",
    ] {
        let output = piped(&place, line, &target);
        assert_eq!(output.status.code(), Some(0), "{line}: {}", words(&output));
        assert!(!output.stdout.is_empty(), "{line}");
    }
}

#[test]
fn a_format_is_told_where_the_content_does_not() {
    let place = Workplace::new();
    let told = piped(
        &place,
        "inspect - --json --format xyz",
        b"1,5 2,5 3,5\n4,5 5,5 6,5\n",
    );
    assert_eq!(told.status.code(), Some(0), "{}", words(&told));
}

#[test]
fn what_makes_no_sense_with_pipes_is_refused() {
    let place = Workplace::new();
    for (line, word) in [
        ("transfer - - -o out.obj", "standard input holds one mesh"),
        (
            "transfer source.obj target.ply -o out.obj --format ply",
            "--format goes with -",
        ),
        ("inspect source.obj --format ply", "--format goes with -"),
        ("inspect -", "stdin: the file is empty"),
        ("batch source.obj - -o {target}.obj", "standard input"),
        ("batch source.obj target.ply -o -", "extension"),
    ] {
        let output = piped(&place, line, b"");
        assert_eq!(output.status.code(), Some(2), "{line}");
        assert!(words(&output).contains(word), "{line}: {}", words(&output));
    }
}
