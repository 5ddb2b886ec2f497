//! What the footer says is so.

use std::fs;

use serde_json::{json, Value};

use super::browser::{browser, Page};
use super::server::Server;
use super::wire::download;
use crate::data::horse_wolf;
use crate::support::Workplace;

/// The first eleven of the horse's landmarks, for which a drape has been seen to run into itself.
fn eleven(all: &str) -> String {
    let all: Value = serde_json::from_str(all).expect("landmarks");
    let first = |key: &str| all[key].as_array().map(|list| list[..11].to_vec());
    let lists = ["source_vertices", "target_points"].map(|key| (key.to_owned(), json!(first(key))));
    Value::Object(lists.into_iter().collect()).to_string()
}

/// What the footer says under a name, and whether it stands out.
fn footer(page: &Page, name: &str) -> (Value, Value) {
    let entry = format!(
        "(() => {{ const e = [...document.querySelectorAll('#figures div')].find((d) => d.firstChild.textContent === '{name}'); \
         return [Number(e.lastChild.textContent), e.classList.contains('is-bad')]; }})()"
    );
    let found = page.value(&entry);
    (found[0].clone(), found[1].clone())
}

#[test]
fn the_footer_counts_the_faults_of_a_horse_with_eleven_landmarks() {
    let Some((browser, pair)) = browser().zip(horse_wolf()) else {
        return;
    };
    let place = Workplace::new();
    let all = fs::read_to_string(pair.join("landmarks.json")).unwrap();
    place.write("eleven.json", &eleven(&all));
    place.write("short.toml", "[[stages]]\nn_iterations = 90\n");
    for name in ["source.obj", "target.obj"] {
        place.write(name, &fs::read_to_string(pair.join(name)).unwrap());
    }
    let arguments = "source.obj target.obj --landmarks eleven.json --config short.toml";
    let arguments: Vec<&str> = arguments.split(' ').collect();
    let server = Server::start(&place.path(""), &arguments);
    let page = Page::open(&browser, &server.url, [1280, 800]);
    page.wait("studio.views.result.shape && studio.state.can.drape");
    page.press("#drape");
    page.wait("studio.state.run.status === 'finished' && studio.figures.iteration === studio.state.run.iteration");

    // The judge of the command line finds the same in the result.
    fs::write(place.path("result.obj"), download(&server, "result")).unwrap();
    let judged = place.drape("metrics source.obj result.obj target.obj --json");
    let judged = judged.well().json();
    for (name, figure) in [
        ("crossing", "self_intersections_new"),
        ("flipped", "opposed_faces"),
        ("folds", "folds"),
    ] {
        let (n, is_bad) = footer(&page, name);
        let expected = judged["figures"][figure].as_f64().expect("a figure");
        assert_eq!(n.as_f64(), Some(expected), "{name}: {judged:#}");
        assert_eq!(is_bad, json!(expected > 0.0), "{name}");
    }
    assert_ne!(
        footer(&page, "crossing").0,
        json!(0),
        "nothing crosses: other landmarks are needed"
    );
}
