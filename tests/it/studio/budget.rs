//! What a drawn frame costs the page, measured and printed.

use std::fs;
use std::io::Write as _;

use mesh_core::{io, shapes};
use serde_json::json;

use super::browser::browser;
use super::server::Server;

/// The asked times hold on an idle machine; this many times as much is allowed on a busy one, without a graphics card.
const BUSY: f64 = 6.0;
/// Milliseconds of script per drawn frame.
const FRAME: f64 = 8.0;
/// Milliseconds until a place is picked.
const PICK: f64 = 100.0;

#[test]
fn a_frame_with_many_landmarks_costs_little_script() {
    let Some(browser) = browser() else { return };
    let folder = tempfile::tempdir().unwrap();
    let soup = shapes::quad_sphere(122);
    assert!(soup.positions.len() > 89_000);
    io::write_soup(folder.path().join("source.ply"), &soup).unwrap();
    io::write_soup(folder.path().join("target.ply"), &shapes::icosphere(4)).unwrap();
    let step = soup.positions.len() / 68;
    let landmarks: Vec<_> = (0..68)
        .map(|k| {
            let p = soup.positions[k * step + 7].coords;
            json!({ "source": { "point": p.as_slice() }, "target": { "point": p.as_slice() } })
        })
        .collect();
    let landmarks = json!({ "landmarks": landmarks }).to_string();
    fs::write(folder.path().join("landmarks.json"), landmarks).unwrap();
    let arguments = ["source.ply", "target.ply", "--landmarks", "landmarks.json"];
    let server = Server::start(folder.path(), &arguments);
    let page = super::browser::Page::open(&browser, &server.url, [1280, 800]);
    page.wait("studio.views.source.shape && studio.views.target.shape && studio.state.landmarks.length === 68");
    page.settle();
    // The work of the page alone: what the graphics card does afterwards is not waited for.
    let frame = page.value(
        "(async () => { const times = []; for (let k = 0; k < 7; k++) { await new Promise(requestAnimationFrame); \
         studio.views.list.forEach((v) => { v.camera.orbit(3, 1); v.isStale = true; }); \
         const t = performance.now(); studio.painter.draw(); times.push(performance.now() - t); } \
         return times.sort((a, b) => a - b)[3]; })()",
    );
    let pick = page.value(
        "(async () => { const view = studio.views.source; const r = view.element.getBoundingClientRect(); const times = []; \
         for (let k = 0; k < 9; k++) { const t = performance.now(); \
         await studio.link.ask('query', { do: 'pick', shape: 'source', ray: view.ray({ clientX: r.left + r.width / 2 + k, clientY: r.top + r.height / 2 }) }); \
         times.push(performance.now() - t); } return times.sort((a, b) => a - b)[4]; })()",
    );
    let [frame, pick] = [&frame, &pick].map(|v| v.as_f64().unwrap());
    // Past the test runner, which shows nothing that a passing test prints.
    let figures = format!("studio: {frame:.1} ms of script per frame with 68 landmarks and 89 000 vertices, {pick:.1} ms to pick\n");
    drop(std::io::stderr().write_all(figures.as_bytes()));
    assert!(frame < FRAME * BUSY, "{frame} ms of script per frame");
    assert!(pick < PICK * BUSY, "{pick} ms until a place is picked");
}
