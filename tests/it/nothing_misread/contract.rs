//! What the command promises of its options and outputs.

use std::fs;

use super::assert_refused;
use crate::support::Workplace;

#[test]
fn weights_that_are_none() {
    let place = Workplace::new();
    for weight in ["NaN", "-0.5", "inf", "2"] {
        place.write("weights.txt", &format!("0 {weight}\n"));
        assert_refused(
            &place.transfer("--weights weights.txt"),
            &["weights.txt", weight],
        );
    }
}

#[test]
fn a_requirement_that_nothing_can_meet() {
    let place = Workplace::new();
    assert_refused(&place.transfer("--require q>=nan"), &["nan"]);
}

#[test]
fn what_was_left_out_is_said_and_can_be_required() {
    let place = Workplace::new();
    let whole = place.transfer("--require left_out<=0.5 --json").well();
    assert_eq!(whole.json()["figures"]["left_out"], 0.0);
    // An open piece of a ball: less than a quarter of the source has a counterpart.
    let mut piece = mesh_core::io::read_soup(place.path("target.ply")).expect("the target");
    let is_kept = |face: &Vec<u32>| face.iter().all(|&v| piece.positions[v as usize].x > 12.4);
    let kept: Vec<Vec<u32>> = piece.faces.iter().filter(|f| is_kept(f)).cloned().collect();
    piece.faces = kept;
    mesh_core::io::write_soup(place.path("piece.obj"), &piece).expect("the piece is written");
    let line = "transfer source.obj piece.obj -l landmarks.json --config short.toml --overlap target-partial -o out.obj";
    let ended = place.drape(&format!("{line} --require left_out<=0.5"));
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    assert!(
        ended.stderr.contains("not met: left_out <= 0.5"),
        "{}",
        ended.stderr
    );
    assert!(
        ended.stderr.contains("warning: MOST OF THE SOURCE"),
        "{}",
        ended.stderr
    );
}

#[test]
fn a_batch_drapes_what_it_can_and_ends_with_2() {
    let place = Workplace::new();
    place.write("bad.ply", "ply\nformat ascii 1.0\n");
    let ended =
        place.drape("batch source.obj bad.ply target.ply -o {target}-out.obj --config short.toml");
    assert_eq!(ended.code, Some(2));
    assert!(
        ended.stderr.contains("bad.ply") && place.exists("target-out.obj"),
        "{}",
        ended.stderr
    );
}

#[test]
fn names_in_braces_that_stand_for_nothing() {
    let place = Workplace::new();
    for (pattern, word) in [
        ("{targets}.obj", "stands for nothing"),
        ("{target.obj", "not closed"),
    ] {
        assert_refused(
            &place.drape(&format!("batch source.obj target.ply -o {pattern}")),
            &[word],
        );
    }
}

#[test]
fn landmarks_beyond_measure() {
    let place = Workplace::new();
    place.write("lm.txt", "0 1e300 0 0\n");
    let ended = place.drape("transfer source.obj target.ply -l lm.txt -o out.obj");
    assert_refused(&ended, &["lm.txt", "landmark 0", "not finite, or farther"]);
}

#[test]
fn a_shape_that_is_a_single_point() {
    let place = Workplace::new();
    place.write("one.xyz", "1 2 3\n");
    place.write("ten.xyz", &"1 2 3\n".repeat(10));
    place.write("flat.obj", &"v 1 2 3\n".repeat(3));
    fs::write(place.path("flat.obj"), place.read("flat.obj") + "f 1 2 3\n").expect("a file");
    for name in ["one.xyz", "ten.xyz", "flat.obj"] {
        let ended = place.drape(&format!("transfer source.obj {name} -o out.obj"));
        assert_refused(&ended, &[name, "at one place"]);
    }
    let ended = place.drape("transfer flat.obj target.ply --weld off -o out.obj");
    assert_refused(&ended, &["flat.obj", "at one place"]);
}

#[test]
fn outputs_that_cannot_be_written_are_found_before_the_run() {
    let place = Workplace::new();
    let long = "n".repeat(300);
    for option in [
        format!("-o {long}.obj"),
        format!("-o out.obj --report {long}.html"),
        format!("-o out.obj --warp {long}.drape"),
        "-o out.obj --render nowhere/a.png".to_owned(),
        "-o source.obj/a.obj".to_owned(),
    ] {
        // A target that is not there: were it looked at first, the message would be about it.
        let ended = place.drape(&format!("transfer source.obj missing.ply {option}"));
        assert_eq!(ended.code, Some(2));
        assert!(!ended.stderr.contains("missing.ply"), "{}", ended.stderr);
        assert_eq!(ended.stderr.lines().count(), 1, "{}", ended.stderr);
    }
}

#[cfg(unix)]
#[test]
fn a_result_that_replaces_a_file_has_its_mode() {
    use std::os::unix::fs::PermissionsExt as _;
    let place = Workplace::new();
    place.write("out.obj", "");
    let mode = |mode| fs::Permissions::from_mode(mode);
    fs::set_permissions(place.path("out.obj"), mode(0o604)).expect("a mode is set");
    place
        .drape("init source.obj target.ply -l landmarks.json -o out.obj")
        .well();
    let kept = fs::metadata(place.path("out.obj"))
        .expect("a result")
        .permissions();
    assert_eq!(kept.mode() & 0o777, 0o604);
    assert!(place.read("out.obj").starts_with("# my mesh"));
}

#[test]
fn a_session_that_was_changed() {
    let place = Workplace::new();
    let document = r#"{"marks":[],"settings":"","mirror":null,"parts":{}}"#;
    let session = format!(
        r#"{{"version":1,"source":null,"target":null,"document":{document},"next_id":1,"run":null,"undo":[],"redo":[],"check_sum":"0000000000000000"}}"#
    );
    place.write("a.session", &session);
    assert_refused(
        &place.drape("replay a.session -o out.obj"),
        &["a.session", "check sum"],
    );
}
