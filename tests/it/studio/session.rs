//! A session as a user has it: mark, preview, drape, pause, add, drag, resume, undo, redo, export, replay.

use std::fs;
use std::path::Path;

use serde_json::Value;

use super::browser::{browser, wait_for, Page};
use super::page::{find, mark, n_landmarks, number, shown, vertex, Place};
use super::server::Server;
use crate::data::horse_wolf;
use crate::support::run;

/// Enough to see Q rise and to pause in time.
const SETTINGS: &str = "[[stages]]\nn_iterations = 1500\n[[stages]]\nn_iterations = 300\n";

/// Vertices of the source and the places that they belong to, in the frames of their views.
fn pairs(page: &Page, folder: &Path) -> Vec<(Place, Place)> {
    let text =
        fs::read_to_string(folder.join("landmarks.json")).expect("the pair is as its README says");
    let file: Value = serde_json::from_str(&text).expect("the pair is as its README says");
    let rows = file["source_vertices"]
        .as_array()
        .expect("the pair is as its README says");
    let points = file["target_points"]
        .as_array()
        .expect("the pair is as its README says");
    // The page knows the target by its vertices: the one nearest to each point.
    let soup = mesh_core::io::read_soup(folder.join("target.obj"))
        .expect("the pair is as its README says");
    let nearest = |p: &Value| {
        let p = mesh_core::Point3::new(
            p[0].as_f64().expect("the pair is as its README says"),
            p[1].as_f64().expect("the pair is as its README says"),
            p[2].as_f64().expect("the pair is as its README says"),
        );
        let all = soup.positions.iter().map(|q| (q - p).norm_squared());
        let best = all.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
        best.expect("the pair is as its README says").0 as u64
    };
    let pairs = rows.iter().zip(points);
    pairs
        .map(|(row, p)| {
            (
                vertex(
                    page,
                    "source",
                    row.as_u64().expect("the pair is as its README says"),
                ),
                vertex(page, "target", nearest(p)),
            )
        })
        .collect()
}

#[test]
fn a_user_drapes_a_horse_over_a_wolf() {
    let Some((browser, pair)) = browser().zip(horse_wolf()) else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("short.toml"), SETTINGS).unwrap();
    let [source, target] =
        ["source.obj", "target.obj"].map(|name| pair.join(name).display().to_string());
    let server = Server::start(folder.path(), &[&source, &target, "--config", "short.toml"]);
    let page = Page::open(&browser, &server.url, [1280, 800]);
    page.wait("studio.views.result.shape");
    let pairs = pairs(&page, &pair);

    // Five landmarks by clicking, and the preview moves with each.
    let mut before = shown(&page);
    for &k in &[2, 0, 3, 6, 7] {
        let (on_source, on_target) = pairs[k];
        mark(&page, on_source, on_target);
        wait_for("the preview", || (shown(&page) != before).then_some(()));
        before = shown(&page);
    }
    page.wait("studio.figures && studio.state.run.status === 'none'");
    let q_before = number(&page, "studio.figures.q");

    // Drape, watch Q rise, pause.
    page.press("#drape");
    page.wait(&format!("studio.state.run.status === 'running' && studio.figures.iteration > 5 && studio.figures.q > {q_before} + 0.03"));
    page.press("#pause");
    page.wait("studio.state.run.status === 'paused'");
    let paused_at = number(&page, "studio.state.run.iteration");
    assert!(paused_at > 5.0 && paused_at < 1800.0, "{paused_at}");

    // Add one, drag one, resume.
    let (on_source, on_target) = pairs[1];
    mark(&page, on_source, on_target);
    page.wait("studio.state.run.pending && studio.shown.kind === 2");
    drag_on_target(&page, pairs[7].1);
    page.press("#resume");
    page.wait("studio.state.run.status === 'finished'");
    let (n, q) = (n_landmarks(&page), number(&page, "studio.figures.q"));
    assert_eq!(n, 6);
    assert!(q > q_before + 0.1, "Q went from {q_before} to {q}");

    // Undo and redo the drag and the landmark; the result is the drape's all the while.
    page.press("#undo");
    page.press("#undo");
    page.wait("studio.state.landmarks.at(-1).target === null && studio.state.can.redo");
    page.press("#redo");
    page.press("#redo");
    page.wait("!studio.state.can.redo && !studio.state.run.pending && studio.shown.kind === 1");

    // What is exported is what the command line makes of the session, to the byte.
    let exported = download(&page, "result", "draped-source.obj", &browser.downloads());
    let session = download(&page, "session", "drape.session.json", &browser.downloads());
    fs::write(folder.path().join("exported.json"), session).unwrap();
    run(
        folder.path(),
        ["replay", "exported.json", "-o", "replayed.obj"],
    )
    .well();
    let replayed = fs::read(folder.path().join("replayed.obj")).unwrap();
    assert!(
        replayed == exported,
        "the replay differs from what was exported"
    );
}

/// Drags the marker of the landmark nearest to a place of the target a little along the surface.
fn drag_on_target(page: &Page, place: Place) {
    let from = find(page, "target", place);
    let before = page.value("studio.state.landmarks.map((l) => l.target.point)");
    page.drag(from, [from[0] - 9.0, from[1] + 4.0]);
    wait_for("the landmark to move", || {
        (page.value("studio.state.landmarks.map((l) => l.target.point)") != before).then_some(())
    });
    page.wait("studio.dragging === null && studio.state.can.undo");
}

/// What a link of the export menu gives.
fn download(page: &Page, what: &str, name: &str, folder: &Path) -> Vec<u8> {
    let path = folder.join(name);
    drop(fs::remove_file(&path));
    page.press("#export");
    page.press(&format!("#export-{what}"));
    wait_for(name, || {
        fs::read(&path).ok().filter(|bytes| !bytes.is_empty())
    })
}
