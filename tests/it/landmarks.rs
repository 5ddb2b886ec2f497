//! `drape landmarks`: on small files, and on the real pairs where the data are present.

use std::path::PathBuf;

use mesh_core::{io, Aabb, Point3};
use serde_json::{json, Value};

use crate::data::pairs;
use crate::support::{run, Workplace};

#[test]
fn check_says_what_is_wrong_and_sets_the_exit_code() {
    let place = Workplace::new();
    let well = place
        .drape("landmarks check source.obj target.ply landmarks.json")
        .well();
    assert!(well.stdout.contains("nothing looks wrong") && well.stdout.contains("(right)"));
    let text = place
        .read("landmarks.json")
        .replace("[14, 0, -5]", "[19, 0, -5]");
    place.write("landmarks.json", &text);
    let off = place.drape("landmarks check source.obj target.ply landmarks.json");
    assert_eq!(off.code, Some(1));
    assert!(
        off.stdout
            .contains("look at this: landmark 0 (right) is off the target's surface"),
        "{}",
        off.stdout
    );
}

#[test]
fn suggest_names_a_place_far_from_the_others() {
    let place = Workplace::new();
    let mut json: Value =
        serde_json::from_str(&place.read("landmarks.json")).expect("JSON is written");
    json["landmarks"].as_array_mut().expect("a list").pop();
    place.write("five.json", &json.to_string());
    let found = place
        .drape("landmarks suggest source.obj target.ply five.json -n 1 --json")
        .well()
        .json();
    let row = found["suggestions"][0]["source"]["vertex"]
        .as_u64()
        .expect("a vertex");
    let soup = io::read_soup(place.path("source.obj")).expect("the source");
    // The one that was taken away is the back of the ball, at z = −1.
    assert!(
        soup.positions[row as usize].z < -0.8,
        "{}",
        soup.positions[row as usize]
    );
}

#[test]
fn point_files_of_wrap_are_written_and_read() {
    let place = Workplace::new();
    let line = "landmarks convert source.obj target.ply";
    place
        .drape(&format!(
            "{line} landmarks.json -o a.json --target-output b.json"
        ))
        .well();
    let on_source: Value = serde_json::from_str(&place.read("a.json")).expect("JSON");
    assert_eq!(on_source["right"].as_array().map(Vec::len), Some(3));
    place
        .drape(&format!(
            "{line} a.json --target-points b.json -o back.json"
        ))
        .well();
    let [before, after] = ["landmarks.json", "back.json"].map(|name| {
        let json: Value = serde_json::from_str(&place.read(name)).expect("JSON");
        let list = json["landmarks"].as_array().expect("a list").clone();
        list.iter()
            .map(|l| l["name"].as_str().map(str::to_owned))
            .collect::<std::collections::BTreeSet<_>>()
    });
    assert_eq!(before, after);
    let lone = place.drape(&format!("{line} a.json -o back.json"));
    assert_eq!((lone.code, lone.stderr.lines().count()), (Some(2), 1));
}

