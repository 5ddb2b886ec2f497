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

/// Draws places one after the other.
fn along(wire: &mut Wire, shape: &str, places: &[[f64; 2]]) {
    for &at in places {
        let answer = wire.ask(place(shape, at));
        assert!(answer["value"].is_array(), "{answer}");
    }
}

fn ask(wire: &mut Wire, edit: Value) -> Value {
    let answer = wire.ask(json!({ "edit": edit }));
    assert!(answer["error"].is_null(), "{answer}");
    answer["value"].clone()
}

/// How many places are drawn on source and target.
fn drawn(wire: &mut Wire, source: usize, target: usize) -> Value {
    let n = |s: &Value, shape: &str| s["drawing"][shape].as_array().map(Vec::len);
    wire.state(|s| n(s, "source") == Some(source) && n(s, "target") == Some(target))
}

#[test]
fn a_curve_is_drawn_on_both_sides_and_taken_back_place_by_place() {
    let folder = Workplace::new();
    let server = Server::start(&folder.path(""), &SHORT);
    let mut wire = Wire::own(&server);
    ask(&mut wire, json!({ "do": "mirror", "axes": [0, 0] }));
    let line = [[0.1, 0.15], [0.2, 0.12], [0.28, 0.05]];
    along(&mut wire, "source", &line);
    along(&mut wire, "target", &line[..2]);
    // What is drawn is seen on the other half, too, as far as it is.
    let state = drawn(&mut wire, 3, 2);
    let twin = &state["drawing"]["twin"];
    let x = |side: &Value, k: usize| side["target"][k][0].as_f64().expect("a place");
    assert!(
        (x(&state["drawing"], 1) + x(twin, 1)).abs() < 0.01,
        "{twin}"
    );
    assert_eq!(twin["source"].as_array().map(Vec::len), Some(3));

    // Undo takes back the last place alone, redo draws it again, and a new place forgets it.
    let n_landmarks = state["landmarks"].as_array().map(Vec::len);
    for (what, source, target) in [
        ("undo", 3, 1),
        ("undo", 3, 0),
        ("undo", 2, 0),
        ("redo", 3, 0),
    ] {
        ask(&mut wire, json!({ "do": what }));
        let state = drawn(&mut wire, source, target);
        assert_eq!(state["landmarks"].as_array().map(Vec::len), n_landmarks);
    }
    along(&mut wire, "target", &line);
    assert_eq!(drawn(&mut wire, 3, 3)["can"]["redo"], json!(false));
    ask(&mut wire, json!({ "do": "end_curve" }));
    let both = wire.state(|s| s["curves"].as_array().map(Vec::len) == Some(2));
    assert_eq!(both["drawing"], Value::Null);
    // Both are one edit; one that runs across the middle has no other half.
    ask(&mut wire, json!({ "do": "undo" }));
    wire.state(|s| s["curves"] == json!([]));
    let across = [[-0.2, 0.1], [0.0, 0.1], [0.2, 0.1]];
    along(&mut wire, "source", &across);
    along(&mut wire, "target", &across);
    ask(&mut wire, json!({ "do": "end_curve" }));
    wire.state(|s| s["curves"].as_array().map(Vec::len) == Some(1));
}

