//! The smaller commands.

use crate::support::Workplace;

#[test]
fn init_meets_the_landmarks() {
    let place = Workplace::new();
    let json = place
        .drape("init source.obj target.ply -l landmarks.json -o out.obj --json --render out.png")
        .well()
        .json();
    assert!(json["figures"]["landmark_max"]
        .as_f64()
        .is_some_and(|d| d < 1e-6));
    assert!(place.exists("out.obj") && place.exists("out.png"));
}

#[test]
fn a_saved_map_moves_the_source_where_the_drape_moved_it() {
    let place = Workplace::new();
    place.transfer("--warp out.drape").well();
    place
        .drape("apply out.drape source.obj -o again.obj")
        .well();
    let read = |name: &str| {
        mesh_core::io::read_soup(place.path(name))
            .expect("a mesh")
            .positions
    };
    let far = read("out.obj")
        .iter()
        .zip(&read("again.obj"))
        .map(|(a, b)| (a - b).norm())
        .fold(0.0, f64::max);
    assert!(far < 1e-5, "{far}");

    let junk = place.drape("apply source.obj source.obj -o never.obj");
    assert_eq!((junk.code, junk.stderr.lines().count()), (Some(2), 1));
    assert!(!place.exists("never.obj"));
}

#[test]
fn metrics_agree_with_the_drape_that_made_the_result() {
    let place = Workplace::new();
    let made = place.transfer("--json").well().json();
    let judged = place
        .drape("metrics source.obj out.obj target.ply -l landmarks.json --truth out.obj --json --render m.png")
        .well()
        .json();
    for name in ["q_transfer", "dirichlet", "folds", "mean_l2_sum"] {
        let [a, b] = [&made, &judged].map(|j| j["figures"][name].as_f64().expect("a number"));
        assert!((a - b).abs() < 1e-4 * a.abs().max(1e-3), "{name}: {a} {b}");
    }
    assert_eq!(judged["figures"]["truth_max"], 0.0);
    assert_eq!(
        place
            .drape("metrics source.obj out.obj target.ply --require q<0.1")
            .code,
        Some(1)
    );

    let other = place.drape("metrics source.obj target.ply target.ply");
    assert_eq!(other.code, Some(2));
    assert!(
        other
            .stderr
            .contains("642 vertices, but the source has 218"),
        "{}",
        other.stderr
    );
}

#[test]
fn what_points_up_in_a_picture_can_be_told() {
    let place = Workplace::new();
    for up in ["", "--up y", "--up -x"] {
        let line = format!("inspect target.ply --render up{}.png {up}", up.len());
        place.drape(&line).well();
    }
    let [found, y, minus_x] =
        [0, 6, 7].map(|n| std::fs::read(place.path(&format!("up{n}.png"))).expect("a picture"));
    // A ball has no feet.
    assert!(found == y && minus_x != y);

    let ended = place.drape("inspect target.ply --render out.png --up w");
    assert_eq!(ended.code, Some(2));
    assert!(ended.stderr.contains("-z"), "{}", ended.stderr);
}

#[test]
fn inspect_tells_what_is_in_a_file() {
    let place = Workplace::new();
    let json = place
        .drape("inspect source.obj --json --render out.png")
        .well()
        .json();
    assert_eq!((&json["faces"], &json["genus"]), (&216.into(), &0.into()));
    assert_eq!(json["faces_by_corners"]["4"], 216);
    assert_eq!(json["texture_coordinates"], 4);
    assert_eq!(json["groups"].as_array().map(Vec::len), Some(6));
    assert!(place
        .drape("inspect source.obj")
        .well()
        .stdout
        .contains("not_there.mtl"));
    assert!(place.exists("out.png"));
}

#[test]
fn a_preset_prints_a_file_that_can_be_run() {
    let place = Workplace::new();
    let names = place.drape("presets").well().stdout;
    assert!(names.lines().any(|name| name == "paper"));
    let settings = place
        .drape(&format!(
            "presets {}",
            names.lines().next().unwrap_or_default()
        ))
        .well()
        .stdout;
    place.write("whole.toml", &settings);
    place.write(
        "short.toml",
        &settings.replace("n_iterations = ", "n_iterations = 1 # "),
    );
    place.transfer("").well();
}

#[test]
fn the_networks_run_too() {
    let place = Workplace::new();
    for preset in ["paper", "network"] {
        let json = place
            .transfer(&format!("--preset {preset} --json"))
            .well()
            .json();
        assert!(
            json["figures"]["hausdorff"]
                .as_f64()
                .is_some_and(|h| h < 0.1),
            "{preset}"
        );
    }
}

#[test]
fn the_demo_needs_no_file() {
    let place = Workplace::new();
    let ended = place.drape("demo -o shown --config short.toml").well();
    for name in [
        "source.obj",
        "target.obj",
        "truth.ply",
        "landmarks.json",
        "draped.obj",
        "draped.drape",
        "draped.png",
        "report.html",
    ] {
        assert!(place.exists(&format!("shown/{name}")), "{name}");
    }
    let is_beside = |line: &str| line.split_whitespace().eq(["initial", "result"]);
    let beside = ended.stdout.lines().skip_while(|line| !is_beside(line));
    let headings = ["Q_transfer", "from the truth", "folded edges", "crossings"];
    for (line, heading) in beside.skip(1).zip(headings) {
        assert!(line.starts_with(heading), "{line}");
    }
    assert!(!ended.stderr.contains("warning"), "{}", ended.stderr);
    let shown = ended
        .stdout
        .lines()
        .next()
        .and_then(|line| line.split_once("drape "))
        .expect("a command");
    place
        .drape(&format!("{} --config short.toml", shown.1))
        .well();
}

#[test]
fn help_and_version_go_to_stdout() {
    let place = Workplace::new();
    assert!(place.drape("--help").well().stdout.contains("transfer"));
    assert!(place
        .drape("transfer --help")
        .well()
        .stdout
        .contains("--landmarks"));
    assert!(place.drape("--version").well().stdout.starts_with("drape "));
}
