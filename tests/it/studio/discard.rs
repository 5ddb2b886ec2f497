//! A result is thrown away only by a user who means it.

use serde_json::json;

use super::browser::{browser, Page};
use super::server::Server;
use crate::support::Workplace;

/// The dialog that asks.
const DIALOG: &str = "document.getElementById('discard-dialog')";

#[test]
fn a_result_is_thrown_away_only_on_purpose() {
    let Some(browser) = browser() else { return };
    let place = Workplace::new();
    place.write("short.toml", "[[stages]]\nn_iterations = 12\n");
    let arguments = "source.obj target.ply --landmarks landmarks.json --config short.toml";
    let arguments: Vec<&str> = arguments.split(' ').collect();
    let server = Server::start(&place.path(""), &arguments);
    let page = Page::open(&browser, &server.url, [1280, 800]);
    page.wait("studio.views.result.shape && studio.state.can.drape");
    // There is no result yet, and nothing is asked.
    page.key("d", 68, 0);
    page.wait("studio.state.run.status === 'finished'");
    let number = page.value("studio.state.run.number");

    // Neither the key nor its second press throws the result away.
    page.key("d", 68, 0);
    page.wait(&format!("{DIALOG}.open"));
    page.key("d", 68, 0);
    page.press("#discard-dialog .main");
    page.wait(&format!("!{DIALOG}.open"));
    page.press("#reset");
    page.wait(&format!("{DIALOG}.open"));
    page.press("#discard-dialog .main");
    page.wait(&format!("!{DIALOG}.open"));
    page.settle();
    assert_eq!(page.value("studio.state.run.number"), number);
    assert_eq!(page.value("studio.state.run.status"), json!("finished"));

    page.press("#drape");
    page.press("#discard-dialog [value=discard]");
    page.wait(&format!(
        "studio.state.run.number > {number} && studio.state.run.status === 'finished'"
    ));
    page.press("#reset");
    page.press("#discard-dialog [value=discard]");
    page.wait("studio.state.run.status === 'none' && studio.state.can.drape");
}
