//! Pictures of every state, to be looked at: written where `DRAPE_PICTURES` names a folder.

use std::path::PathBuf;

use super::browser::{browser, Page};
use super::server::{horse_wolf, Server};

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
    page.prefer("dark");
    save(&page, "empty-dark");
    page.prefer("light");
    page.press("#help");
    save(&page, "keys");
    empty.kill();

    let [source, target, landmarks] = ["source.obj", "target.obj", "landmarks.json"]
        .map(|name| pair.join(name).display().to_string());
    let server = Server::start(
        folder.path(),
        &[&source, &target, "--fresh", "--landmarks", &landmarks],
    );
    page.go(&server.url);
    page.wait("studio.views.result.shape && studio.figures");
    save(&page, "preview");
    page.press("#drape");
    page.wait("studio.frame.iteration > 60 && studio.figures.iteration > 10");
    page.press("#pause");
    page.wait("studio.state.run.status === 'paused'");
    save(&page, "paused");
    page.value("studio.setHeat('distance')");
    page.wait("studio.views.result.shape.values");
    page.prefer("dark");
    save(&page, "heat-dark");
    page.value("studio.setHeat('stretch')");
    page.wait("studio.views.result.shape.perTriangle");
    page.prefer("light");
    save(&page, "stretch");
    page.value("studio.setHeat('')");
    page.value("document.getElementById('opacity').value = 0.5");
    page.size([3840, 2160], 1.0);
    save(&page, "uhd");
}
