//! What was scanned is seen: pictures, colours of vertices, wrinkles; and from where one looks.

use std::f64::consts::{FRAC_PI_2, PI};
use std::fs;

use serde_json::json;

use super::browser::{browser, Page};
use super::glb::{ball, glb, png};
use super::page::{lose_graphics, middle, pixel, pixel_beside, probed};
use super::server::Server;
use crate::support::Workplace;

/// A bitmap of one colour.
fn bitmap(color: [u8; 3]) -> Vec<u8> {
    striped([color; 4])
}

/// A bitmap with a colour for each column.
fn striped(colors: [[u8; 3]; 4]) -> Vec<u8> {
    let side = 4_u32;
    let mut bytes = b"BM".to_vec();
    for n in [54 + 3 * side * side, 0, 54, 40, side, side] {
        bytes.extend(n.to_le_bytes());
    }
    bytes.extend([1, 0, 24, 0]);
    bytes.extend([0; 24]);
    let row: Vec<u8> = colors.iter().flat_map(|[r, g, b]| [*b, *g, *r]).collect();
    bytes.extend(row.repeat(4));
    bytes
}

/// The target of the standard pair as text, green all over.
fn green_scan(place: &Workplace) {
    let soup =
        mesh_core::io::read_soup(place.path("target.ply")).expect("the workplace has a target");
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\nelement face {}\n\
         property list uchar int vertex_indices\nend_header\n",
        soup.positions.len(),
        soup.faces.len()
    );
    for p in &soup.positions {
        text += &format!("{} {} {} 10 220 10\n", p.x, p.y, p.z);
    }
    for f in &soup.faces {
        text += &format!("3 {} {} {}\n", f[0], f[1], f[2]);
    }
    place.write("green.ply", &text);
}

#[test]
fn the_picture_inside_a_glb_is_seen() {
    let Some(browser) = browser() else { return };
    let place = Workplace::new();
    fs::write(
        place.path("red.glb"),
        glb(&ball(), &png(4, |_| [220, 20, 20])),
    )
    .unwrap();
    fs::write(
        place.path("green.glb"),
        glb(&ball(), &png(4, |_| [20, 200, 20])),
    )
    .unwrap();
    let server = Server::start(&place.path(""), &["red.glb", "green.glb"]);
    let page = Page::open(&browser, &server.url, [1280, 800]);
    page.wait("studio.views.result.shape?.paint && studio.views.target.shape.paint");
    page.press("input[name=style][value=shaded]");
    probed(&page);
    for (side, channel) in [("source", 0), ("target", 1), ("result", 0)] {
        let color = pixel(&page, side);
        assert!(is_mostly(&page, side, channel), "{side} {color:?}");
    }
}

fn is_mostly(page: &Page, side: &str, channel: usize) -> bool {
    is_of(pixel(page, side), channel)
}

fn is_of(color: [u64; 3], channel: usize) -> bool {
    (0..3).all(|k| k == channel || color[k] + 60 < color[channel])
}

#[test]
fn a_textured_creature_is_marked_from_its_texture() {
    let Some(browser) = browser() else { return };
    let place = Workplace::new();
    green_scan(&place);
    place.write("not_there.mtl", "newmtl skin\nmap_Kd skin.bmp\n");
    fs::write(place.path("skin.bmp"), bitmap([220, 20, 20])).unwrap();
    let server = Server::start(&place.path(""), &[]);
    let page = Page::open(&browser, &server.url, [1280, 800]);
    page.wait("studio.state");
    let files = ["source.obj", "not_there.mtl", "skin.bmp"].map(|name| place.path(name));
    page.drop_files(middle(&page, "source"), &files);
    page.wait("studio.views.source.shape?.paint");
    page.drop_files(middle(&page, "target"), &[place.path("green.ply")]);
    page.wait("studio.views.target.shape?.paint && studio.views.result.shape");
    page.press("input[name=style][value=shaded]");
    probed(&page);
    assert!(
        is_mostly(&page, "source", 0),
        "{:?}",
        pixel(&page, "source")
    );
    assert!(
        is_mostly(&page, "target", 1),
        "{:?}",
        pixel(&page, "target")
    );
    assert!(
        is_mostly(&page, "result", 0),
        "{:?}",
        pixel(&page, "result")
    );
    for side in ["source", "target"] {
        page.click(middle(&page, side));
        page.wait(&format!("studio.state.landmarks[0]?.{side}"));
    }

    // Wrinkles and clay have no pictures.
    page.key("v", 86, 0);
    page.wait("studio.preferences.look === 'matcap'");
    probed(&page);
    assert!(!is_mostly(&page, "source", 0));
    page.key("v", 86, 0);
    page.key("v", 86, 0);
    page.wait("studio.preferences.look === 'scan'");
    // The graphics card forgets the pictures, too.
    lose_graphics(&page);
    assert!(
        is_mostly(&page, "source", 0),
        "{:?}",
        pixel(&page, "source")
    );
}

