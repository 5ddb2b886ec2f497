//! Marks that help: small dots with their numbers, a loupe, places that snap.

use serde_json::{json, Value};

use super::browser::{browser, point, Page};
use super::page::{middle, probed};
use super::server::{Server, SHORT};
use super::wire::Wire;
use crate::support::Workplace;

/// The marker of a landmark that is seen in a view, its middle on the page, and the landmark's number.
fn seen_marker(page: &Page, side: &str) -> (u64, [f64; 2]) {
    let found = page.value(&format!(
        "(() => {{ const view = studio.views.of('{side}'); for (const l of studio.state.landmarks) {{ const m = view.markers.get(l.id); \
         if (m.classList.contains('is-behind')) continue; const r = m.getBoundingClientRect(); \
         return [l.id, [Math.round(r.left + r.width / 2), Math.round(r.top + r.height / 2)]]; }} return null; }})()"
    ));
    (
        found[0].as_u64().expect("a marker is seen"),
        point(&found[1]),
    )
}

#[test]
fn a_mark_is_a_dot_with_its_number_and_a_loupe() {
    let Some(browser) = browser() else { return };
    let place = Workplace::new();
    let server = Server::start(&place.path(""), &SHORT);
    let page = Page::open(&browser, &server.url, [1280, 800]);
    page.wait("studio.views.result.shape && studio.state.landmarks.length === 6");
    probed(&page);
    let (id, at) = seen_marker(&page, "target");
    let digits =
        format!("parseFloat(getComputedStyle(studio.views.target.markers.get({id})).fontSize)");
    assert_eq!(page.value(&digits), json!(0));
    page.hover(at);
    page.wait(&format!("{digits} > 6"));

    let [x, y] = at;
    assert_eq!(page.value("studio.loupe.canvas.hidden"), json!(true));
    page.hold(at, [x + 24.0, y + 16.0]);
    page.wait("!studio.loupe.canvas.hidden && studio.dragging === null");
    page.settle();
    // What is under the pointer is seen in its middle: the target, and the mark where it came to lie.
    let colours = page.value(
        "(() => { const c = studio.loupe.canvas; const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data; \
         const seen = new Set(); for (let k = 0; k < d.length; k += 4) seen.add(`${d[k] >> 4} ${d[k + 1] >> 4} ${d[k + 2] >> 4}`); return seen.size; })()",
    );
    assert!(colours.as_u64() > Some(4), "{colours} colours");
    page.let_go([x + 24.0, y + 16.0]);
    page.wait("studio.loupe.canvas.hidden");
    // The view itself is drawn as it was: nothing of the loupe is left.
    page.wait("!studio.views.target.isStale");
}

/// A mark on the front of the source, and its place there.
fn mark(wire: &mut Wire, x: f64, snap: Value) -> Value {
    wire.ask(json!({ "edit": { "do": "clear" } }));
    let answer = wire.ask(json!({ "edit": {
        "do": "place", "shape": "source", "snap": snap,
        "ray": { "origin": [x, 0.07, 3.0], "direction": [0.0, 0.0, -1.0], "spread": 0.001 },
    } }));
    let id = answer["value"]["landmark"].clone();
    let state = wire.state(|s| s["landmarks"][0]["id"] == id);
    state["landmarks"][0]["source"]["weights"].clone()
}

#[test]
fn places_snap_to_vertices_where_that_is_asked_for() {
    let place = Workplace::new();
    let server = Server::start(&place.path(""), &SHORT);
    let mut wire = Wire::own(&server);
    let is_vertex = |weights: &Value| {
        let weights = weights.as_array().expect("weights");
        weights.iter().any(|w| *w == json!(1.0))
    };
    assert!(!is_vertex(&mark(&mut wire, 0.11, Value::Null)));
    assert!(is_vertex(&mark(&mut wire, 0.12, json!("vertex"))));
    assert!(is_vertex(&mark(&mut wire, 0.13, json!("curvature"))));
    let answer = wire.ask(
        json!({ "edit": { "do": "place", "shape": "source", "snap": "wall",
        "ray": { "origin": [0.0, 0.0, 3.0], "direction": [0.0, 0.0, -1.0], "spread": 0.001 } } }),
    );
    assert!(answer["error"].is_string(), "{answer}");
}

#[test]
fn a_click_snaps_to_the_sharpest_place_nearby() {
    let Some(browser) = browser() else { return };
    let place = Workplace::new();
    // A scan with a thorn on its front.
    let mut soup = mesh_core::io::read_soup(place.path("target.ply")).unwrap();
    let front = |p: &mesh_core::Point3| p.z - 0.2 * (p.x - 10.0).abs() - 0.2 * p.y.abs();
    let positions = soup.positions.iter_mut();
    let thorn = positions
        .max_by(|a, b| front(a).total_cmp(&front(b)))
        .unwrap();
    thorn.z += 0.5;
    let thorn = *thorn;
    mesh_core::io::write_soup(place.path("thorn.ply"), &soup).unwrap();
    let server = Server::start(&place.path(""), &["source.obj", "thorn.ply"]);
    let page = Page::open(&browser, &server.url, [1280, 800]);
    page.wait("studio.views.result.shape");
    page.press("[data-look=front]");
    page.key("s", 83, 0);
    page.key("s", 83, 0);
    page.wait("studio.snap === 'curvature'");
    let [x, y] = middle(&page, "target");
    page.click([x + 3.0, y - 2.0]);
    page.wait("studio.state.landmarks[0]?.target");
    let side = page.value("studio.state.target.side").as_f64().unwrap();
    let at = page.value("studio.state.landmarks[0].target.point");
    let [u, v] = point(&at);
    // The box of the scan is about (10, 0), and the thorn is at its middle.
    let off = ((u * side - (thorn.x - 10.0)).powi(2) + (v * side - thorn.y).powi(2)).sqrt();
    assert!(off < 1e-3 * side, "{at} {thorn}");
}
