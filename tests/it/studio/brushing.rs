//! Brushes on the result: shown, undone, kept over a restart, and the same from the command line.

use std::fs;

use mesh_core::Positions;
use serde_json::{json, Value};

use super::browser::{browser, Page};
use super::page::{middle, shown};
use super::server::{Server, SHORT};
use super::wire::{download, replays_to, Wire};
use crate::support::Workplace;

/// A dab on the front of the result.
fn dab(brush: &str, [x, y]: [f64; 2], done: bool) -> Value {
    json!({ "edit": {
        "do": "brush", "brush": brush, "strength": 0.8, "radius": 0.15, "done": done,
        "ray": { "origin": [x, y, 3.0], "direction": [0.0, 0.0, -1.0], "spread": 0.001 },
    } })
}

/// A whole stroke, upwards.
fn stroke(wire: &mut Wire, brush: &str) {
    for (k, y) in [-0.05, 0.0, 0.06].into_iter().enumerate() {
        let answer = wire.ask(dab(brush, [0.1, y], k == 2));
        assert!(answer["error"].is_null(), "{answer}");
    }
}

fn exported(server: &Server, place: &Workplace, name: &str) -> Positions {
    fs::write(place.path(name), download(server, "result")).expect("it can be read and written");
    let soup = mesh_core::io::read_soup(place.path(name)).expect("it can be read and written");
    soup.positions.into_iter().collect()
}

fn farthest(a: &Positions, b: &Positions) -> f64 {
    let apart = a.iter().zip(b).map(|(p, q)| (p - q).norm());
    apart.fold(0.0, f64::max)
}

#[test]
fn a_brushed_result_replays_to_the_same_bits() {
    let place = Workplace::new();
    let server = Server::start(&place.path(""), &SHORT);
    let mut wire = Wire::own(&server);
    // There is nothing to brush before a drape.
    assert!(wire.ask(dab("relax", [0.0, 0.0], true))["error"].is_string());
    wire.ask(json!({ "command": "drape" }));
    wire.state(|s| s["run"]["status"] == "finished");
    let plain = exported(&server, &place, "plain.obj");

    stroke(&mut wire, "slide");
    let slid = exported(&server, &place, "slid.obj");
    assert!(farthest(&plain, &slid) > 0.1, "{}", farthest(&plain, &slid));
    stroke(&mut wire, "relax");
    let relaxed = exported(&server, &place, "relaxed.obj");
    assert!(farthest(&slid, &relaxed) > 1e-3);
    wire.ask(json!({ "edit": { "do": "undo" } }));
    assert!(farthest(&slid, &exported(&server, &place, "undone.obj")) < 1e-6);
    wire.ask(json!({ "edit": { "do": "redo" } }));
    assert!(farthest(&relaxed, &exported(&server, &place, "redone.obj")) < 1e-6);

    // It goes on from there, and is brushed again; a killed server forgets nothing of it.
    wire.ask(json!({ "command": "extend" }));
    wire.state(|s| s["run"]["status"] == "finished" && s["run"]["iteration"] == 16);
    stroke(&mut wire, "pull");
    let pulled = exported(&server, &place, "pulled.obj");
    server.kill();
    let server = Server::start(&place.path(""), &[]);
    let mut wire = Wire::own(&server);
    wire.state(|s| s["run"]["status"] == "finished" && s["strokes"] == 3);
    assert!(farthest(&pulled, &exported(&server, &place, "again.obj")) < 1e-12);
    for _ in 0..2 {
        wire.ask(json!({ "edit": { "do": "undo" } }));
    }
    stroke(&mut wire, "slide");
    let result = download(&server, "result");
    replays_to(&place, &server, &result);
    // What no brush has is refused.
    let mut wild = dab("pull", [0.0, 0.0], true);
    wild["edit"]["radius"] = json!(-1.0);
    assert!(wire.ask(wild)["error"].is_string());
    // The strokes of a drape that is left are no steps to undo: the step before them is that landmarks were opened.
    wire.ask(json!({ "command": "reset" }));
    let state = wire.state(|s| s["run"]["status"] == "none");
    assert_eq!(state["strokes"], json!(0));
    wire.ask(json!({ "edit": { "do": "undo" } }));
    wire.state(|s| s["landmarks"] == json!([]));
}

