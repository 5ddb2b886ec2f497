//! The ways in: files that are dropped, fingers, mirrored places, inner pieces; and the report on the way out.

use std::fs;

use serde_json::{json, Value};

use super::browser::{browser, wait_for, Page};
use super::page::{find, middle, n_landmarks, probed, Place};
use super::server::Server;
use crate::regions::{head_on_skin, HEAD, SKIN};
use crate::support::Workplace;

/// The standard pair in a browser.
fn page() -> Option<(Workplace, Server, Page)> {
    let browser = browser()?;
    let place = Workplace::new();
    let server = Server::start(&place.path(""), &["source.obj", "target.ply"]);
    let page = Page::open(&browser, &server.url, [1280, 800]);
    page.wait("studio.views.result.shape");
    Some((place, server, page))
}

#[test]
fn files_are_dropped_into_the_page() {
    let Some(browser) = browser() else { return };
    let place = Workplace::new();
    let server = Server::start(&place.path(""), &[]);
    let page = Page::open(&browser, &server.url, [1280, 800]);
    page.wait("studio.state");
    for (side, file, until) in [
        (
            "target",
            "target.ply",
            "studio.state.target?.name === 'target.ply'",
        ),
        (
            "source",
            "source.obj",
            "studio.state.source?.name === 'source.obj'",
        ),
        (
            "result",
            "landmarks.json",
            "studio.state.landmarks.length === 6",
        ),
    ] {
        page.drop_files(middle(&page, side), &[place.path(file)]);
        page.wait(until);
    }
    page.wait("studio.views.result.shape && studio.figures.landmark_rms < 0.01");
    assert!(page
        .value("document.querySelector('.is-target-of-drop')")
        .is_null());
}

#[test]
fn a_source_a_target_and_landmarks_are_dropped_at_once() {
    let Some(browser) = browser() else { return };
    let place = Workplace::new();
    let server = Server::start(&place.path(""), &[]);
    let page = Page::open(&browser, &server.url, [1280, 800]);
    page.wait("studio.state");
    let files = ["landmarks.json", "source.obj", "target.ply"].map(|name| place.path(name));
    page.drop_files(middle(&page, "result"), &files);
    page.wait(
        "studio.state.source?.name === 'source.obj' && studio.state.target?.name === 'target.ply'",
    );
    page.wait("studio.state.landmarks.length === 6");
}

#[test]
fn fingers_mark_turn_and_zoom() {
    let Some((_place, _server, page)) = page() else {
        return;
    };
    for side in ["source", "target"] {
        let at = middle(&page, side);
        page.touch("touchStart", &[at]);
        page.touch("touchEnd", &[]);
        page.wait("studio.state.landmarks.length === 1");
    }
    page.wait("studio.state.landmarks[0].source && studio.state.landmarks[0].target");

    let camera = |what: &str| page.value(&format!("studio.views.source.camera.{what}"));
    let [x, y] = middle(&page, "source");
    let (yaw, distance) = (camera("yaw"), camera("distance"));
    // Beside the marker, one finger turns.
    page.touch("touchStart", &[[x + 60.0, y + 60.0]]);
    page.touch("touchMove", &[[x + 90.0, y + 60.0]]);
    page.touch("touchEnd", &[]);
    assert_ne!(camera("yaw"), yaw);
    assert_eq!(camera("distance"), distance);
    // Two that go apart come nearer.
    page.touch("touchStart", &[[x - 60.0, y + 60.0], [x + 60.0, y + 60.0]]);
    page.touch("touchMove", &[[x - 90.0, y + 60.0], [x + 90.0, y + 60.0]]);
    page.touch("touchEnd", &[]);
    assert!(camera("distance").as_f64() < distance.as_f64());
    assert_eq!(n_landmarks(&page), 1);
}

#[test]
fn a_mirrored_landmark_has_a_twin() {
    let Some((_place, server, page)) = page() else {
        return;
    };
    // What is said of the landmarks moves what is below.
    page.wait("studio.state.warnings.length > 0");
    // Nothing lies over what is below the warnings.
    let over = page.value(
        "(() => { const r = document.querySelector('#mirror').getBoundingClientRect(); \
         const top = document.elementFromPoint(r.left + r.width / 2, r.top + r.height / 2); \
         return top && top.id; })()",
    );
    assert_eq!(over, json!("mirror"));
    page.press("#mirror");
    page.wait("studio.state.mirror");
    for side in ["source", "target"] {
        page.value(&format!("(() => {{ const s = document.getElementById('mirror-{side}'); s.value = '0'; s.dispatchEvent(new Event('change')); return 1; }})()"));
    }
    page.wait("String(studio.state.mirror) === '0,0'");
    // To the right of the front, in the frame of each view.
    for (side, place) in [("source", [0.3, 0.2, 0.346]), ("target", [0.3, 0.2, 0.19])] {
        let at = find(&page, side, nearest(&page, side, place));
        page.click(at);
        page.wait(&format!("studio.state.landmarks[0]?.{side}"));
    }
    page.wait("studio.state.landmarks.length === 2 && studio.state.landmarks[1].target");
    for side in ["source", "target"] {
        let at = |k: u32| {
            let p = page.value(&format!(
                "studio.views.{side}.place(studio.state.landmarks[{k}]).point"
            ));
            [0, 1, 2].map(|c| p[c].as_f64().unwrap())
        };
        let (one, other): (Place, Place) = (at(0), at(1));
        let image = [-one[0], one[1], one[2]];
        let off: f64 = (0..3).map(|c| (image[c] - other[c]).powi(2)).sum();
        assert!(
            one[0] > 0.1 && off.sqrt() < 0.01,
            "{side}: {one:?} {other:?}"
        );
    }
    // Both are one edit.
    page.press("#undo");
    page.wait("studio.state.landmarks.length === 1");
    drop(server);
}

