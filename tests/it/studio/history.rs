//! From one result to the next, and from one scan to the next: nothing is lost.

use std::fs;

use mesh_core::{io, shapes, Point3};
use serde_json::{json, Value};

use super::browser::{browser, wait_for, Page};
use super::page::middle;
use super::server::{Server, SHORT};
use super::wire::{download, Wire};
use crate::support::Workplace;

/// Another scan: a ball of another shape at another place.
fn other_scan(place: &Workplace) {
    let mut soup = shapes::icosphere(3);
    for p in &mut soup.positions {
        *p = Point3::new(2.0 * p.x, 2.6 * p.y + 1.0, 2.2 * p.z);
    }
    io::write_soup(place.path("other.ply"), &soup).expect("the scan is written");
}

#[test]
fn a_result_is_kept_compared_and_brought_back() {
    let Some(browser) = browser() else { return };
    let place = Workplace::new();
    let server = Server::start(&place.path(""), &SHORT);
    let page = Page::open(&browser, &server.url, [1280, 800]);
    page.wait("studio.views.result.shape && studio.state.can.drape");
    page.press("#drape");
    page.wait("studio.state.run.status === 'finished'");
    let first = download(&server, "result");

    // Starting again asks, and puts the finished result into the strip.
    page.value("studio.edit('delete', { landmark: studio.state.landmarks[5].id }), true");
    page.wait("studio.state.landmarks.length === 5");
    page.press("#drape");
    page.press("#discard-dialog [value=discard]");
    page.wait("studio.state.kept.length === 1 && studio.state.run.status === 'finished' && studio.state.run.number === 2");
    page.wait("studio.state.kept[0].figures?.q > 0 && document.querySelector('#kept img').naturalWidth > 0");
    assert_ne!(download(&server, "result"), first);

    // Before and after, and the difference between them.
    page.press("#kept .kept");
    page.wait("studio.strip.shape && studio.strip.share === 0.5");
    let sides = |page: &Page| {
        page.value("[0.02, 0.98].map((u) => { const { gl } = studio.painter.renderer; const out = new Uint8Array(4); const b = studio.views.result.box; \
         gl.readPixels(Math.round(b.left + u * b.width), gl.drawingBufferHeight >> 1, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, out); return [...out]; })")
    };
    page.settle();
    assert_eq!(sides(&page).as_array().map(Vec::len), Some(2));
    page.value("studio.stage.setHeat('difference'), true");
    page.wait(
        "studio.views.result.shape.values && Math.max(...studio.views.result.shape.values) > 0",
    );

    // Going back keeps the second one, and brings the landmarks of the first.
    page.press("#bring-back");
    page.wait("studio.state.run.number === 3 && studio.state.run.status === 'finished' && studio.state.landmarks.length === 6");
    page.wait("studio.state.kept.length === 2");
    assert!(
        download(&server, "result") == first,
        "another result came back"
    );
    // What came back is done again by the command line, to the same bytes.
    fs::write(place.path("exported.json"), download(&server, "session")).unwrap();
    place.drape("replay exported.json -o replayed.obj").well();
    assert!(place.read("replayed.obj").as_bytes() == first);
    // One is taken out of the strip; undo brings it back.
    page.press("#kept .remove");
    page.wait("studio.state.kept.length === 1");
    page.press("#undo");
    page.wait("studio.state.kept.length === 2");
}

#[test]
fn the_next_scan_has_the_same_landmarks_waiting() {
    let Some(browser) = browser() else { return };
    let place = Workplace::new();
    other_scan(&place);
    let server = Server::start(&place.path(""), &SHORT);
    let page = Page::open(&browser, &server.url, [1280, 800]);
    page.wait("studio.views.result.shape && studio.state.can.drape");
    page.press("#drape");
    page.wait("studio.state.run.status === 'finished'");
    page.value("studio.edit('save_settings', { name: 'mine' }), true");
    page.wait("[...document.getElementById('preset').options].some((o) => o.value === 'mine')");

    page.drop_files(middle(&page, "target"), &[place.path("other.ply")]);
    page.wait("studio.state.target.name === 'other.ply' && studio.state.landmarks.length === 6");
    page.wait("studio.state.landmarks.every((l) => l.source && !l.target) && studio.chosen === studio.state.landmarks[0].id");
    page.wait("studio.views.target.shape && studio.state.kept.length === 1 && studio.state.saved.names[0] === 'mine'");
    let hint = page.value("document.getElementById('hint').textContent");
    assert!(
        hint.as_str().is_some_and(|t| t.contains("6 wait")),
        "{hint}"
    );
    // They take their places in order.
    for k in 0..2 {
        let [x, y] = middle(&page, "target");
        page.click([x + 30.0 * f64::from(k), y]);
        page.wait(&format!(
            "studio.state.landmarks[{k}].target && studio.state.landmarks[{k}].number === {k}"
        ));
    }
    page.wait("studio.chosen === studio.state.landmarks[2].id");

    // The first scan's session is as it was left.
    page.press("#scans");
    page.press("#scans-list button");
    page.wait(
        "studio.state.target.name === 'target.ply' && studio.state.run.status === 'finished'",
    );
    page.wait("studio.state.landmarks.every((l) => l.source && l.target)");
    page.press("#scans");
    page.press("#scans-list button");
    page.wait("studio.state.target.name === 'other.ply' && studio.state.landmarks[1].target && !studio.state.landmarks[2].target");
}