#[test]
fn curves_and_weights_are_draped_told_and_converted() {
    let place = Workplace::new();
    let mut json: Value = serde_json::from_str(&place.read("landmarks.json")).expect("JSON");
    json["landmarks"][1]["weight"] = json!(0.5);
    // A quarter of the girdle of the ball, from the front to the right.
    let turn = [0.0, 0.3, 0.6, 0.9, 1.2, 1.5].map(f64::sin_cos);
    let source = turn.map(|(sin, cos)| [sin, 0.0, cos]);
    let target = turn.map(|(sin, cos)| [10.0 + 4.0 * sin, 0.0, 2.5 * cos - 5.0]);
    let list = json["landmarks"].as_array_mut().expect("a list");
    list.insert(
        0,
        json!({ "name": "girdle", "curve": { "source": source, "target": target } }),
    );
    place.write("curved.json", &json.to_string());
    let line = "source.obj target.ply --landmarks curved.json --preset quick -o out.obj";
    place
        .drape(&format!("transfer {line} --report report.html"))
        .well();
    assert!(place.read("report.html").contains("curve 0 (girdle)"));
    let metrics = "metrics source.obj out.obj target.ply --landmarks curved.json --json";
    let report = place.drape(metrics).well().json();
    let worst = report["report"]["curves"][0]["max"]
        .as_f64()
        .expect("a number");
    assert!(worst < 0.01, "{worst}");
    let check = place
        .drape("landmarks check source.obj target.ply curved.json")
        .well();
    assert!(
        check.stdout.contains("nothing looks wrong"),
        "{}",
        check.stdout
    );
    let convert = "landmarks convert source.obj target.ply curved.json -o";
    let lost = place.drape(&format!("{convert} plain.txt"));
    assert!(
        lost.stderr.contains("1 curve is left out"),
        "{}",
        lost.stderr
    );
    assert!(lost.stderr.contains("the weight of 1 landmark is left out"));
    place.drape(&format!("{convert} again.json")).well();
    let [a, b] = ["curved.json", "again.json"].map(|name| {
        let line = format!("init source.obj target.ply --landmarks {name} -o {name}.obj");
        place.drape(&line).well();
        place.read(&format!("{name}.obj"))
    });
    assert!(a == b);
    json["landmarks"][0]["curve"]["target"] = json!([[10.0, 0.0, -2.5]]);
    place.write("bad.json", &json.to_string());
    let bad = place.drape("landmarks check source.obj target.ply bad.json");
    assert_eq!(bad.code, Some(2));
    assert!(
        bad.stderr
            .contains("bad.json: curve 0 (girdle): has 1 places on the target"),
        "{}",
        bad.stderr
    );
}

#[test]
fn mirror_adds_the_other_half() {
    let place = Workplace::new();
    let json = json!({"landmarks": [
        {"name": "right ear", "source": {"point": [0.7, 0.7, 0.1]}, "target": {"point": [12.8, 2.1, -4.75]}},
        {"name": "top", "source": {"point": [0, 1, 0]}, "target": {"point": [10, 3, -5]}},
        {"name": "front", "source": {"point": [0, 0, 1]}, "target": {"point": [10, 0, -2.5]}},
        {"name": "bottom", "source": {"point": [0, -1, 0]}, "target": {"point": [10, -3, -5]}},
    ]});
    place.write("half.json", &json.to_string());
    let ended = place
        .drape("landmarks mirror source.obj target.ply half.json -o whole.json")
        .well();
    assert!(ended.stdout.contains("left ear"), "{}", ended.stdout);
    let whole: Value = serde_json::from_str(&place.read("whole.json")).expect("JSON");
    let list = whole["landmarks"].as_array().expect("a list");
    assert_eq!(list.len(), 5);
    let x = list[4]["target"]["point"][0].as_f64().expect("a number");
    assert!((x - 7.2).abs() < 0.05, "{x}");
}

#[test]
fn converted_landmarks_give_the_same_drape() {
    let place = Workplace::new();
    for (form, name) in [("points", "a.txt"), ("json", "b.json")] {
        place
            .drape(&format!(
                "landmarks convert source.obj target.ply landmarks.json --to {form} -o {name}"
            ))
            .well();
    }
    place.transfer("").well();
    let positions = |name: &str| io::read_soup(place.path(name)).expect("a result").positions;
    let expected = positions("out.obj");
    for name in ["a.txt", "b.json"] {
        place
            .drape(&format!(
                "transfer source.obj target.ply -l {name} --config short.toml -o again.obj"
            ))
            .well();
        // Places in faces come back to the last digits only, and those are amplified by twelve steps.
        let far = positions("again.obj")
            .iter()
            .zip(&expected)
            .map(|(a, b)| (a - b).norm())
            .fold(0.0, f64::max);
        assert!(far < 1e-4, "{name}: {far}");
    }
    place
        .drape("landmarks convert source.obj target.ply landmarks.json --to ids -o ids.txt")
        .well();
    assert_eq!(place.read("ids.txt").lines().count(), 6);
}

