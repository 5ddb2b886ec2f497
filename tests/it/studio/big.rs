//! Large shapes stay interactive. Where `DRAPE_PICTURES` names a folder, the times are written there.

use std::time::{Duration, Instant};

use mesh_core::{io, shapes, Point3, PolygonSoup};

use super::browser::{browser, Page};
use super::server::Server;

/// A lopsided ball, so that it stands in one way only.
fn ball(mut soup: PolygonSoup, stretch: f64) -> PolygonSoup {
    for p in &mut soup.positions {
        let bump = 1.0 + 0.3 * (2.0 * p.x + p.y).sin() + 0.2 * (3.0 * p.z).cos();
        *p = Point3::new(stretch * p.x * bump, p.y * bump, 0.7 * p.z * bump);
    }
    soup
}

fn triangles(mut soup: PolygonSoup) -> PolygonSoup {
    let halves = |f: &Vec<u32>| [vec![f[0], f[1], f[2]], vec![f[0], f[2], f[3]]];
    soup.faces = soup.faces.iter().flat_map(halves).collect();
    soup
}

/// The asked times hold on an idle machine with two processors; this many times as much is allowed on a busy one.
const BUSY: f64 = 8.0;

#[test]
fn large_shapes_are_interactive() {
    let Some(browser) = browser() else { return };
    let folder = tempfile::tempdir().unwrap();
    let source = ball(shapes::quad_sphere(129), 1.0);
    let target = triangles(ball(shapes::quad_sphere(204), 1.6));
    assert!(source.positions.len() > 99_000 && target.faces.len() > 499_000);
    io::write_soup(folder.path().join("source.ply"), &source).unwrap();
    io::write_soup(folder.path().join("target.ply"), &target).unwrap();

    let began = Instant::now();
    let server = Server::start(folder.path(), &["source.ply", "target.ply"]);
    let served = began.elapsed();
    let page = Page::open(&browser, &server.url, [1280, 800]);
    page.wait("studio.views.source.shape && studio.views.target.shape");
    page.settle();
    let interactive = began.elapsed();

    page.wait("studio.views.result.shape");
    let first_preview = began.elapsed();
    let mut clicks = Vec::new();
    let mut previews = Vec::new();
    for k in 0..6 {
        let before = page.value("studio.frame.serial");
        for side in ["source", "target"] {
            let middle = page.value(&format!(
                "(() => {{ const r = studio.views.of('{side}').element.getBoundingClientRect(); return [r.left + r.width / 2 + {} , r.top + r.height / 2 + {}]; }})()",
                12 * k - 30, 9 * (k % 3) - 9
            ));
            let time = page.value(&format!(
                "new Promise((done) => {{ const n = JSON.stringify(studio.state.landmarks); const t = performance.now(); \
                 const look = () => JSON.stringify(studio.state.landmarks) !== n ? done(performance.now() - t) : setTimeout(look, 1); \
                 studio.place(studio.views.of('{side}'), studio.views.of('{side}').ray({{ clientX: {}, clientY: {} }})); look(); }})",
                middle[0], middle[1]
            ));
            clicks.push(time.as_f64().unwrap() / 1000.0);
        }
        let edited = Instant::now();
        page.wait(&format!("studio.frame.serial !== {before}"));
        if k >= 3 {
            previews.push(edited.elapsed().as_secs_f64());
        }
        page.wait("studio.figures");
    }
    let worst = |times: &[f64]| times.iter().copied().fold(0.0, f64::max);
    let report = format!(
        "served {:.1} s, interactive {:.1} s, first preview {:.1} s, clicks {clicks:.3?}, previews {previews:.2?}\n",
        served.as_secs_f64(),
        interactive.as_secs_f64(),
        first_preview.as_secs_f64(),
    );
    if let Some(place) = std::env::var_os("DRAPE_PICTURES") {
        std::fs::write(std::path::Path::new(&place).join("big.txt"), &report).unwrap();
        std::fs::write(std::path::Path::new(&place).join("big.png"), page.picture()).unwrap();
    }
    assert!(
        interactive < Duration::from_secs_f64(10.0 * BUSY),
        "{report}"
    );
    assert!(worst(&clicks) < 0.15 * BUSY, "{report}");
}
