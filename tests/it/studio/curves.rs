//! Curves and weights of landmarks: drawn, listed, undone, draped, and the same for `drape replay` and `drape transfer`.

use std::fs;

use serde_json::{json, Value};

use super::browser::{browser, Page};
use super::page::{find, probed, Place};
use super::server::{Server, SHORT};
use super::wire::{download, replays_to, Wire};
use crate::support::Workplace;

/// A place of the curve that is drawn: on the front of a ball, whose views are both in frames of their boxes.
fn place(shape: &str, [x, y]: [f64; 2]) -> Value {
    json!({ "edit": {
        "do": "draw", "shape": shape,
        "ray": { "origin": [x, y, 3.0], "direction": [0.0, 0.0, -1.0], "spread": 0.001 },
    } })
}

#[test]
fn a_session_with_a_curve_and_weights_is_replayed_to_the_bit() {
    let folder = Workplace::new();
    let server = Server::start(&folder.path(""), &SHORT);
    let mut wire = Wire::own(&server);
    for x in [-0.25, -0.1, 0.05, 0.2] {
        wire.ask(place("source", [x, 0.15]));
        wire.ask(place("target", [x, 0.1]));
    }
    // Nothing of it is a landmark before it is ended.
    let drawn = wire.state(|s| s["drawing"]["target"].as_array().map(Vec::len) == Some(4));
    assert_eq!(drawn["curves"], json!([]));
    let id = wire.ask(json!({ "edit": { "do": "end_curve" } }))["value"]["landmark"].clone();
    wire.ask(json!({ "edit": { "do": "rename", "landmark": id, "name": "brow" } }));
    let first = drawn["landmarks"][0]["id"].clone();
    wire.ask(json!({ "edit": { "do": "weight", "landmark": first, "weight": 0.4 } }));
    wire.ask(json!({ "edit": { "do": "weight", "landmark": id, "weight": 2.5 } }));
    let state = wire.state(|s| s["curves"][0]["weight"] == json!(2.5));
    assert_eq!(
        (&state["curves"][0]["name"], &state["drawing"]),
        (&json!("brow"), &Value::Null)
    );
    assert_eq!(state["landmarks"][0]["weight"], json!(0.4));
    let too_heavy = json!({ "edit": { "do": "weight", "landmark": id, "weight": 1e9 } });
    assert!(wire.ask(too_heavy)["error"].is_string());

    wire.ask(json!({ "command": "drape" }));
    wire.state(|s| s["run"]["status"] == "finished");
    let result = download(&server, "result");
    replays_to(&folder, &server, &result);
    fs::write(
        folder.path("landmarks.json"),
        download(&server, "landmarks"),
    )
    .unwrap();
    folder.transfer("").well();
    assert!(
        folder.read("out.obj").as_bytes() == result,
        "the command line came to another result"
    );

    // The whole curve is one edit, and one to delete.
    wire.ask(json!({ "edit": { "do": "delete", "landmark": id } }));
    wire.state(|s| s["curves"] == json!([]));
    wire.ask(json!({ "edit": { "do": "undo" } }));
    wire.state(|s| s["curves"][0]["weight"] == json!(2.5));
    // A line on one shape alone is refused and stays to be ended.
    wire.ask(place("source", [0.1, -0.1]));
    let refused = wire.ask(json!({ "edit": { "do": "end_curve" } }));
    assert!(
        refused["error"]
            .as_str()
            .is_some_and(|e| e.contains("places on the")),
        "{refused}"
    );
    wire.ask(json!({ "edit": { "do": "cancel_curve" } }));
    wire.state(|s| s["drawing"].is_null());
}

/// Clicks along the curve on both shapes, in the mode that C begins.
fn draw(page: &Page) {
    let along = [-0.2, -0.05, 0.1, 0.22];
    // A ball, and a ball of four, three and two and a half: views have the longest side as 1.
    let on_source = |x: f64| [x, 0.1, (0.24 - x * x).sqrt()];
    let on_target = |x: f64| {
        let z = 0.3125 * (1.0 - (x / 0.5).powi(2) - (0.1f64 / 0.375).powi(2)).sqrt();
        [x, 0.1, z]
    };
    let places: [(&str, [Place; 4]); 2] = [
        ("source", along.map(on_source)),
        ("target", along.map(on_target)),
    ];
    page.key("c", 67, 0);
    page.wait("studio.curves.isOn");
    for (side, places) in places {
        for (k, place) in places.into_iter().enumerate() {
            page.click(find(page, side, place));
            page.wait(&format!(
                "studio.state.drawing?.{side}.length === {}",
                k + 1
            ));
        }
    }
}

#[test]
fn a_curve_is_drawn_with_the_pointer() {
    let Some(browser) = browser() else { return };
    let folder = Workplace::new();
    let server = Server::start(&folder.path(""), &SHORT);
    let page = Page::open(&browser, &server.url, [1280, 800]);
    page.wait("studio.views.result.shape && studio.state.can.export");
    draw(&page);
    page.key("Escape", 27, 0);
    page.wait(
        "!studio.curves.isOn && studio.state.drawing === null && studio.state.curves.length === 0",
    );
    draw(&page);
    page.key("Enter", 13, 0);
    page.wait("!studio.curves.isOn && studio.state.curves.length === 1");
    assert_eq!(page.value("studio.state.landmarks.length"), json!(6));
    probed(&page);
    for side in ["source", "target", "result"] {
        let line = format!("document.querySelector('#view-{side} .curves .line').getAttribute('points').split(' ').length");
        assert!(
            page.value(&line).as_u64() > Some(8),
            "no line on the {side}"
        );
    }
    page.value("(() => { const weight = document.querySelector('#curves .weight'); weight.value = '0.5'; weight.dispatchEvent(new Event('change')); return true; })()");
    page.wait("studio.state.curves[0].weight === 0.5");
    page.press("#undo");
    page.wait("studio.state.curves[0].weight === 1");
    page.press("#curves button");
    page.wait("studio.state.curves.length === 0 && document.getElementById('curves').hidden");
    page.press("#undo");
    page.wait("studio.state.curves.length === 1");
    page.press("#drape");
    page.wait("studio.state.run.status === 'finished'");
}
