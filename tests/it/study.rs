//! The paper's studies, and the script that makes a manifest of SHREC'07/BIM.

use std::path::Path;
use std::process::Command;

use mesh_core::{io, shapes};

use crate::data::skip;
use crate::support::Workplace;

/// A manifest whose pairs are small and whose presets are not looked at.
const MANIFEST: &str = "presets = ['paper']\nseeds = [9]\n\
    [[pair]]\nname = 'ball'\nsource = 'source.obj'\ntarget = 'target.ply'\nlandmarks = 'landmarks.json'\n";

#[test]
fn a_study_compares_settings_on_any_manifest_and_writes_its_part_of_a_page() {
    let place = Workplace::new();
    place.write("suite.toml", MANIFEST);
    let line =
        "evaluate --study encoding suite.toml --seeds 2 -o runs --page page.md --commit abc1234";
    place.write("page.md", "# Mine\n");
    let refused = place.drape(line);
    assert_eq!(refused.code, Some(2));
    assert!(
        refused.stderr.contains("--study encoding"),
        "{}",
        refused.stderr
    );
    assert!(!place.exists("runs"));

    let marks = [
        "<!-- study: written by `drape evaluate --study encoding --page` -->",
        "<!-- end of study encoding -->",
    ];
    place.write(
        "page.md",
        &format!("# Mine\n{}\nstale\n{}\nmy words\n", marks[0], marks[1]),
    );
    place.drape(line).well();
    let page = place.read("page.md");
    assert!(
        page.starts_with("# Mine\n") && page.ends_with("\nmy words\n") && !page.contains("stale")
    );
    assert!(page.contains("commit abc1234") && page.contains("6 runs"));
    assert!(
        page.contains("| progressive |")
            && page.contains("| static |")
            && page.contains("| none |")
    );
    // Two seeds give a spread.
    assert!(page.contains(" ± "), "{page}");
    // There is a curve over the creatures' dial alone.
    assert!(!place.exists("runs/study-encoding.svg"));
}

#[test]
fn the_script_for_shrec07_gives_a_manifest_that_runs() {
    let place = Workplace::new();
    let folder = |name: &str| std::fs::create_dir(place.path(name)).expect("a folder");
    folder("off");
    folder("vts");
    let ball = shapes::icosphere(2);
    for model in ["1", "2"] {
        io::write_soup(place.path(&format!("off/{model}.off")), &ball).expect("a mesh");
    }
    // Numbers alone, counted from 0; numbers with places, counted from 1; the third place is missing in one of them.
    place.write("vts/1.vts", "0\n1\n2\n3\n4\n");
    let with_place = |v: usize| {
        let p = ball.positions[v];
        format!("{} {} {} {}\n", v + 1, p.x, p.y, p.z)
    };
    let lines = [
        with_place(5),
        with_place(6),
        "-1\n".into(),
        with_place(7),
        with_place(8),
    ];
    place.write("vts/2.vts", &lines.concat());
    place.write("pairs.txt", "# the pairs\n1 2\noff/2.off, off/1.off\n");
    let Some(ended) = script(&place, "off vts pairs.txt out") else {
        return;
    };
    assert_eq!(ended, Ok("2 pairs: out/shrec07.toml\n".to_owned()));
    let marks: serde_json::Value = serde_json::from_str(&place.read("out/1-2.json")).expect("JSON");
    let marks: Vec<_> = marks["landmarks"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|mark| {
            let vertex = |side: &str| mark[side]["vertex"].as_u64().expect("a vertex");
            (vertex("source"), vertex("target"))
        })
        .collect();
    assert_eq!(marks, [(0, 5), (1, 6), (3, 7), (4, 8)]);
    let toml = place.read("out/shrec07.toml");
    place.write(
        "out/shrec07.toml",
        &toml.replace("'paper', 'standard'", "'initial'"),
    );
    let ran = place.drape("evaluate out/shrec07.toml -o runs").well();
    assert!(ran.stdout.starts_with("2 of 2 runs done"), "{}", ran.stdout);

    place.write("vts/2.vts", "5\nsix\n");
    let wrong = script(&place, "off vts pairs.txt out")
        .expect("as before")
        .unwrap_err();
    assert!(
        wrong.contains("2.vts, line 2") && wrong.lines().count() == 1,
        "{wrong}"
    );
}

/// What the script prints, or what it says is wrong; none where there is no Python.
fn script(place: &Workplace, line: &str) -> Option<Result<String, String>> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/studies/shrec07.py");
    let command = Command::new("python3")
        .arg(script)
        .args(line.split_whitespace())
        .current_dir(place.path(""))
        .output();
    let Ok(output) = command else {
        skip("no python3");
        return None;
    };
    let text = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes).into_owned();
    Some(match output.status.code() {
        Some(0) => Ok(text(output.stdout)),
        _ => Err(text(output.stderr)),
    })
}
