//! Coordinates, settings and threads that once broke the program.

use super::assert_refused;
use crate::support::Workplace;

#[test]
fn a_target_whose_coordinates_are_all_subnormal() {
    let place = Workplace::new();
    place.write(
        "target.ply",
        "v 0 0 0\nv 1e-310 0 0\nv 0 1e-310 0\nf 1 2 3\n",
    );
    assert_refused(
        &place.drape("transfer source.obj target.ply -o out.obj"),
        &["target.ply", "too small"],
    );
}

#[test]
fn settings_that_ask_for_more_memory_than_there_is() {
    let place = Workplace::new();
    for setting in ["n_hard = 1000000000", "n_samples = 100000000"] {
        place.write("short.toml", &format!("[sampling]\n{setting}\n"));
        let name = setting.split(' ').next().unwrap_or_default();
        assert_refused(&place.transfer(""), &[name, "GiB"]);
    }
}

#[test]
fn a_million_threads() {
    let place = Workplace::new();
    let ended = place.drape("--threads 1000000 presets").well();
    assert!(ended.stderr.contains("it uses 512"), "{}", ended.stderr);
}
