//! A large scan with a large picture opens soon, and in little memory: measured and printed.

use std::fs;
use std::io::Write as _;
use std::time::Instant;

use mesh_core::{shapes, Point3};

use super::browser::{browser, Page};
use super::glb::{glb, png, Painted};
use super::server::Server;
use crate::support::Workplace;

/// Seconds until the scan is seen with its picture, on an idle machine with two processors.
const OPENED: f64 = 20.0;
/// This many times as much is allowed on a busy machine, with a slower build and without a graphics card.
const BUSY: f64 = 6.0;
/// Kilobytes that the server takes at most.
const MEMORY: u64 = 2_000_000;

/// 1.4 million triangles: a lopsided ball with wrinkles.
fn scan() -> Painted {
    let mut soup = shapes::quad_sphere(342);
    let halves = |f: &Vec<u32>| [vec![f[0], f[1], f[2]], vec![f[0], f[2], f[3]]];
    soup.faces = soup.faces.iter().flat_map(halves).collect();
    let uvs = soup
        .positions
        .iter()
        .map(|p| [0.5 + 0.45 * p.x, 0.5 + 0.45 * p.y]);
    let uvs = uvs.collect();
    for p in &mut soup.positions {
        let bump = 1.0 + 0.3 * (2.0 * p.x + p.y).sin() + 0.005 * (60.0 * p.x * p.y).sin();
        *p = Point3::new(1.6 * p.x * bump, p.y * bump, 0.7 * p.z * bump);
    }
    Painted { soup, uvs }
}

/// The most memory that a process has had, in kilobytes; none where the system does not tell.
fn peak_memory(server: &Server) -> Option<u64> {
    let status = fs::read_to_string(format!("/proc/{}/status", server.id())).ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    line.trim().strip_suffix(" kB")?.parse().ok()
}

#[test]
fn a_scan_with_a_large_picture_opens() {
    let Some(browser) = browser() else { return };
    let place = Workplace::new();
    let painted = scan();
    assert!(painted.soup.faces.len() > 1_400_000);
    let color = |[x, y]: [u32; 2]| [(x >> 4) as u8, (y >> 4) as u8, ((x * y) >> 10) as u8];
    fs::write(place.path("scan.glb"), glb(&painted, &png(4096, color))).unwrap();
    drop(painted);

    let began = Instant::now();
    let server = Server::start(&place.path(""), &["source.obj", "scan.glb"]);
    let served = began.elapsed().as_secs_f64();
    let page = Page::open(&browser, &server.url, [1280, 800]);
    page.wait("studio.views.target.shape?.paint && studio.views.source.shape && !studio.views.target.isStale");
    page.settle();
    let fewer = page.value("studio.views.target.shape.paint.fewer.rows.length");
    let opened = began.elapsed().as_secs_f64();
    assert!(
        (1..100_000).contains(&fewer.as_u64().unwrap_or_default()),
        "{fewer}"
    );
    let memory = peak_memory(&server);
    // Past the test runner, which shows nothing that a passing test prints.
    let figures = format!(
        "studio: 1.4 million triangles with a picture of 4096 x 4096 are served after {served:.1} s and seen after {opened:.1} s, at first with fewer triangles; \
         the server had {:.2} GB\n",
        memory.unwrap_or_default() as f64 / 1e6
    );
    drop(std::io::stderr().write_all(figures.as_bytes()));
    assert!(opened < OPENED * BUSY, "{figures}");
    assert!(memory.is_none_or(|m| m < MEMORY), "{figures}");
}
