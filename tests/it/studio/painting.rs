//! Weights painted on the surface: undone, mirrored, exported, and the same for the command line.

use std::fs;

use serde_json::{json, Value};

use super::browser::{browser, Page};
use super::page::middle;
use super::server::{Server, SHORT};
use super::wire::{download, replays_to, Wire};
use crate::support::Workplace;

/// A dab on the front of the source.
fn dab(x: f64, done: bool) -> Value {
    json!({ "edit": {
        "do": "paint", "shape": "source", "weight": 0.0, "strength": 0.8, "radius": 0.2, "done": done,
        "ray": { "origin": [x, 0.05, 3.0], "direction": [0.0, 0.0, -1.0], "spread": 0.001 },
    } })
}

#[test]
fn painted_weights_are_those_of_the_command_line() {
    let place = Workplace::new();
    let server = Server::start(&place.path(""), &SHORT);
    let mut wire = Wire::own(&server);
    let changed = wire.ask(dab(0.2, false));
    assert!(
        changed["value"].as_array().is_some_and(|c| c.len() > 3),
        "{changed}"
    );
    wire.ask(dab(0.25, true));
    let weights =
        |wire: &mut Wire| wire.ask(json!({ "query": { "do": "weights" } }))["value"].clone();
    let painted = weights(&mut wire);
    assert!(painted
        .as_array()
        .is_some_and(|w| w.iter().any(|x| x.as_f64() < Some(0.5))));

    // The whole stroke is one edit.
    wire.ask(json!({ "edit": { "do": "undo" } }));
    assert!(weights(&mut wire).is_null());
    wire.ask(json!({ "edit": { "do": "redo" } }));
    assert_eq!(weights(&mut wire), painted);
    // Mirrored strokes paint both sides.
    wire.ask(json!({ "edit": { "do": "mirror", "axes": [0, 0] } }));
    let one = wire.ask(dab(-0.3, true))["value"].as_array().map(Vec::len);
    wire.ask(json!({ "edit": { "do": "undo" } }));
    wire.ask(json!({ "edit": { "do": "mirror", "axes": null } }));
    let other = wire.ask(dab(-0.3, true))["value"].as_array().map(Vec::len);
    assert!(one > other, "{one:?} {other:?}");
    wire.ask(json!({ "edit": { "do": "undo" } }));
    assert_eq!(weights(&mut wire), painted);

    wire.ask(json!({ "command": "drape" }));
    wire.state(|s| s["run"]["status"] == "finished");
    let result = download(&server, "result");
    fs::write(place.path("weights.txt"), download(&server, "weights")).unwrap();
    place.transfer("--weights weights.txt").well();
    assert!(
        place.read("out.obj").as_bytes() == result,
        "the command line came to another result"
    );
    replays_to(&place, &server, &result);
    // Without them the result is another one.
    place.transfer("").well();
    assert!(place.read("out.obj").as_bytes() != result);
    // What a brush cannot do is refused.
    let mut wild = dab(0.0, true);
    wild["edit"]["strength"] = json!(7.0);
    assert!(wire.ask(wild)["error"].is_string());
}

#[test]
fn what_is_painted_rigid_moves_as_one_body_here_and_from_the_command_line() {
    let place = Workplace::new();
    let server = Server::start(&place.path(""), &SHORT);
    let mut wire = Wire::own(&server);
    let rigid = |wire: &mut Wire| wire.ask(json!({ "query": { "do": "rigid" } }))["value"].clone();
    let paint = |x: f64, weight: f64| {
        let mut dab = dab(x, true);
        dab["edit"]["layer"] = json!("rigid");
        dab["edit"]["weight"] = json!(weight);
        dab
    };
    assert!(rigid(&mut wire).is_null());
    wire.ask(json!({ "edit": { "do": "mirror", "axes": [0, 0] } }));
    wire.ask(paint(0.25, 1.0));
    wire.ask(json!({ "edit": { "do": "mirror", "axes": null } }));
    let both = rigid(&mut wire);
    // One side is not rigid any more; undo brings it back.
    wire.ask(paint(-0.25, 0.0));
    let one = rigid(&mut wire);
    let n = |of: &Value| {
        of.as_array()
            .map(|all| all.iter().filter(|r| **r == json!(1.0)).count())
    };
    assert!(n(&one) > Some(3) && n(&both) > n(&one), "{both} {one}");
    wire.ask(json!({ "edit": { "do": "undo" } }));
    assert_eq!(rigid(&mut wire), both);
    wire.ask(json!({ "edit": { "do": "redo" } }));
    // Weights are another layer.
    wire.ask(dab(0.0, true));
    assert_eq!(rigid(&mut wire), one);

    wire.ask(json!({ "command": "drape" }));
    wire.state(|s| s["run"]["status"] == "finished");
    let result = download(&server, "result");
    for what in ["weights", "rigid"] {
        fs::write(place.path(&format!("{what}.txt")), download(&server, what)).unwrap();
    }
    place
        .transfer("--weights weights.txt --rigid rigid.txt")
        .well();
    assert!(
        place.read("out.obj").as_bytes() == result,
        "the command line came to another result"
    );
    replays_to(&place, &server, &result);
    wire.ask(json!({ "edit": { "do": "clear_rigid" } }));
    assert!(rigid(&mut wire).is_null());
}

#[test]
fn weights_are_painted_with_the_pointer() {
    let Some(browser) = browser() else { return };
    let place = Workplace::new();
    let server = Server::start(&place.path(""), &SHORT);
    let page = Page::open(&browser, &server.url, [1280, 800]);
    page.wait("studio.views.result.shape && studio.state.can.export");
    page.key("b", 66, 0);
    page.wait("studio.brush.isOn && studio.brush.weights");
    let [x, y] = middle(&page, "source");
    let yaw = page.value("studio.views.source.camera.yaw");
    page.drag([x - 40.0, y + 20.0], [x + 40.0, y + 20.0]);
    page.wait("studio.state.parts.weights && Math.min(...studio.brush.weights) < 0.6");
    assert_eq!(page.value("studio.views.source.camera.yaw"), yaw);
    assert_eq!(page.value("studio.state.landmarks.length"), json!(6));
    page.press("#undo");
    page.wait("!studio.state.parts.weights && Math.min(...studio.brush.weights) === 1");
    page.value("(() => { const s = document.getElementById('brush-weight'); s.value = '1 rigid'; s.dispatchEvent(new Event('change')); })()");
    page.wait("Math.max(...studio.brush.weights) === 0");
    page.drag([x - 40.0, y + 20.0], [x + 40.0, y + 20.0]);
    page.wait("studio.state.painted_rigid && Math.max(...studio.brush.weights) === 1");
    page.press("#clear-rigid");
    page.wait("!studio.state.painted_rigid && Math.max(...studio.brush.weights) === 0");
    page.key("b", 66, 0);
    page.wait("!studio.brush.isOn && studio.views.source.shape.values === null");
}