/// A request that must be taken.
fn take(wire: &mut Wire, request: Value) -> Value {
    let answer = wire.ask(request);
    assert!(answer["error"].is_null(), "{answer}");
    answer["value"].clone()
}

/// Paints a place on the front of the source.
fn paint(x: f64, layer: &str, weight: f64) -> Value {
    json!({ "edit": {
        "do": "paint", "shape": "source", "layer": layer, "weight": weight, "strength": 1.0, "radius": 0.15, "done": true,
        "ray": { "origin": [x, -0.1, 3.0], "direction": [0.0, 0.0, -1.0], "spread": 0.001 },
    } })
}

#[test]
fn brushes_weights_and_curves_of_one_session_replay_to_the_same_bits() {
    let place = Workplace::new();
    let server = Server::start(&place.path(""), &SHORT);
    let mut wire = Wire::own(&server);
    for (shape, x) in ["source", "target"]
        .into_iter()
        .flat_map(|shape| [-0.25, -0.05, 0.2].map(|x| (shape, x)))
    {
        let ray =
            json!({ "origin": [x, 0.12, 3.0], "direction": [0.0, 0.0, -1.0], "spread": 0.001 });
        take(
            &mut wire,
            json!({ "edit": { "do": "draw", "shape": shape, "ray": ray } }),
        );
    }
    let curve = take(&mut wire, json!({ "edit": { "do": "end_curve" } }))["landmark"].clone();
    take(
        &mut wire,
        json!({ "edit": { "do": "weight", "landmark": curve, "weight": 1.7 } }),
    );
    take(&mut wire, paint(0.25, "weights", 0.2));
    take(&mut wire, paint(-0.25, "rigid", 1.0));
    take(&mut wire, json!({ "command": "drape" }));
    wire.state(|s| s["run"]["status"] == "finished");
    let draped = download(&server, "result");
    for brush in ["slide", "relax", "pull"] {
        stroke(&mut wire, brush);
    }
    // The drape goes on from what was brushed, and is brushed again.
    take(&mut wire, json!({ "command": "extend" }));
    wire.state(|s| s["run"]["status"] == "finished" && s["run"]["iteration"] == 16);
    stroke(&mut wire, "slide");
    let result = download(&server, "result");
    assert!(result != draped, "the brushes did nothing");
    replays_to(&place, &server, &result);
}

#[test]
fn the_result_is_brushed_with_the_pointer() {
    let Some(browser) = browser() else { return };
    let place = Workplace::new();
    let server = Server::start(&place.path(""), &SHORT);
    let page = Page::open(&browser, &server.url, [1280, 800]);
    page.wait("studio.views.result.shape && studio.state.can.drape");
    page.press("#drape");
    page.wait("studio.state.run.status === 'finished' && studio.state.can.brush && studio.shown.kind === 1");
    page.wait("studio.shown.iteration === studio.state.run.iteration");
    let before = shown(&page);
    let [x, y] = middle(&page, "result");
    for (brush, n) in [("slide", 1), ("relax", 2), ("pull", 3)] {
        page.press(&format!("#sculpt-{brush}"));
        page.wait(&format!("studio.sculpt.brush === '{brush}'"));
        let look = page.value("[studio.views.result.camera.yaw, studio.state.landmarks.length]");
        page.drag([x - 30.0, y + 10.0], [x + 40.0, y - 20.0]);
        page.wait(&format!(
            "studio.state.strokes === {n} && studio.shown.kind === 1"
        ));
        let after = page.value("[studio.views.result.camera.yaw, studio.state.landmarks.length]");
        assert_eq!(after, look, "the camera turned, or a landmark was marked");
    }
    assert_ne!(shown(&page), before);
    for n in [2, 1, 0] {
        page.press("#undo");
        page.wait(&format!("studio.state.strokes === {n}"));
    }
    let apart =
        format!("Math.max(...studio.shown.positions.map((c, k) => Math.abs(c - {before}[k])))");
    page.wait(&format!("{apart} < 1e-5"));
    // The keyboard takes the brushes in hand, too, and puts them down.
    page.key("Escape", 27, 0);
    page.wait("studio.sculpt.brush === null");
    page.key("g", 71, 0);
    page.wait(
        "studio.sculpt.brush === 'relax' && !document.getElementById('sculpt-controls').hidden",
    );
    page.key("b", 66, 0);
    page.wait("studio.sculpt.brush === null && studio.brush.isOn");
}
