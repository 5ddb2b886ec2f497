//! The whole job without a mouse, and what a checker of accessibility finds.

use std::path::Path;

use serde_json::json;

use super::browser::{browser, Page};
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
    let server = Server::start(&place.path(""), &SHORT);
    let page = Page::open(&browser, &server.url, [1280, 800]);
    page.wait("studio.views.result.shape && studio.figures && studio.state.can.drape");
    page.press("#drape");
    page.wait("studio.state.run.status === 'finished'");
    page.press("#keep");
    page.wait("studio.state.kept[0]?.figures");
    page.value(&format!("{checker}; true"));
    for scheme in ["light", "dark"] {
        page.prefer(scheme);
        page.settle();
        let found = page.value(
            "axe.run(document, { resultTypes: ['violations'] }).then((r) => r.violations.filter((v) => ['serious', 'critical'].includes(v.impact)) \
             .map((v) => `${v.id}: ${v.nodes.map((n) => `${n.target.join(' ')} ${n.any[0]?.message ?? ''}`).slice(0, 3).join('; ')}`))",
        );
        assert_eq!(found, json!([]), "{scheme}");
    }
}
