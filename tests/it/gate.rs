//! Results are held against bounds, and the page of results is written from a run.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::support::Workplace;

const MANIFEST: &str = "presets = ['short.toml']\n\
    [[pair]]\nname = 'ball'\nsection = 'Balls'\nsource = 'source.obj'\ntarget = 'target.ply'\n\
    landmarks = 'landmarks.json'\n";

/// A folder with a manifest, and one whose data is not there.
fn place() -> Workplace {
    let place = Workplace::new();
    place.write("gate.toml", MANIFEST);
    place.write("absent.toml", &format!("data = 'nowhere'\n{MANIFEST}"));
    place
}

#[test]
fn a_result_that_falls_behind_its_bound_is_named() {
    let place = place();
    let line = "evaluate gate.toml -o runs --bounds bounds.toml";
    let missing = place.drape(line);
    assert_eq!(missing.code, Some(2), "{}", missing.stderr);

    place.drape(&format!("{line} --tighten")).well();
    let bounds = place.read("bounds.toml");
    assert!(
        bounds.contains("pair = \"ball\"") && bounds.contains("\nfolds = "),
        "{bounds}"
    );
    let held = place.drape(line).well();
    assert!(
        held.stdout
            .contains("1 runs held against their bounds, 0 bounds broken"),
        "{}",
        held.stdout
    );

    let line_of_q = bounds
        .lines()
        .find(|l| l.starts_with("q_transfer"))
        .expect("a bound of Q");
    let higher = bounds.replace(line_of_q, "q_transfer = 1.5");
    place.write("bounds.toml", &higher);
    let broken = place.drape(&format!("{line} --tighten"));
    assert_eq!(broken.code, Some(1));
    assert!(
        broken.stderr.contains("ball short seed 0: q_transfer 0."),
        "{}",
        broken.stderr
    );
    assert!(
        broken.stderr.contains("below the bound 1.499"),
        "{}",
        broken.stderr
    );
    assert_eq!(place.read("bounds.toml"), higher);
}

#[test]
fn pairs_without_data_are_left_out_and_said() {
    let place = place();
    let ended = place.drape("evaluate absent.toml -o runs").well();
    assert!(
        ended
            .stdout
            .contains("left out, no data here: 1 pairs: ball"),
        "{}",
        ended.stdout
    );
    let marks = fs::read_to_string(docs("results.md")).expect("the page of the repository");
    place.write("results.md", &marks);
    let page = place.drape("evaluate absent.toml -o runs --page results.md --commit abc");
    assert_eq!((page.code, page.stderr.contains("ball")), (Some(2), true));
}

#[test]
fn a_page_is_written_between_its_marks() {
    let place = place();
    let line = "evaluate gate.toml -o runs --page results.md --commit abc1234";
    place.write("results.md", "# Results\n");
    assert_eq!(place.drape(line).code, Some(2));
    assert!(!place.exists("runs"));

    let repository = fs::read_to_string(docs("results.md")).expect("the page of the repository");
    place.write("results.md", &repository);
    place.drape(line).well();
    let page = place.read("results.md");
    assert!(
        page.contains("commit abc1234")
            && page.contains("## Balls")
            && page.contains("| ball | 0.")
    );
    let ends = |text: &str| {
        text.split_once("<!-- end of figures -->")
            .map(|(_, end)| end.to_owned())
    };
    assert_eq!(ends(&page), ends(&repository));
    assert!(!page
        .split("<!-- end")
        .next()
        .is_some_and(|written| written.contains("| horse_wolf |")));
}

/// The list of runs, its bounds and the page of results agree: a bound that was tightened without writing the page, or a
/// pair that was added to one of them only, is found here.
#[test]
fn the_page_of_the_repository_is_of_its_list_and_holds_its_bounds() {
    let text = |name| fs::read_to_string(docs(name)).expect(name);
    let (manifest, bounds, page) = (text("gate.toml"), text("bounds.toml"), text("results.md"));
    let listed = values(&manifest, "name");
    assert!(listed.len() >= 12, "{} pairs", listed.len());
    // Creatures, which are always there, follow the list.
    let bounded = values(&bounds, "pair");
    let (of_list, creatures) = bounded.split_at(listed.len());
    assert_eq!(of_list, listed);
    for plan in ["quadruped", "person", "bird", "insect", "head"] {
        assert!(
            creatures.iter().any(|name| name.starts_with(plan)),
            "{plan}"
        );
    }

    let written = page
        .split_once("<!-- figures:")
        .expect("the mark before the figures")
        .1;
    let written = written
        .split_once("<!-- end of figures -->")
        .expect("the mark after them")
        .0;
    assert!(written.contains(", commit "));
    let rows = rows(written);
    for entry in bounds.split("[[bound]]").skip(1) {
        let pair = &values(entry, "pair")[0];
        let row = rows
            .get(pair)
            .unwrap_or_else(|| panic!("{pair} is on the page"));
        if let Some(reached) = number(entry, "q_transfer") {
            // The slack of the bound, and the rounding of the page.
            assert!(
                row["Q"] >= reached - 0.001_05,
                "{pair}: Q {} after {reached}",
                row["Q"]
            );
        }
        if let Some(reached) = number(entry, "truth_mean") {
            let truth = row["truth, mean"];
            assert!(
                truth <= 1.02 * reached + 0.000_05,
                "{pair}: truth {truth} after {reached}"
            );
        }
        let folds = number(entry, "folds").expect("a bound of folds");
        assert!(row["new folds"] <= folds, "{pair}");
    }
}

fn docs(name: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../docs")
        .join(name)
}

/// The texts that `key` has in a TOML file.
fn values(toml: &str, key: &str) -> Vec<String> {
    let lines = toml.lines().filter_map(|line| line.split_once(" = "));
    let named = lines.filter(|(name, _)| *name == key);
    named
        .map(|(_, value)| value.trim_matches('"').to_owned())
        .collect()
}

fn number(toml: &str, key: &str) -> Option<f64> {
    values(toml, key)
        .first()
        .map(|value| value.parse().expect("a number"))
}

/// The numbers of the rows of all tables, by the first cell and the heading.
fn rows(page: &str) -> BTreeMap<String, BTreeMap<String, f64>> {
    let cells = |line: &str| -> Vec<String> {
        let inner = line.trim_matches('|').split('|');
        inner.map(|cell| cell.trim().to_owned()).collect()
    };
    let mut headings = Vec::new();
    let mut rows = BTreeMap::new();
    for line in page.lines().filter(|line| line.starts_with('|')) {
        let cells = cells(line);
        if cells[0] == "run" {
            headings = cells;
            continue;
        }
        let numbers = headings.iter().zip(&cells).skip(1);
        let numbers = numbers.filter_map(|(name, cell)| Some((name.clone(), cell.parse().ok()?)));
        rows.insert(cells[0].clone(), numbers.collect());
    }
    rows
}
