//! Nobody but its own page reaches the studio, and nothing that a page sends does harm.

use serde_json::{json, Value};

use super::browser::{browser, wait_for, Page};
use super::server::Server;
use super::wire::{raw, Wire};
use crate::support::Workplace;

/// A small pair and a studio on it.
fn small() -> (Workplace, Server) {
    let place = Workplace::new();
    let server = Server::start(&place.path(""), &["source.obj", "target.ply"]);
    (place, server)
}

/// A ray through the middle of a view, from its front.
fn ray(x: f64, y: f64) -> Value {
    json!({ "origin": [x, y, 3.0], "direction": [0.0, 0.0, -1.0], "spread": 0.001 })
}

#[test]
fn requests_from_elsewhere_are_refused() {
    let (_place, server) = small();
    let (host, path) = (server.host().to_owned(), server.path());
    let own = format!("http://{host}");
    let get = |path: &str, host: &str, more: &str| {
        let answer = raw(
            &server,
            &format!("GET {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n{more}\r\n"),
        );
        answer[9..12].to_owned()
    };
    assert_eq!(get(&path, &host, ""), "200");
    assert_eq!(get("/", &host, ""), "403");
    assert_eq!(get("/00000000000000000000000000000000/", &host, ""), "403");
    assert_eq!(get(&path, "evil.example", ""), "403");
    assert_eq!(get(&path, &host, "Origin: http://evil.example\r\n"), "403");
    assert_eq!(get(&format!("{path}../../etc/passwd"), &host, ""), "404");
    assert_eq!(get(&format!("{path}%2e%2e%2fCargo.toml"), &host, ""), "404");

    for origin in [None, Some("http://evil.example"), Some("null")] {
        assert_eq!(Wire::connect(&server, &path, origin).err(), Some(403));
    }
    let wrong = format!("/{}/", "0".repeat(32));
    assert_eq!(Wire::connect(&server, &wrong, Some(&own)).err(), Some(403));
    assert!(Wire::connect(&server, &path, Some(&own)).is_ok());

    let post = format!("POST {path}open/source/a.obj HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\nContent-Length: 2\r\nOrigin: http://evil.example\r\n\r\nv ");
    assert!(raw(&server, &post).starts_with("HTTP/1.1 403"));
    let huge = format!("POST {path}open/source/a.obj HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\nContent-Length: 99999999999\r\nOrigin: {own}\r\n\r\n");
    assert!(raw(&server, &huge).starts_with("HTTP/1.1 413"));
}

#[test]
fn a_page_of_another_site_cannot_reach_the_studio() {
    let Some(browser) = browser() else { return };
    let (_place, server) = small();
    // The page of the second studio stands for another site: another origin, the same computer.
    let (_other_place, other) = small();
    let page = Page::open(&browser, &other.url, [900, 700]);
    page.wait("studio.state");
    let url = &server.url;
    let socket = url.replace("http://", "ws://");
    let tries = format!(
        "Promise.all([
           fetch('{url}').then((a) => a.text(), () => 'refused'),
           fetch('{url}open/source/a.obj', {{ method: 'POST', mode: 'no-cors', body: 'v 0 0 0' }}).then(() => 'sent', () => 'refused'),
           new Promise((done) => {{ const s = new WebSocket('{socket}ws'); s.onopen = () => done('open'); s.onerror = () => done('refused'); }}),
           new Promise((done) => {{ const f = document.createElement('iframe'); f.onload = () => {{ let t = 'refused'; try {{ t = f.contentDocument.title || 'refused'; }} catch {{ }} done(t); }}; f.src = '{url}'; document.body.append(f); }}),
         ])"
    );
    // The page's own policy refuses most of it; without that policy, the server does.
    page.call("Page.setBypassCSP", json!({ "enabled": true }));
    for _ in 0..2 {
        let outcome = page.value(&tries);
        assert_eq!(outcome[0], "refused", "{outcome}");
        assert_eq!(outcome[2], "refused", "{outcome}");
        assert_eq!(outcome[3], "refused", "{outcome}");
        page.go(&other.url);
        page.wait("studio.state");
    }
    let state = Wire::own(&server).state(|_| true);
    assert_eq!(state["source"]["name"], "source.obj");
}

