//! A killed studio comes back to where it was, and a page that is loaded again to what it showed.

use std::fs;
use std::time::Instant;

use serde_json::{json, Value};

use super::browser::{browser, wait_for, Page};
use super::server::Server;
use super::wire::{download, Wire};
use crate::support::Workplace;

/// A small marked pair, and settings that take long enough to be killed in the middle.
fn long() -> (Workplace, Server) {
    let place = Workplace::new();
    place.write("long.toml", "[[stages]]\nn_iterations = 100000\n");
    let arguments = "source.obj target.ply --landmarks landmarks.json --config long.toml";
    let arguments: Vec<&str> = arguments.split(' ').collect();
    let server = Server::start(&place.path(""), &arguments);
    (place, server)
}

#[test]
fn a_killed_studio_loses_at_most_two_seconds() {
    let (place, server) = long();
    let mut wire = Wire::own(&server);
    wire.ask(json!({ "command": "drape" }));
    let progress = |wire: &mut Wire| loop {
        let message = wire.hear().expect("the studio tells how far it is");
        if message["type"] == "progress" {
            return message["iteration"].as_u64().expect("a number");
        }
    };
    // How far it was, every moment of the last seconds.
    let first = progress(&mut wire);
    let began = Instant::now();
    let mut seen = vec![(began, first)];
    while began.elapsed().as_secs_f64() < 4.0 {
        let iteration = progress(&mut wire);
        seen.push((Instant::now(), iteration));
    }
    server.kill();
    let killed = Instant::now();

    let server = Server::start(&place.path(""), &["source.obj", "target.ply"]);
    let mut wire = Wire::own(&server);
    let state = wire.state(|s| s["run"]["status"] == "paused");
    let iteration = state["run"]["iteration"].as_u64().expect("a number");
    let two_seconds_before = seen
        .iter()
        .filter(|(at, _)| killed.duration_since(*at).as_secs_f64() >= 2.0)
        .map(|(_, iteration)| *iteration)
        .next_back();
    let least = two_seconds_before.expect("it ran for more than two seconds");
    assert!(
        least > 0 && iteration >= least,
        "back at {iteration}; two seconds before the end it was at {least}"
    );
    assert_eq!(state["landmarks"].as_array().map(Vec::len), Some(6));
    // The curves are there from the start on.
    let curves = wire.ask(json!({ "query": { "do": "curves" } }));
    let curves = curves["value"].as_array().expect("curves");
    let loss = curves.iter().find(|c| c["name"] == "loss");
    let points = &loss.expect("a curve of the loss")["points"];
    assert_eq!(points[0][0], json!(0));
    let last = points.as_array().and_then(|p| p.last()).expect("points");
    assert_eq!(last[0], json!(iteration - 1));

    // It goes on, and what comes out can still be done again to the bit.
    wire.ask(json!({ "command": "step" }));
    let state = wire.state(|s| s["run"]["iteration"] == json!(iteration + 1));
    assert_eq!(state["run"]["status"], "paused");
    let exported = download(&server, "result");
    fs::write(place.path("exported.json"), download(&server, "session")).unwrap();
    place.drape("replay exported.json -o replayed.obj").well();
    assert!(place.read("replayed.obj").as_bytes() == exported);
}

#[test]
fn a_finished_drape_comes_back_as_finished() {
    let place = Workplace::new();
    place.write("short.toml", "[[stages]]\nn_iterations = 12\n");
    let arguments = "source.obj target.ply --landmarks landmarks.json --config short.toml";
    let arguments: Vec<&str> = arguments.split(' ').collect();
    let server = Server::start(&place.path(""), &arguments);
    let mut wire = Wire::own(&server);
    wire.ask(json!({ "command": "drape" }));
    wire.state(|s| s["run"]["status"] == "finished");
    let exported = download(&server, "result");
    // The session is written a moment later.
    wait_for("the session file", || {
        let text = fs::read_to_string(place.path("session.json")).ok()?;
        let session: Value = serde_json::from_str(&text).ok()?;
        (session["run"]["iteration"] == 12).then_some(())
    });
    server.kill();

    let server = Server::start(&place.path(""), &["source.obj", "target.ply"]);
    let mut wire = Wire::own(&server);
    let state = wire.state(|s| s["run"]["status"] != "starting");
    assert_eq!(state["run"]["status"], "finished");
    assert_eq!(state["run"]["iteration"], 12);
    assert!(download(&server, "result") == exported);
    // It can go on from there.
    wire.ask(json!({ "command": "extend" }));
    wire.state(|s| s["run"]["status"] == "finished" && s["run"]["iteration"] == 16);
}

#[test]
fn a_page_that_is_loaded_again_comes_back_to_the_running_drape() {
    let Some(browser) = browser() else { return };
    let (_place, server) = long();
    let page = Page::open(&browser, &server.url, [1280, 800]);
    page.wait("studio.views.result.shape");
    page.press("#drape");
    page.wait("studio.shown.iteration > 3");
    page.go(&server.url);
    page.wait("studio.shown.iteration > 6 && studio.chart.curves.get('loss').length > 3");
    assert_eq!(page.value("studio.state.landmarks.length"), json!(6));
    assert_eq!(page.value("studio.state.run.status"), json!("running"));

    // The connection breaks and comes back by itself.
    page.value("studio.link.socket.close(), true");
    page.wait("!document.getElementById('offline').hidden");
    page.wait("document.getElementById('offline').hidden");
    let seen = page.value("studio.shown.iteration");
    page.wait(&format!("studio.shown.iteration > {seen}"));
}

#[test]
fn files_are_opened_in_the_page_and_keys_are_listed() {
    let Some(browser) = browser() else { return };
    let place = Workplace::new();
    let server = Server::start(&place.path(""), &[]);
    let page = Page::open(&browser, &server.url, [1280, 800]);
    page.wait("studio.state");
    page.key("?", 191, 0);
    page.wait("document.getElementById('keys-dialog').open");
    page.value("document.getElementById('keys-dialog').close(), true");

    for (role, file) in [
        ("source", "source.obj"),
        ("target", "target.ply"),
        ("landmarks", "landmarks.json"),
    ] {
        page.press(&format!("#open-{role}"));
        page.choose_file(&place.path(file));
        match role {
            "landmarks" => page.wait("studio.state.landmarks.length === 6"),
            _ => page.wait(&format!("studio.state.{role}?.name === '{file}'")),
        }
    }
    page.wait("studio.views.result.shape && studio.figures.landmark_rms < 0.01");
    // The groups of the source are parts that can be free or rigid; that can be undone.
    page.value("(() => { const s = document.querySelector('#parts select'); s.value = 'free'; s.dispatchEvent(new Event('change')); return true; })()");
    page.wait("studio.state.parts.free.length === 1 && studio.views.source.shape.values");
    page.press("#undo");
    page.wait("studio.state.parts.free.length === 0");

    place.write("broken.obj", "v 0 0 0\nv 1 x 0\n");
    page.press("#open-source");
    page.choose_file(&place.path("broken.obj"));
    page.wait("!document.getElementById('toast').hidden");
    let said = page.value("document.getElementById('toast').textContent");
    assert!(
        said.as_str()
            .is_some_and(|text| text.contains("roken.obj:2")),
        "{said}"
    );
    assert_eq!(page.value("studio.state.source.name"), json!("source.obj"));
}