/// The vertex of a shape that is nearest to a place.
fn nearest(page: &Page, side: &str, place: Place) -> Place {
    let found = page.value(&format!(
        "(() => {{ const s = studio.views.{side}.shape; const n = s.positions.length / 3; let best = [Infinity]; \
         for (let v = 0; v < n; v++) {{ const p = s.point(v); const d = Math.hypot(p[0] - {}, p[1] - {}, p[2] - {}); \
         if (d < best[0]) best = [d, ...p]; }} return best.slice(1); }})()",
        place[0], place[1], place[2]
    ));
    [0, 1, 2].map(|c| found[c].as_f64().expect("a number"))
}

#[test]
fn a_marker_behind_the_shape_is_not_shown_before_it() {
    let Some((place, _server, page)) = page() else {
        return;
    };
    page.press("#open-landmarks");
    page.choose_file(&place.path("landmarks.json"));
    page.wait("studio.state.landmarks.length === 6");
    let is_behind = |side: &str, k: u32| {
        let marker = format!(
            "studio.views.{side}.markers.get(studio.state.landmarks[{k}].id).classList.contains('is-behind')"
        );
        page.value(&marker)
    };
    // The fifth landmark is in front, the sixth behind.
    for (yaw, hidden) in [(0.0, 5), (std::f64::consts::PI, 4)] {
        page.value(&format!("studio.cameras.look({yaw}, 0.1), true"));
        probed(&page);
        page.settle();
        for side in ["source", "target"] {
            for k in [4, 5] {
                assert_eq!(
                    is_behind(side, k),
                    json!(k == hidden),
                    "{side} {k} from {yaw}"
                );
            }
        }
    }
}

#[test]
fn inner_pieces_are_proposed() {
    let Some(browser) = browser() else { return };
    let place = head_on_skin();
    let server = Server::start(&place.path(""), &[HEAD, SKIN]);
    let page = Page::open(&browser, &server.url, [1280, 800]);
    page.wait("studio.state.inner?.length === 4 && studio.views.source.shape");
    let ways = page.value("studio.state.inner.map((part) => part.unasked)");
    let n_rigid = ways.as_array().unwrap().iter().filter(|w| *w == "rigid");
    assert_eq!(n_rigid.count(), 3, "{ways}");

    // One is draped like the rest, then made what is proposed with one click.
    let row = "document.querySelector('#inner li')";
    page.value(&format!("(() => {{ const s = {row}.querySelector('select'); s.value = 'draped'; s.dispatchEvent(new Event('change')); return 1; }})()"));
    page.wait("studio.state.parts.draped?.[0] === 'hidden:1'");
    page.wait(&format!("!{row}.querySelector('button').hidden"));
    page.press("#inner li button");
    page.wait("studio.state.parts.draped === undefined && [...studio.state.parts.rigid, ...studio.state.parts.free].includes('hidden:1')");
    page.wait(&format!("{row}.querySelector('button').hidden"));
    // What is pointed out has faces to be shown.
    page.value("studio.parts.pointOut('hidden:1')");
    page.wait("studio.parts.pointedRanges.length > 0");
}

#[test]
fn the_report_is_exported() {
    let Some((place, server, page)) = page() else {
        return;
    };
    page.press("#open-landmarks");
    page.choose_file(&place.path("landmarks.json"));
    page.wait("studio.state.landmarks.length === 6 && studio.figures?.landmark_rms < 0.01");
    let folder = page.downloads();
    page.press("#export");
    page.press("#export-report");
    let report = wait_for("the report", || {
        fs::read_to_string(folder.join("report.html"))
            .ok()
            .filter(|t| !t.is_empty())
    });
    for part in [
        "<html",
        "A drape made in the studio",
        "data:image/png;base64,",
    ] {
        assert!(report.contains(part), "{part}");
    }
    page.press("#export");
    page.press("#export-landmarks");
    let landmarks = wait_for("the landmarks", || {
        fs::read_to_string(folder.join("landmarks.json"))
            .ok()
            .filter(|t| !t.is_empty())
    });
    let landmarks: Value = serde_json::from_str(&landmarks).unwrap();
    assert_eq!(landmarks["landmarks"].as_array().map(Vec::len), Some(6));
    place.write("exported.json", &landmarks.to_string());
    place
        .drape("landmarks check source.obj target.ply exported.json")
        .well();
    drop(server);
}
