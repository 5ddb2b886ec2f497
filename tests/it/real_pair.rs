//! A short drape of a real pair, where the data are present.

use mesh_core::{io, Point3, Vector3};
use nalgebra::Rotation3;

use crate::data::horse_wolf;
use crate::support::{run, Workplace};

/// A folder with settings for a short run.
fn workplace() -> Workplace {
    let place = Workplace::new();
    place.write(
        "short.toml",
        "[[stages]]\nn_iterations = 60\n[[stages]]\nn_iterations = 30\n",
    );
    place
}

#[test]
fn a_horse_becomes_a_wolf_and_keeps_its_file() {
    let Some(pair) = horse_wolf() else {
        return;
    };
    let place = workplace();
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
    // Nothing is wrong but where so short a run leaves the surface running through itself, which the figures count.
    let warnings = json["warnings"].as_array().expect("a list");
    let is_of_crossing =
        |warning: &serde_json::Value| warning.to_string().contains("run through each other");
    assert!(warnings.iter().all(is_of_crossing), "{json:#}");
    let crossings = json["figures"]["crossings"].as_f64();
    assert_eq!(crossings == Some(0.0), warnings.is_empty(), "{json:#}");

    let text = |path: &str| std::fs::read_to_string(path).expect("a file");
    let kept = |text: String| -> Vec<String> {
        let is_kept = |line: &&str| !line.starts_with("v ") && !line.starts_with("vn ");
        text.lines().filter(is_kept).map(str::to_owned).collect()
    };
    assert_eq!(kept(text(&source)), kept(text(&output)));
}

/// Both files turned, scaled and moved, each in its own way: the result is that of the files as they are.
#[test]
fn units_place_and_turn_of_the_files_do_not_matter() {
    let Some(pair) = horse_wolf() else {
        return;
    };
    let place = workplace();
    let drape = |folder: &str, of_source: &Map<'_>, of_target: &Map<'_>| {
        std::fs::create_dir(place.path(folder)).expect("a folder");
        for (name, map) in [("source.obj", of_source), ("target.obj", of_target)] {
            let mut soup = io::read_soup(pair.join(name)).expect("a mesh");
            soup.positions.iter_mut().for_each(|p| *p = map(p));
            io::write_soup(place.path(folder).join(name), &soup).expect("it is written");
        }
        let text = std::fs::read_to_string(pair.join("landmarks.json")).expect("a file");
        let mut landmarks: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        for point in landmarks["target_points"].as_array_mut().expect("points") {
            let [x, y, z] = [0, 1, 2].map(|k| point[k].as_f64().expect("a number"));
            let moved = of_target(&Point3::new(x, y, z));
            *point = serde_json::json!([moved.x, moved.y, moved.z]);
        }
        place.write(&format!("{folder}/landmarks.json"), &landmarks.to_string());
        place
            .drape(&format!(
                "transfer {folder}/source.obj {folder}/target.obj -l {folder}/landmarks.json --config short.toml -o {folder}/out.obj"
            ))
            .well();
        io::read_soup(place.path(&format!("{folder}/out.obj")))
            .expect("a mesh")
            .positions
    };
    let turn = Rotation3::from_euler_angles(0.7, -1.1, 2.3);
    let far = |p: &Point3| turn * p * 1000.0 + Vector3::new(1e4, -1e4, 1e4);
    let small = |p: &Point3| Point3::from(turn.inverse() * p.coords * 0.001);
    let here = drape("here", &|p| *p, &|p| *p);
    let there = drape("there", &small, &far);

    let side = 1000.0 * mesh_core::Aabb::of(&here).longest_side();
    let shifts = here.iter().zip(&there).map(|(a, b)| (far(a) - b).norm());
    let worst = shifts.fold(0.0, f64::max) / side;
    assert!(worst < 1e-3, "{worst} of the longest side");
}

type Map<'a> = dyn Fn(&Point3) -> Point3 + 'a;
