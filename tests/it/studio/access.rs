//! The whole job without a mouse, and what a checker of accessibility finds.

use std::path::Path;

use serde_json::json;

use super::browser::{browser, Page};
use super::page::middle;
use super::server::{Server, SHORT};
use crate::data::skip;
use crate::support::Workplace;

/// The checker, a tool of development: `npm ci` in `tests/web` brings it.
const CHECKER: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/web/node_modules/axe-core/axe.min.js"
);

/// Presses Tab until an element has the focus.
fn tab_to(page: &Page, id: &str) {
    for _ in 0..200 {
        if page.value("document.activeElement?.id") == json!(id) {
            return;
        }
        page.key("Tab", 9, 0);
    }
    panic!("{id} is not reached by Tab");
}

#[test]
fn a_job_is_done_with_the_keyboard_alone() {
    let Some(browser) = browser() else { return };
    let place = Workplace::new();
    let arguments = ["source.obj", "target.ply", "--config", "short.toml"];
    let server = Server::start(&place.path(""), &arguments);
    let page = Page::open(&browser, &server.url, [1280, 800]);
    page.wait("studio.views.result.shape && studio.state.can.drape");
    // Two pairs: the second beside the first.
    for k in 0..2 {
        for side in ["source", "target"] {
            tab_to(&page, &format!("view-{side}"));
            page.key("Enter", 13, 0);
            page.wait("studio.cursor.isShown");
            for _ in 0..3 * k {
                page.key("ArrowRight", 39, 0);
            }
            page.key("Enter", 13, 0);
            page.wait(&format!("studio.state.landmarks[{k}]?.{side}"));
            page.key("Escape", 27, 0);
            page.wait("!studio.cursor.isShown");
        }
    }
    // The cross moves over the surface, the camera does not.
    assert_eq!(page.value("studio.state.landmarks.length"), json!(2));
    page.key("d", 68, 0);
    page.wait("studio.state.run.status === 'finished'");
    page.key("k", 75, 0);
    page.wait("studio.state.kept.length === 1");
    tab_to(&page, "export");
    page.key(" ", 32, 0);
    tab_to(&page, "export-result");
}

/// Asks the checker about the page as it is, in light and dark.
fn is_accessible(page: &Page, checker: &str, state: &str) {
    page.value(&format!("if (!globalThis.axe) {{ {checker} }} true"));
    for scheme in ["light", "dark"] {
        page.prefer(scheme);
        page.wait(&format!(
            "document.documentElement.dataset.theme === '{scheme}'"
        ));
        page.settle();
        let found = page.value(
            "axe.run(document, { resultTypes: ['violations'] }).then((r) => r.violations.filter((v) => ['serious', 'critical'].includes(v.impact)) \
             .map((v) => `${v.id}: ${v.nodes.map((n) => `${n.target.join(' ')} ${n.any[0]?.message ?? ''}`).slice(0, 3).join('; ')}`))",
        );
        assert_eq!(found, json!([]), "{state}, {scheme}");
    }
}

/// What can be done before a drape, one after the other.
fn before_a_drape(page: &Page, checks: &dyn Fn(&str)) {
    page.click(middle(page, "source"));
    page.wait("studio.state.landmarks.some((l) => l.source && !l.target)");
    checks("half a pair");
    page.key("Escape", 27, 0);
    page.key("c", 67, 0);
    page.click(middle(page, "source"));
    page.wait("studio.state.drawing?.source.length === 1");
    checks("a curve is drawn");
    page.key("Escape", 27, 0);
    page.wait("studio.state.drawing === null");
    page.key("b", 66, 0);
    page.wait("studio.brush.isOn && studio.brush.weights");
    checks("weights are painted");
    page.key("b", 66, 0);
    for (button, dialog) in [("settings", "settings"), ("help", "keys")] {
        page.press(&format!("#{button}"));
        page.wait(&format!("document.getElementById('{dialog}-dialog').open"));
        checks(button);
        page.value(&format!(
            "document.getElementById('{dialog}-dialog').close(), true"
        ));
    }
}

/// A drape that runs, stands still, is brushed, kept and compared; and the question before it is left.
fn while_draped(page: &Page, checks: &dyn Fn(&str)) {
    page.press("#drape");
    page.wait("studio.state.run.status === 'running' && studio.shown.iteration > 2");
    // The page stands still meanwhile: what it is told then comes late.
    page.value("studio.hear = () => {}; studio.stage.receive = (bytes) => studio.stage.acknowledge(new Uint32Array(bytes, 0, 4)[1]); true");
    checks("draping");
    page.value("delete studio.hear, delete studio.stage.receive");
    page.press("#stop");
    page.wait("studio.state.run.status === 'stopped' && studio.state.can.brush");
    checks("stopped");
    page.key("g", 71, 0);
    page.wait("studio.sculpt.brush === 'relax'");
    checks("the result is brushed");
    page.key("Escape", 27, 0);
    page.press("#keep");
    page.wait("studio.state.kept[0]?.figures");
    page.press("#kept .kept");
    page.wait("studio.strip.shape");
    page.value("studio.stage.setHeat('difference')");
    checks("two results are compared");
    page.press("#reset");
    page.wait("document.getElementById('discard-dialog').open");
    checks("a question");
    page.key("Escape", 27, 0);
}

/// Targets that wait, and marks that wait for their places.
fn next_scans(page: &Page, place: &Workplace, checks: &dyn Fn(&str)) {
    let mut soup =
        mesh_core::io::read_soup(place.path("target.ply")).expect("the workplace has a target");
    let names = ["second.ply", "third.ply"].map(|name| {
        soup.positions.iter_mut().for_each(|p| p.y *= 1.01);
        mesh_core::io::write_soup(place.path(name), &soup).expect("a target is written");
        place.path(name)
    });
    page.drop_files(middle(page, "target"), &names);
    page.wait("studio.state.target.name === 'second.ply' && studio.state.scans.queue.length === 1 && studio.views.target.shape");
    page.press("#scans");
    checks("targets wait");
}

#[test]
fn a_checker_finds_nothing_serious() {
    let Some(browser) = browser() else { return };
    let Ok(checker) = std::fs::read_to_string(Path::new(CHECKER)) else {
        assert!(
            std::env::var_os("CI").is_none(),
            "axe-core is not there; run npm ci in tests/web"
        );
        skip("axe-core is not there (npm ci in tests/web), so no checker looked at the page");
        return;
    };
    let place = Workplace::new();
    let empty = Server::start(&place.path(""), &[]);
    let page = Page::open(&browser, &empty.url, [1280, 800]);
    let checks = |state: &str| is_accessible(&page, &checker, state);
    page.wait("studio.state");
    checks("empty");
    empty.kill();

    let server = Server::start(&place.path(""), &SHORT);
    page.go(&server.url);
    page.wait("studio.views.result.shape && studio.state.can.drape");
    page.press("#drape");
    page.wait("studio.state.run.status === 'finished' && studio.figures");
    checks("finished");
    server.kill();

    place.write("short.toml", "[[stages]]\nn_iterations = 100000\n");
    let more = [&SHORT[..], &["--fresh"]].concat();
    let server = Server::start(&place.path(""), &more);
    page.go(&server.url);
    page.wait("studio.views.result.shape && studio.figures && studio.state.can.drape");
    before_a_drape(&page, &checks);
    while_draped(&page, &checks);
    next_scans(&page, &place, &checks);
}
