//! What went wrong once: lost graphics, forgotten cameras, a new address, overlaps, digits that nobody can read.

use std::path::Path;

use serde_json::{json, Value};

use super::browser::{browser, Page};
use super::page::{lose_graphics, middle, pixel, probed};
use super::server::Server;
use super::wire::Wire;
use crate::support::Workplace;

const MARKED: [&str; 4] = ["source.obj", "target.ply", "--landmarks", "landmarks.json"];

/// The standard pair, marked, in a browser.
fn marked() -> Option<(Workplace, Server, Page)> {
    let browser = browser()?;
    let place = Workplace::new();
    let server = Server::start(&place.path(""), &MARKED);
    let page = Page::open(&browser, &server.url, [1024, 768]);
    page.wait("studio.views.result.shape && studio.figures");
    probed(&page);
    Some((place, server, page))
}

#[test]
fn the_page_comes_back_after_graphics_reload_and_restart() {
    let Some((place, server, page)) = marked() else {
        return;
    };
    // The graphics card forgets everything.
    let shown = pixel(&page, "source");
    lose_graphics(&page);
    assert_eq!(pixel(&page, "source"), shown);

    // The page is loaded again: cameras and colours are as they were.
    page.value("studio.cameras.look(1.1, 0.4), studio.stage.setHeat('stretch'), true");
    page.go(&server.url);
    page.wait("studio.views.result.shape?.perTriangle && studio.stage.heat === 'stretch'");
    let looks = page.value("studio.views.list.map((v) => [v.camera.yaw, v.camera.pitch])");
    assert_eq!(looks, json!([[1.1, 0.4], [1.1, 0.4], [1.1, 0.4]]));

    // The studio is started again: the page that was left open comes back by itself.
    let url = server.url.clone();
    server.kill();
    page.wait("!document.getElementById('offline').hidden");
    let server = Server::start(&place.path(""), &MARKED[..2]);
    assert_eq!(server.url, url);
    page.wait("document.getElementById('offline').hidden && studio.state.landmarks.length === 6");
}

#[test]
fn figures_of_other_landmarks_are_told_apart() {
    let Some((_place, _server, page)) = marked() else {
        return;
    };
    let is_old = "document.getElementById('figures').classList.contains('is-old')";
    page.wait(&format!("!({is_old})"));
    // The page is told of an edit before its figures come.
    page.value(&format!("globalThis.wasOld = false, new MutationObserver(() => {{ wasOld ||= {is_old}; }}).observe(document.getElementById('figures'), {{ attributes: true }}), true"));
    page.value("studio.edit('delete', { landmark: studio.state.landmarks[5].id }), true");
    page.wait(&format!(
        "wasOld && !({is_old}) && studio.figures.marks === studio.state.marks"
    ));
    for name in ["flipped", "crossing", "folds"] {
        let is_told = format!(
            "[...document.querySelectorAll('#figures dt')].some((e) => e.textContent === '{name}')"
        );
        assert_eq!(page.value(&is_told), json!(true), "{name}");
    }
}

#[test]
fn everything_can_be_read_and_nothing_overlaps() {
    let Some((_place, _server, page)) = marked() else {
        return;
    };
    let worst = page.value(
        "import('./colours.js').then((c) => Math.min(...Array.from({ length: 80 }, (_, k) => c.contrastWithWhite(c.markRgb(k)))))",
    );
    assert!(worst.as_f64().is_some_and(|c| c >= 4.5), "{worst}");
    // Neighbouring views leave no black line between them.
    let columns = page.value(
        "(() => { const { gl } = studio.painter.renderer; const [w, h] = [gl.drawingBufferWidth, gl.drawingBufferHeight]; \
         const row = new Uint8Array(4 * w); gl.readPixels(0, 2, w, 1, gl.RGBA, gl.UNSIGNED_BYTE, row); \
         return row.filter((c, k) => k % 4 < 3 && c < 20).length; })()",
    );
    assert_eq!(columns, json!(0));
    page.press("#settings");
    let at = page.value("[document.getElementById('toml').scrollTop, document.getElementById('toml').selectionStart]");
    assert_eq!(at, json!([0, 0]));
    page.value("document.getElementById('settings-dialog').close(), true");
    for size in [
        [1280, 800],
        [1024, 768],
        [800, 1280],
        [390, 844],
        [3840, 2160],
    ] {
        page.size(size, 1.0);
        page.settle();
        assert_eq!(overlaps(&page), json!([]), "{size:?}");
    }
}

