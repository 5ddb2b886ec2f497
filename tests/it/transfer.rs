//! `drape transfer` and what it leaves behind.

use crate::support::Workplace;

#[test]
fn the_result_is_the_source_file_but_for_positions_and_normals() {
    let place = Workplace::new();
    place.transfer("").well();
    let (source, result) = (place.read("source.obj"), place.read("out.obj"));
    assert_eq!(source.split('\n').count(), result.split('\n').count());
    for (before, after) in source.split('\n').zip(result.split('\n')) {
        match before.split_whitespace().next() {
            Some("v") => {
                assert!(after.starts_with("v ") && after.ends_with("# kept") && after != before)
            }
            Some("vn") => assert!(after.starts_with("vn ")),
            _ => assert_eq!(before, after),
        }
    }
}

#[test]
fn the_same_seed_gives_the_same_bytes_whatever_the_threads() {
    let place = Workplace::new();
    place.transfer("--seed 5 --threads 1").well();
    let one = place.read("out.obj");
    place.transfer("--seed 5 --threads 2").well();
    assert!(one == place.read("out.obj"));
    place.transfer("--seed 6 --threads 2").well();
    assert!(one != place.read("out.obj"));
}

#[test]
fn figures_come_as_a_table_or_as_json() {
    let place = Workplace::new();
    let table = place.transfer("").well();
    assert!(table.stdout.contains("Q_transfer") && table.stdout.contains("wrote out.obj"));
    assert!(table.stdout.contains("CPU-seconds") && table.stdout.contains("peak memory"));
    assert!(table.stdout.contains("right") && table.stdout.contains("back"));
    let n_lines = table
        .stderr
        .lines()
        .filter(|line| line.contains('%'))
        .count();
    assert_eq!(n_lines, 10, "{}", table.stderr);

    let json = place.transfer("--json").well().json();
    assert!(json["figures"]["q_transfer"]
        .as_f64()
        .is_some_and(|q| q > 0.8));
    assert_eq!(json["figures"]["folds"], 0.0);
    assert_eq!(
        json["report"]["landmarks"]["residuals"]
            .as_array()
            .map(Vec::len),
        Some(6)
    );
    assert_eq!(json["warnings"].as_array().map(Vec::len), Some(0));
}

#[test]
fn requirements_set_the_exit_code() {
    let place = Workplace::new();
    assert_eq!(place.transfer("--require q>=0.5,folds=0").code, Some(0));
    let unmet = place.transfer("--require q>=0.5,vertices<10");
    assert_eq!(unmet.code, Some(1));
    assert!(unmet.stderr.contains("not met: vertices < 10"));
    assert!(place.exists("out.obj"));
    let unknown = place.transfer("--require quality=1");
    assert_eq!((unknown.code, unknown.stderr.lines().count()), (Some(2), 1));
}

#[test]
fn report_and_picture_stand_alone() {
    let place = Workplace::new();
    place
        .transfer("--report out.html --render out.png --view front --view 120,10")
        .well();
    let html = place.read("out.html");
    assert!(html.contains("data:image/png;base64,") && html.contains("<svg"));
    assert!(!html.contains("http://") && !html.contains("https://") && !html.contains("src=\"out"));
    let png = std::fs::read(place.path("out.png")).expect("a picture");
    assert!(png.starts_with(b"\x89PNG"));
}

#[test]
fn a_landmark_that_is_wrong_is_warned_about() {
    let place = Workplace::new();
    let swapped = place
        .read("landmarks.json")
        .replace("[14, 0, -5]", "[x]")
        .replace("[10, 3, -5]", "[14, 0, -5]")
        .replace("[x]", "[10, 3, -5]");
    place.write("landmarks.json", &swapped);
    let warned = place.transfer("").well();
    assert!(
        warned
            .stderr
            .contains("warning: landmark 0 (right) and landmark 2 (top) are probably exchanged"),
        "{}",
        warned.stderr
    );
}

#[test]
fn clouds_and_other_formats_are_draped_over_and_written() {
    let place = Workplace::new();
    let mut cloud = mesh_core::io::read_soup(place.path("target.ply")).expect("the target");
    cloud.faces.clear();
    mesh_core::io::write_soup(place.path("cloud.ply"), &cloud).expect("the cloud is written");
    let ended = place
        .drape("transfer source.obj cloud.ply -l landmarks.json --config short.toml -o out.ply")
        .well();
    assert!(ended
        .stderr
        .contains("warning: from OBJ to PLY, these are not kept"));
    assert!(ended.stdout.contains("point cloud"));
    let written = mesh_core::io::read_soup(place.path("out.ply")).expect("the result");
    let source = mesh_core::io::read_soup(place.path("source.obj")).expect("the source");
    assert_eq!(written.faces, source.faces);
}

#[test]
fn without_landmarks_the_shapes_are_laid_over_each_other() {
    let place = Workplace::new();
    let ended = place
        .drape("transfer source.obj target.ply --config short.toml -o out.obj --json")
        .well();
    assert!(ended.stderr.contains("warning: no landmarks"));
    let hausdorff = ended.json()["figures"]["hausdorff"].as_f64();
    assert!(hausdorff.is_some_and(|h| h < 0.25), "{hausdorff:?}");
}