#[test]
fn curves_wait_for_their_lines_on_the_next_scan() {
    let Some(browser) = browser() else { return };
    let folder = Workplace::new();
    let mut other = mesh_core::io::read_soup(folder.path("target.ply")).unwrap();
    other.positions.iter_mut().for_each(|p| p.y *= 1.01);
    mesh_core::io::write_soup(folder.path("other.ply"), &other).unwrap();
    let server = Server::start(&folder.path(""), &SHORT);
    let mut wire = Wire::own(&server);
    ask(&mut wire, json!({ "do": "mirror", "axes": [0, 0] }));
    let line = [[0.1, 0.15], [0.2, 0.12], [0.28, 0.05]];
    along(&mut wire, "source", &line);
    along(&mut wire, "target", &line);
    let id = ask(&mut wire, json!({ "do": "end_curve" }))["landmark"].clone();
    ask(
        &mut wire,
        json!({ "do": "rename", "landmark": id, "name": "left lid" }),
    );

    let page = Page::open(&browser, &server.url, [1280, 800]);
    page.wait("studio.views.result.shape && studio.state.curves.length === 2");
    page.drop_files(
        super::page::middle(&page, "target"),
        &[folder.path("other.ply")],
    );
    page.wait("studio.state.target.name === 'other.ply' && studio.views.target.shape");
    page.wait("studio.state.curves.length === 2 && studio.state.curves.every((c) => c.source.length > 1 && c.target.length === 0 && c.number === null)");
    // A click goes to a landmark that waits; C takes the curve up.
    page.key("c", 67, 0);
    page.wait("studio.curves.isOn && studio.state.drawing?.source.length === 3");
    along(&mut wire, "target", &line[..2]);
    page.wait("studio.state.drawing.target.length === 2");
    // In the page, too, undo takes one place back.
    page.key("z", 90, 2);
    page.wait("studio.state.drawing.target.length === 1");
    along(&mut wire, "target", &line[1..]);
    page.wait("studio.state.drawing.target.length === 3");
    page.key("Enter", 13, 0);
    // The other half had its line waiting: it is complete, and none is added.
    page.wait("!studio.curves.isOn && studio.state.curves.length === 2 && studio.state.curves.every((c) => c.target.length > 8)");
    let names = page.value("studio.state.curves.map((c) => c.name)");
    assert_eq!(names[0], json!("left lid"), "{names}");
    page.press("#undo");
    page.wait("studio.state.curves.length === 2 && studio.state.curves.every((c) => c.target.length === 0)");
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
        let line = format!("document.querySelector('#view-{side} .curves .line').getAttribute('d').split('L').length");
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

/// How many steps of the line are seen in a view, and how many are behind the shape.
fn steps(page: &Page, side: &str) -> [u64; 2] {
    ["line", "behind"].map(|layer| {
        let n = page.value(&format!(
            "document.querySelector('#view-{side} .curves .{layer}').getAttribute('d').split('L').length - 1"
        ));
        n.as_u64().expect("a number")
    })
}

#[test]
fn a_line_behind_the_shape_is_faint() {
    let Some(browser) = browser() else { return };
    let folder = Workplace::new();
    let mut cloud = mesh_core::shapes::icosphere(5);
    cloud.faces.clear();
    mesh_core::io::write_soup(folder.path("cloud.ply"), &cloud).unwrap();
    for target in ["target.ply", "cloud.ply"] {
        let server = Server::start(&folder.path(""), &["source.obj", target, "--fresh"]);
        let mut wire = Wire::own(&server);
        for (shape, x) in ["source", "target"]
            .into_iter()
            .flat_map(|shape| [-0.2, 0.0, 0.2].map(|x| (shape, x)))
        {
            // Beside the points of a cloud.
            let mut near = place(shape, [x, 0.1]);
            near["edit"]["ray"]["spread"] = json!(0.02);
            assert!(wire.ask(near)["value"].is_array());
        }
        ask(&mut wire, json!({ "do": "end_curve" }));
        let page = Page::open(&browser, &server.url, [1280, 800]);
        page.wait("studio.views.source.shape && studio.views.target.shape && studio.state.curves.length === 1");
        for (look, is_seen) in [("front", true), ("back", false)] {
            page.press(&format!("[data-look={look}]"));
            probed(&page);
            for side in ["source", "target"] {
                let [seen, behind] = steps(&page, side);
                let (more, fewer) = if is_seen {
                    (seen, behind)
                } else {
                    (behind, seen)
                };
                assert!(
                    more > 8 && fewer == 0,
                    "{target} {side} {look}: {seen} {behind}"
                );
            }
        }
    }
}
