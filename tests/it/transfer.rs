//! `drape transfer` and what it leaves behind.

use mesh_core::{shapes, PolygonSoup};

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
fn a_dense_source_is_draped_by_a_stand_in_and_refined() {
    let place = Workplace::new();
    place.write("dense.obj", &obj(&shapes::quad_sphere(52)));
    let mut egg = shapes::quad_sphere(12);
    egg.positions.iter_mut().for_each(|p| p.z *= 1.6);
    place.write("egg.obj", &obj(&egg));
    place.write("dense.toml", "[[stages]]\nn_iterations = 40\n");
    let line = "transfer dense.obj egg.obj -o out.obj --config dense.toml --profile --json";
    let json = place.drape(line).well().json();
    let said = json["warnings"].to_string();
    assert!(said.contains("the source is dense"), "{said}");
    assert!(
        json["figures"]["q_transfer"]
            .as_f64()
            .is_some_and(|q| q > 0.9),
        "{}",
        json["figures"]
    );
    assert_eq!(json["figures"]["folds"], 0.0);
    let spent = &json["profile"]["cpu_seconds"];
    for stage in ["reading", "stand-in", "drape", "drape, refined", "figures"] {
        assert!(spent[stage].as_f64().is_some(), "{spent}");
    }
    assert!(json["profile"]["parts"]["angles"].as_f64().is_some());
    let faces = |name| -> Vec<String> {
        let text = place.read(name);
        text.lines()
            .filter(|l| l.starts_with('f'))
            .map(str::to_owned)
            .collect()
    };
    assert_eq!(faces("dense.obj"), faces("out.obj"));
}

/// The text of an OBJ file.
fn obj(soup: &PolygonSoup) -> String {
    let points = soup
        .positions
        .iter()
        .map(|p| format!("v {} {} {}\n", p.x, p.y, p.z));
    let faces = soup.faces.iter().map(|face| {
        let rows: Vec<String> = face.iter().map(|v| (v + 1).to_string()).collect();
        format!("f {}\n", rows.join(" "))
    });
    points.chain(faces).collect()
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
