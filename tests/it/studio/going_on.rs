//! What is done to a drape on its way and after its end, and that the command line comes to the same bits.

use std::fs;
use std::path::Path;

use serde_json::{json, Value};

use super::server::Server;
use super::wire::{download, Wire};
use crate::support::Workplace;

/// A studio on the standard files with some settings.
fn studio(place: &Workplace, settings: &str) -> (Server, Wire) {
    place.write("own.toml", settings);
    let arguments = "source.obj target.ply --landmarks landmarks.json --config own.toml --fresh";
    let arguments: Vec<&str> = arguments.split(' ').collect();
    let server = Server::start(Path::new(&place.path("")), &arguments);
    let wire = Wire::own(&server);
    (server, wire)
}

fn ask(wire: &mut Wire, request: Value) {
    let answer = wire.ask(request.clone());
    assert!(answer["error"].is_null(), "{request}: {answer}");
}

fn status(wire: &mut Wire, status: &str) -> Value {
    wire.state(|s| s["run"]["status"] == status)
}

/// What the studio exports is what `drape replay` makes of its session: the result and the map.
fn assert_replayed(place: &Workplace, server: &Server) {
    let session = download(server, "session");
    fs::write(place.path("exported.json"), session).expect("the session is written");
    place
        .drape("replay exported.json -o replayed.obj --warp replayed.drape")
        .well();
    let read = |name: &str| fs::read(place.path(name)).expect("the file is there");
    assert!(read("replayed.obj") == download(server, "result"));
    assert!(read("replayed.drape") == download(server, "warp"));
}

#[test]
fn the_result_and_the_map_are_those_of_the_command_line() {
    for settings in [
        "[[stages]]\nn_iterations = 12\n",
        "preset = \"network\"\n[[stages]]\nn_iterations = 4\n",
    ] {
        let place = Workplace::new();
        let (server, mut wire) = studio(&place, settings);
        ask(&mut wire, json!({ "command": "drape" }));
        status(&mut wire, "finished");
        place
            .drape("transfer source.obj target.ply --landmarks landmarks.json --config own.toml -o out.obj --warp out.drape")
            .well();
        let read = |name: &str| fs::read(place.path(name)).unwrap();
        assert!(read("out.obj") == download(&server, "result"), "{settings}");
        assert!(read("out.drape") == download(&server, "warp"), "{settings}");
        assert_replayed(&place, &server);
    }
}

#[test]
fn a_drape_goes_on_after_its_end() {
    let place = Workplace::new();
    let (server, mut wire) = studio(&place, "[[stages]]\nn_iterations = 12\n");
    assert!(wire.ask(json!({ "command": "extend" }))["error"].is_string());
    ask(&mut wire, json!({ "command": "drape" }));
    let state = status(&mut wire, "finished");
    assert_eq!(state["run"]["n_more"], 4);
    let first = download(&server, "result");
    for n in [16, 20] {
        ask(&mut wire, json!({ "command": "extend" }));
        let state =
            wire.state(|s| s["run"]["status"] == "finished" && s["run"]["iteration"] != n - 4);
        assert_eq!(state["run"]["iteration"], n);
    }
    assert!(download(&server, "result") != first);
    assert_replayed(&place, &server);
}

/// What is told to be impossible is refused, and changes nothing.
#[test]
fn what_cannot_be_done_is_refused() {
    let place = Workplace::new();
    let (_server, mut wire) = studio(&place, "[[stages]]\nn_iterations = 100000\n");
    let assert_refused = |wire: &mut Wire, state: &Value, n_possible: usize| {
        let can = state["can"]
            .as_object()
            .expect("the state says what can be done");
        let commands = [
            "drape", "pause", "resume", "step", "stop", "extend", "reset",
        ];
        let refused: Vec<&str> = commands.into_iter().filter(|c| can[*c] == false).collect();
        assert_eq!(refused.len(), commands.len() - n_possible, "{can:?}");
        for command in refused {
            let answer = wire.ask(json!({ "command": command }));
            assert!(answer["error"].is_string(), "{command}: {answer}");
        }
    };
    let state = wire.state(|_| true);
    assert_refused(&mut wire, &state, 2);
    ask(&mut wire, json!({ "command": "drape" }));
    let state = status(&mut wire, "running");
    assert_refused(&mut wire, &state, 3);
    ask(&mut wire, json!({ "command": "stop" }));
    let state = status(&mut wire, "stopped");
    assert_refused(&mut wire, &state, 5);
    assert_eq!(state["discards"], json!(["drape", "reset"]));
    ask(&mut wire, json!({ "command": "resume" }));
    status(&mut wire, "running");
    ask(&mut wire, json!({ "command": "pause" }));
    let state = status(&mut wire, "paused");
    assert_refused(&mut wire, &state, 4);
}

#[test]
fn parts_are_switched_on_the_way() {
    let place = Workplace::new();
    let (server, mut wire) = studio(&place, "[[stages]]\nn_iterations = 100000\n");
    ask(&mut wire, json!({ "command": "drape" }));
    status(&mut wire, "running");

    // A running drape takes it at once.
    let part = |name: &str, treatment: &str| json!({ "edit": { "do": "part", "name": name, "treatment": treatment } });
    ask(&mut wire, part("side1", "free"));
    let state =
        wire.state(|s| s["parts"]["free"][0] == "side1" && s["run"]["pending_parts"] == false);
    assert_eq!(state["run"]["status"], "running");

    // A paused one takes it with the next step; until then it can be undone.
    ask(&mut wire, json!({ "command": "pause" }));
    status(&mut wire, "paused");
    ask(&mut wire, part("side2", "rigid"));
    wire.state(|s| s["run"]["pending_parts"] == true);
    ask(&mut wire, json!({ "edit": { "do": "undo" } }));
    wire.state(|s| s["run"]["pending"] == false);
    ask(&mut wire, json!({ "edit": { "do": "redo" } }));
    let state = wire.state(|s| s["run"]["pending_parts"] == true);
    let paused_at = state["run"]["iteration"].as_u64().unwrap();
    ask(&mut wire, json!({ "command": "step" }));
    wire.state(|s| {
        s["run"]["pending"] == false && s["run"]["iteration"].as_u64() == Some(paused_at + 1)
    });

    let session: Value = serde_json::from_slice(&download(&server, "session")).unwrap();
    let events = session["run"]["events"].as_array().unwrap();
    let switched: Vec<&Value> = events.iter().map(|e| &e["change"]["parts"]).collect();
    assert_eq!(switched.len(), 2, "{events:?}");
    assert_eq!(switched[0]["rigid"], json!([]));
    assert_eq!(switched[1]["rigid"], json!(["side2"]));
    assert_replayed(&place, &server);

    // A restart comes back to the same parts.
    server.kill();
    let server = Server::start(Path::new(&place.path("")), &["source.obj", "target.ply"]);
    let mut wire = Wire::own(&server);
    let state = status(&mut wire, "paused");
    assert_eq!(state["parts"]["rigid"], json!(["side2"]));
    assert_eq!(state["run"]["pending"], false);
    ask(&mut wire, json!({ "command": "step" }));
    wire.state(|s| s["run"]["iteration"].as_u64() == Some(paused_at + 2));
    assert_replayed(&place, &server);
}