/// Parts of the page that lie over each other, and views that are too small to work in.
fn overlaps(page: &Page) -> Value {
    page.value(
        "(() => { const parts = ['header', 'main', 'footer', 'aside', '#strip:not([hidden])'].map((s) => document.querySelector(s)).filter(Boolean); \
         const box = (e) => e.getBoundingClientRect(); const found = []; \
         parts.forEach((a, k) => parts.slice(k + 1).forEach((b) => { const [p, q] = [box(a), box(b)]; \
         if (Math.min(p.right, q.right) - Math.max(p.left, q.left) > 1 && Math.min(p.bottom, q.bottom) - Math.max(p.top, q.top) > 1) found.push(a.tagName + b.tagName); })); \
         studio.views.list.forEach((v) => v.box.width * v.box.height < 20000 && found.push(v.name)); \
         if (document.documentElement.scrollWidth > innerWidth) found.push('wide'); return found; })()",
    )
}

#[test]
fn files_that_come_while_others_are_opened_wait() {
    let Some(browser) = browser() else { return };
    let place = Workplace::new();
    let server = Server::start(&place.path(""), &[]);
    let page = Page::open(&browser, &server.url, [1280, 800]);
    page.wait("studio.state");
    // Onto the result's view, where the first free side is meant: the second file must not take that of the first.
    let at = middle(&page, "result");
    page.drop_files(at, &[place.path("source.obj")]);
    page.drop_files(at, &[place.path("target.ply")]);
    page.wait(
        "studio.state.source?.name === 'source.obj' && studio.state.target?.name === 'target.ply'",
    );
}

#[test]
fn a_half_pair_is_given_up_and_a_missed_click_says_so() {
    let Some((_place, _server, page)) = marked() else {
        return;
    };
    page.value("studio.edit('clear'), true");
    page.wait("studio.state.landmarks.length === 0");
    let at = middle(&page, "source");
    page.click(at);
    page.wait("studio.state.landmarks.length === 1");
    page.key("Escape", 27, 0);
    page.wait("studio.state.landmarks.length === 0 && studio.state.can.undo");
    page.press("#undo");
    page.wait("studio.state.landmarks.length === 1");
    // Beside the ball there is nothing.
    let corner = page.value("(() => { const r = studio.views.target.element.getBoundingClientRect(); return [r.left + 12, r.bottom - 30]; })()");
    page.click(super::browser::point(&corner));
    page.wait("!document.getElementById('toast').hidden && document.getElementById('toast').textContent.includes('missed')");
    // A second mark at one place is refused with a word.
    page.click(middle(&page, "target"));
    page.wait("studio.state.landmarks[0].target");
    // The marker would take the click: another page may not show it yet.
    let [x, y] = at;
    page.value(&format!(
        "studio.place(studio.views.source, studio.views.source.ray({{ clientX: {x}, clientY: {y} }})), true"
    ));
    page.wait("document.getElementById('toast').textContent.includes('already')");
    assert_eq!(page.value("studio.state.landmarks.length"), json!(1));
}

#[test]
fn a_drape_that_was_extended_comes_back_as_finished() {
    let place = Workplace::new();
    let arguments = ["--config", "short.toml"];
    let all: Vec<&str> = MARKED.into_iter().chain(arguments).collect();
    let server = Server::start(&place.path(""), &all);
    let mut wire = Wire::own(&server);
    wire.ask(json!({ "command": "drape" }));
    wire.state(|s| s["run"]["status"] == "finished");
    wire.ask(json!({ "command": "extend" }));
    wire.state(|s| s["run"]["status"] == "finished" && s["run"]["iteration"] == 16);
    super::browser::wait_for("the session file", || {
        let text = std::fs::read_to_string(place.path("session.json")).ok()?;
        let session: Value = serde_json::from_str(&text).ok()?;
        (session["run"]["iteration"] == 16).then_some(())
    });
    server.kill();
    let server = Server::start(Path::new(&place.path("")), &MARKED[..2]);
    let mut wire = Wire::own(&server);
    let state = wire.state(|s| s["run"]["status"] != "starting");
    assert_eq!(state["run"]["status"], "finished");
    assert_eq!(state["run"]["iteration"], 16);
}