#[test]
fn malformed_and_huge_messages_do_no_harm() {
    let (_place, server) = small();
    let mut wire = Wire::own(&server);
    let deep = "[".repeat(100_000);
    let bad = [
        "",
        "{",
        "null",
        "[1, 2]",
        "{\"id\": 1}",
        "{\"id\": -1, \"edit\": {\"do\": \"undo\"}}",
        "{\"id\": 1, \"edit\": {\"do\": \"nonsense\"}}",
        "{\"id\": 1, \"command\": \"undo\"}",
        "{\"id\": 1, \"query\": {\"do\": \"clear\"}}",
        "{\"id\": 1, \"edit\": {\"do\": \"place\", \"shape\": \"up\"}}",
        "{\"heat\": \"none\"}",
        deep.as_str(),
    ];
    for text in bad {
        assert!(wire.send(text));
        let told = loop {
            let message = wire.hear().expect("the connection stays");
            if message["type"] == "error" || message["type"] == "reply" {
                break message;
            }
        };
        assert!(told["error"].is_string(), "{text:.40}: {told}");
    }
    for request in [
        json!({ "edit": { "do": "delete", "landmark": 77 } }),
        json!({ "edit": { "do": "drag", "landmark": 77, "shape": "source", "ray": null, "done": true } }),
        json!({ "edit": { "do": "mirror", "axes": [0, 7] } }),
        json!({ "edit": { "do": "preset", "name": "best\"\nseed = 1" } }),
        json!({ "edit": { "do": "settings", "toml": "[[stages]]\nn_iterations = -1" } }),
        json!({ "command": "pause" }),
    ] {
        let answer = wire.ask(request.clone());
        assert!(answer["error"].is_string(), "{request}: {answer}");
    }
    // Rays that hit nothing, or are none.
    for direction in [
        json!([0.0, 0.0, 0.0]),
        json!([1e308, 1e308, 1e308]),
        json!([0.0, 1.0, 0.0]),
    ] {
        let ray = json!({ "origin": [1e300, 0.0, 9.0], "direction": direction, "spread": -1.0 });
        let answer = wire.ask(json!({ "edit": { "do": "place", "shape": "source", "ray": ray } }));
        assert!(
            answer["value"].is_null() && answer["error"].is_null(),
            "{answer}"
        );
    }

    // More than a page may send ends its connection, and no other.
    let mut other = Wire::own(&server);
    wire.send(&format!(
        "{{\"id\": 1, \"edit\": {{\"do\": \"settings\", \"toml\": \"{}\"}}}}",
        "x".repeat(4 << 20)
    ));
    while wire.hear().is_some() {}
    let answer = other.ask(json!({ "query": { "do": "curves" } }));
    assert!(answer["error"].is_null(), "{answer}");
}

#[test]
fn a_thousand_rapid_clicks_and_two_tabs_do_no_harm() {
    let (place, server) = small();
    let (mut one, mut two) = (Wire::own(&server), Wire::own(&server));
    for k in 0..500 {
        let at = |n: u32| 0.4 * (f64::from(k * n % 17) / 8.0 - 1.0);
        for (wire, side) in [(&mut one, "source"), (&mut two, "target")] {
            wire.post(
                json!({ "edit": { "do": "place", "shape": side, "ray": ray(at(3), at(5)) } }),
            );
        }
    }
    let settled = one.state(|s| s["landmarks"].as_array().is_some_and(|l| l.len() > 10));
    assert!(settled["landmarks"].as_array().unwrap().len() <= 1000);
    for wire in [&mut one, &mut two] {
        let answer = wire.ask(json!({ "edit": { "do": "undo" } }));
        assert!(answer["error"].is_null(), "{answer}");
    }
    // Both tabs end with the same landmarks.
    one.ask(json!({ "edit": { "do": "clear" } }));
    for wire in [&mut one, &mut two] {
        let state = wire.state(|s| s["landmarks"].as_array().is_some_and(Vec::is_empty));
        assert!(state["can"]["undo"].as_bool().unwrap());
    }
    wait_for("the session file", || {
        let text = std::fs::read_to_string(place.path("session.json")).ok()?;
        let session: Value = serde_json::from_str(&text).ok()?;
        session["document"]["marks"]
            .as_array()?
            .is_empty()
            .then_some(())
    });
}
