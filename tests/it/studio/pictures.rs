//! Pictures of every state, to be looked at: written where `DRAPE_PICTURES` names a folder.

use std::path::PathBuf;

use super::browser::{browser, Page};
use super::page::probed;
use super::server::Server;
use crate::data::horse_wolf;
use crate::regions::{head_on_skin, HEAD, SKIN};

#[test]
fn every_state_can_be_drawn() {
    let Some((browser, pair)) = browser().zip(horse_wolf()) else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let place = std::env::var_os("DRAPE_PICTURES").map(PathBuf::from);
    let save = |page: &Page, name: &str| {
        let picture = page.picture();
        assert!(picture.starts_with(b"\x89PNG"));
        if let Some(place) = &place {
            std::fs::write(place.join(format!("{name}.png")), picture).unwrap();
        }
    };

    let empty = Server::start(folder.path(), &[]);
    let page = Page::open(&browser, &empty.url, [1280, 800]);
    page.wait("studio.state");
    save(&page, "empty");
    page.press("#help");
    save(&page, "keys");
    empty.kill();
    save_parts(&page, &save);

    let [source, target, landmarks] = ["source.obj", "target.obj", "landmarks.json"]
        .map(|name| pair.join(name).display().to_string());
    // Long enough not to end while it is looked at.
    std::fs::write(
        folder.path().join("long.toml"),
        "[[stages]]\nn_iterations = 100000\n",
    )
    .unwrap();
    let server = Server::start(
        folder.path(),
        &[
            &source,
            &target,
            "--fresh",
            "--landmarks",
            &landmarks,
            "--config",
            "long.toml",
        ],
    );
    page.go(&server.url);
    page.wait("studio.views.result.shape && studio.figures && studio.state.warnings");
    save(&page, "preview");
    page.press("#drape");
    page.wait("studio.shown.iteration > 60 && studio.figures.iteration > 10");
    save(&page, "draping");
    page.press("#pause");
    page.wait("studio.state.run.status === 'paused'");
    drag_away(&page);
    page.wait("studio.shown.kind === 2");
    save(&page, "paused-and-changed");
    page.press("#undo");
    page.wait("studio.shown.kind === 1");
    colours(&page, &save);
    compared(&page, &save);
    page.press("#settings");
    save(&page, "settings");
    page.value("document.getElementById('settings-dialog').close(), true");
    server.kill();
    page.wait("!document.getElementById('offline').hidden");
    save(&page, "offline");
}

/// A kept result beside the run that went on from it.
fn compared(page: &Page, save: &dyn Fn(&Page, &str)) {
    page.press("#keep");
    page.wait(
        "studio.state.kept[0]?.figures && document.querySelector('#kept img').naturalWidth > 0",
    );
    page.press("#step");
    page.wait("studio.shown.iteration > studio.state.kept[0].iteration");
    page.press("#kept .kept");
    page.wait("studio.strip.shape");
    save(page, "compared");
    page.press("#kept .kept");
}

/// A part that is pointed out, and what is proposed for inner pieces.
fn save_parts(page: &Page, save: &dyn Fn(&Page, &str)) {
    let place = head_on_skin();
    let arguments = [HEAD, SKIN, "--landmarks", "head.json"];
    let server = Server::start(&place.path(""), &arguments);
    page.go(&server.url);
    page.wait("studio.views.result.shape && studio.figures && studio.state.inner.length > 0");
    page.value("studio.parts.pointOut('hidden:1')");
    page.wait("studio.parts.pointedRanges.length > 0");
    probed(page);
    save(page, "parts");
    server.kill();
}

/// Heat maps, the target over the result, light and dark, a small and a large page.
fn colours(page: &Page, save: &dyn Fn(&Page, &str)) {
    page.value("studio.stage.setHeat('distance')");
    page.wait("studio.views.result.shape.values");
    page.prefer("dark");
    save(page, "distance-dark");
    page.value("studio.stage.setHeat('stretch')");
    page.wait("studio.views.result.shape.perTriangle");
    page.prefer("light");
    save(page, "stretch");
    page.value("studio.stage.setHeat('')");
    page.value("document.getElementById('opacity').value = 0.5; studio.painter.invalidate(); 1");
    page.size([3840, 2160], 1.0);
    save(page, "overlay-uhd");
    page.size([1280, 800], 1.0);
}

/// Moves the first landmark of the target to where it does not belong.
fn drag_away(page: &Page) {
    probed(page);
    let at = page.value(
        "(() => { const p = studio.state.landmarks[2].target.point; const at = studio.onPage('target', p); \
         return [Math.round(at.x), Math.round(at.y)]; })()",
    );
    let from = super::browser::point(&at);
    page.drag(from, [from[0] + 70.0, from[1] + 45.0]);
}