#[test]
fn targets_wait_in_a_queue_and_a_session_is_dropped() {
    let Some(browser) = browser() else { return };
    let place = Workplace::new();
    other_scan(&place);
    fs::copy(place.path("target.ply"), place.path("third.ply")).unwrap();
    let server = Server::start(&place.path(""), &["source.obj", "target.ply"]);
    let page = Page::open(&browser, &server.url, [1280, 800]);
    page.wait("studio.views.result.shape");
    let at = middle(&page, "target");
    page.drop_files(at, &[place.path("other.ply"), place.path("third.ply")]);
    page.wait(
        "studio.state.target.name === 'other.ply' && studio.state.scans.queue[0] === 'third.ply'",
    );
    page.press("#scans");
    page.press("#scans-list button");
    page.wait("studio.state.target.name === 'third.ply' && studio.state.scans.queue.length === 0");

    // A session from elsewhere.
    let other = Workplace::new();
    let elsewhere = Server::start(&other.path(""), &SHORT[..4]);
    fs::write(other.path("theirs.json"), download(&elsewhere, "session")).unwrap();
    page.drop_files(at, &[other.path("theirs.json")]);
    page.wait("studio.state.target.name === 'target.ply' && studio.state.landmarks.length === 6");
    other.write("broken.json", "{\"check_sum\": 1, \"document\": 2}");
    page.drop_files(at, &[other.path("broken.json")]);
    page.wait("!document.getElementById('toast').hidden");
    assert_eq!(page.value("studio.state.landmarks.length"), json!(6));
}

#[test]
fn what_cannot_be_kept_or_opened_is_refused() {
    let place = Workplace::new();
    let server = Server::start(&place.path(""), &SHORT);
    let mut wire = Wire::own(&server);
    let mut refused = |request: Value| {
        let answer = wire.ask(request.clone());
        assert!(answer["error"].is_string(), "{request}: {answer}");
    };
    refused(json!({ "kept": { "do": "keep" } }));
    refused(json!({ "kept": { "do": "bring_back", "result": 1 } }));
    refused(json!({ "edit": { "do": "dismiss", "result": 1 } }));
    refused(json!({ "edit": { "do": "save_settings", "name": " " } }));
    refused(json!({ "edit": { "do": "save_settings", "name": "standard" } }));
    for what in ["open/next/x", "open/aside/..%2fsession", "open/session/x"] {
        let request = format!(
            "POST {}{what} HTTP/1.0\r\nHost: {host}\r\nOrigin: http://{host}\r\nContent-Length: 0\r\n\r\n",
            server.path(),
            host = server.host()
        );
        let answer = super::wire::raw(&server, &request);
        assert!(answer.starts_with("HTTP/1.0 422"), "{what}: {answer}");
    }
    // A running drape is brought to rest before it is kept.
    place.write("long.toml", "[[stages]]\nn_iterations = 100000\n");
    let toml = "preset = \"standard\"\n[[stages]]\nn_iterations = 100000\n";
    wire.ask(json!({ "edit": { "do": "settings", "toml": toml } }));
    wire.ask(json!({ "command": "drape" }));
    wire.state(|s| s["run"]["status"] == "running");
    wait_for("an iteration", || {
        let answer = wire.ask(json!({ "kept": { "do": "keep" } }));
        answer["error"].is_null().then_some(())
    });
    let state = wire.state(|s| s["kept"].as_array().is_some_and(|k| k.len() == 1));
    assert!(state["kept"][0]["iteration"].as_u64() > Some(0));
}