/// A sheet whose left half shows the left half of a picture and whose right half the right one.
fn seamed_sheet(place: &Workplace) {
    let (columns, rows) = (9, 7);
    let mut text = "mtllib seam.mtl\nvt 0.25 0.5\nvt 0.75 0.5\nusemtl skin\n".to_owned();
    for k in 0..columns * rows {
        let (x, y) = (k % columns, k / columns);
        text += &format!("v {x} {y} {}\n", 0.02 * f64::from(x * y));
    }
    for y in 0..rows - 1 {
        for x in 0..columns - 1 {
            let uv = 1 + 2 * x / (columns - 1);
            let at = 1 + y * columns + x;
            let [b, c, d] = [at + 1, at + columns + 1, at + columns];
            text += &format!("f {at}/{uv} {b}/{uv} {c}/{uv} {d}/{uv}\n");
        }
    }
    place.write("sheet.obj", &text);
    place.write("seam.mtl", "newmtl skin\nmap_Kd seam.bmp\n");
    let (red, green) = ([220, 20, 20], [20, 200, 20]);
    fs::write(place.path("seam.bmp"), striped([red, red, green, green]))
        .expect("a picture is written");
}

#[test]
fn a_seam_of_a_picture_is_sharp() {
    let Some(browser) = browser() else { return };
    let place = Workplace::new();
    seamed_sheet(&place);
    let server = Server::start(&place.path(""), &["source.obj", "sheet.obj"]);
    let page = Page::open(&browser, &server.url, [1280, 800]);
    page.wait("studio.views.target.shape?.paint && studio.views.result.shape");
    // The seven vertices of the middle line are there twice, no other one is.
    assert_eq!(
        page.value("studio.views.target.shape.paint.copies.length"),
        json!(7)
    );
    page.press("input[name=style][value=shaded]");
    page.press("[data-look=front]");
    probed(&page);
    for (right, channel) in [(-12, 0), (-3, 0), (3, 1), (12, 1)] {
        let color = pixel_beside(&page, "target", right);
        assert!(is_of(color, channel), "{right}: {color:?}");
    }
}

#[test]
fn cameras_look_from_all_sides_with_and_without_perspective() {
    let Some(browser) = browser() else { return };
    let place = Workplace::new();
    let server = Server::start(&place.path(""), &["source.obj", "target.ply"]);
    let page = Page::open(&browser, &server.url, [1280, 800]);
    page.wait("studio.views.result.shape");
    for (key, [yaw, pitch]) in [
        ("1", [0.0, 0.0]),
        ("2", [PI, 0.0]),
        ("4", [-FRAC_PI_2, 0.0]),
        ("8", [0.0, -FRAC_PI_2]),
    ] {
        page.key(key, 0, 0);
        let look = page.value("[studio.views.source.camera.yaw, studio.views.source.camera.pitch]");
        let off = |k: usize, x: f64| (look[k].as_f64().unwrap() - x).abs() < 1e-3;
        assert!(off(0, yaw) && off(1, pitch), "{key}: {look}");
    }
    page.press("[data-look=front]");
    for is_flat in [false, true] {
        // A place is picked where it is drawn.
        let apart = page.value(
            "(async () => { const view = studio.views.source; const r = view.element.getBoundingClientRect(); \
             const at = { clientX: r.left + 0.6 * r.width, clientY: r.top + 0.45 * r.height }; \
             const hit = await studio.link.ask('query', { do: 'pick', shape: 'source', ray: view.ray(at) }); \
             const seen = view.project(view.shape.place(hit.source).point); \
             return Math.hypot(seen.x + r.left - at.clientX, seen.y + r.top - at.clientY); })()",
        );
        assert!(
            apart.as_f64().is_some_and(|d| d < 1.0),
            "{is_flat}: {apart}"
        );
        page.key("5", 0, 0);
    }
    assert_eq!(
        page.value("studio.views.target.camera.isFlat"),
        json!(false)
    );
    // The wheel comes nearer to what is under the pointer.
    let kept = page.value(
        "(() => { const view = studio.views.target; const r = view.element.getBoundingClientRect(); const p = view.shape.point(0); \
         const before = view.project(p); const at = { clientX: r.left + before.x, clientY: r.top + before.y }; \
         const d = view.camera.distance; \
         view.element.dispatchEvent(new WheelEvent('wheel', { ...at, deltaY: -300, cancelable: true, bubbles: true })); \
         return [view.camera.distance < d]; })()",
    );
    assert_eq!(kept, json!([true]));
    // One view large, and all again.
    page.key("x", 88, 0);
    page.wait("studio.views.list.filter((v) => v.element.offsetParent).length === 1 && studio.views.list.some((v) => v.box.width > 700)");
    page.key("x", 88, 0);
    page.wait("studio.views.list.every((v) => v.box.width > 200)");
}