/// A pair of the data with landmarks that a test may spoil.
struct RealPair {
    folder: PathBuf,
    vertices: Vec<u64>,
    points: Vec<[f64; 3]>,
}

impl RealPair {
    fn read(folder: PathBuf) -> Self {
        let text = std::fs::read_to_string(folder.join("landmarks.json")).expect("landmarks");
        let json: Value = serde_json::from_str(&text).expect("JSON");
        let read = |key: &str| json[key].clone();
        Self {
            vertices: serde_json::from_value(read("source_vertices")).expect("a list"),
            points: serde_json::from_value(read("target_points")).expect("a list"),
            folder,
        }
    }

    /// What the doctor says about the landmarks as they are now.
    fn findings(&self) -> Vec<String> {
        let place = Workplace::new();
        let json = json!({"source_vertices": self.vertices, "target_points": self.points});
        place.write("lm.json", &json.to_string());
        let path = |name: &str| self.folder.join(name).to_string_lossy().into_owned();
        let landmarks = place.path("lm.json").to_string_lossy().into_owned();
        let (source, target) = (path("source.obj"), path("target.obj"));
        let arguments = ["landmarks", "check", &source, &target, &landmarks, "--json"];
        let found = run(&self.folder, arguments).json();
        serde_json::from_value(found["findings"].clone()).expect("a list")
    }

    fn has(&self, words: &[&str]) -> bool {
        let findings = self.findings();
        findings.iter().any(|f| words.iter().all(|w| f.contains(w)))
    }
}

#[test]
fn clean_sets_raise_no_alarm() {
    let Some(pairs) = pairs() else {
        return;
    };
    let mut n_checked = 0;
    for folder in std::fs::read_dir(pairs).expect("a folder").flatten() {
        let pair = RealPair::read(folder.path());
        assert_eq!(pair.findings(), Vec::<String>::new(), "{:?}", folder.path());
        n_checked += 1;
    }
    assert_eq!(n_checked, 12);
}

#[test]
fn spoiled_landmarks_are_named() {
    let Some(pairs) = pairs() else {
        return;
    };
    for name in ["mediapipe_ict", "body_lowpoly_muscle_gt", "ict_identity_gt"] {
        let clean = || RealPair::read(pairs.join(name));
        let n = clean().points.len();

        let mut swapped = clean();
        swapped.points.swap(2, n / 2);
        let (a, b) = ("landmark 2 ".to_owned(), format!("landmark {} ", n / 2));
        assert!(
            swapped.has(&[&a, &b, "exchanged"]),
            "{name}: {:?}",
            swapped.findings()
        );

        let mut moved = clean();
        let target = io::read_soup(moved.folder.join("target.obj")).expect("the target");
        moved.points[n / 3] = a_tenth_away(&target.positions, moved.points[n / 3]);
        let who = format!("landmark {} ", n / 3);
        assert!(
            moved.has(&[&who, "expect it"]),
            "{name}: {:?}",
            moved.findings()
        );

        let mut twice = clean();
        twice.vertices.push(twice.vertices[1]);
        twice.points.push(twice.points[1]);
        assert!(twice.has(&["landmark 1 ", "are the same"]), "{name}");

        let mut mirrored = clean();
        let middle = Aabb::of(&target.positions);
        for p in &mut mirrored.points {
            p[0] = middle.min.x + middle.max.x - p[0];
        }
        assert!(mirrored.has(&["mirror image"]), "{name}");
    }
}

/// The vertex whose distance from `from` is nearest to a tenth of the longest side.
fn a_tenth_away(vertices: &[Point3], from: [f64; 3]) -> [f64; 3] {
    let reach = 0.1 * Aabb::of(vertices).longest_side();
    let off = |p: &Point3| ((p - Point3::from(from)).norm() - reach).abs();
    let found = vertices.iter().min_by(|a, b| off(a).total_cmp(&off(b)));
    found.expect("a vertex").coords.into()
}
