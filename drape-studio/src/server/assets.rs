//! The page, embedded in the program.

use axum::extract::Path;
use axum::http::{header, StatusCode};
use axum::response::{IntoResponse, Response};

const HTML: &str = "text/html; charset=utf-8";
const CSS: &str = "text/css; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";
const SVG: &str = "image/svg+xml";

/// Name, type and text of every file.
const FILES: [(&str, &str, &str); 36] = [
    ("index.html", HTML, include_str!("../../assets/index.html")),
    ("style.css", CSS, include_str!("../../assets/style.css")),
    ("icon.svg", SVG, include_str!("../../assets/icon.svg")),
    ("app.js", SCRIPT, include_str!("../../assets/app.js")),
    ("link.js", SCRIPT, include_str!("../../assets/link.js")),
    ("maths.js", SCRIPT, include_str!("../../assets/maths.js")),
    ("camera.js", SCRIPT, include_str!("../../assets/camera.js")),
    ("shapes.js", SCRIPT, include_str!("../../assets/shapes.js")),
    (
        "renderer.js",
        SCRIPT,
        include_str!("../../assets/renderer.js"),
    ),
    ("views.js", SCRIPT, include_str!("../../assets/views.js")),
    ("panels.js", SCRIPT, include_str!("../../assets/panels.js")),
    (
        "cameras.js",
        SCRIPT,
        include_str!("../../assets/cameras.js"),
    ),
    (
        "commands.js",
        SCRIPT,
        include_str!("../../assets/commands.js"),
    ),
    (
        "painter.js",
        SCRIPT,
        include_str!("../../assets/painter.js"),
    ),
    (
        "colours.js",
        SCRIPT,
        include_str!("../../assets/colours.js"),
    ),
    ("brush.js", SCRIPT, include_str!("../../assets/brush.js")),
    (
        "weights.js",
        SCRIPT,
        include_str!("../../assets/weights.js"),
    ),
    ("curves.js", SCRIPT, include_str!("../../assets/curves.js")),
    ("cursor.js", SCRIPT, include_str!("../../assets/cursor.js")),
    ("detail.js", SCRIPT, include_str!("../../assets/detail.js")),
    ("files.js", SCRIPT, include_str!("../../assets/files.js")),
    ("paint.js", SCRIPT, include_str!("../../assets/paint.js")),
    ("loupe.js", SCRIPT, include_str!("../../assets/loupe.js")),
    ("ring.js", SCRIPT, include_str!("../../assets/ring.js")),
    ("sculpt.js", SCRIPT, include_str!("../../assets/sculpt.js")),
    ("strip.js", SCRIPT, include_str!("../../assets/strip.js")),
    ("heats.js", SCRIPT, include_str!("../../assets/heats.js")),
    ("hover.js", SCRIPT, include_str!("../../assets/hover.js")),
    (
        "markers.js",
        SCRIPT,
        include_str!("../../assets/markers.js"),
    ),
    ("memory.js", SCRIPT, include_str!("../../assets/memory.js")),
    ("parts.js", SCRIPT, include_str!("../../assets/parts.js")),
    ("probes.js", SCRIPT, include_str!("../../assets/probes.js")),
    ("stage.js", SCRIPT, include_str!("../../assets/stage.js")),
    ("words.js", SCRIPT, include_str!("../../assets/words.js")),
    ("chart.js", SCRIPT, include_str!("../../assets/chart.js")),
    ("keys.js", SCRIPT, include_str!("../../assets/keys.js")),
];

/// The page.
pub(super) async fn index() -> Response {
    answer("index.html")
}

/// A file of the page.
pub(super) async fn file(Path(name): Path<String>) -> Response {
    answer(&name)
}

fn answer(name: &str) -> Response {
    match FILES.iter().find(|(known, ..)| *known == name) {
        Some((_, kind, text)) => ([(header::CONTENT_TYPE, *kind)], *text).into_response(),
        None => StatusCode::NOT_FOUND.into_response(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh_render::color::{hex, HEAT_STOPS};

    #[test]
    fn the_page_has_the_colours_of_the_report() {
        for name in ["heats.js", "style.css"] {
            let file = FILES.iter().find(|(known, ..)| *known == name);
            let (.., text) = file.unwrap();
            for stop in HEAT_STOPS {
                assert!(text.contains(&hex(stop)), "{name}: {}", hex(stop));
            }
        }
    }

    /// Every module that a file of the page names is served.
    #[test]
    fn no_file_is_missing() {
        for (name, _, text) in FILES {
            for part in text.split("from \"./").skip(1) {
                let asked = part.split('"').next().unwrap();
                assert!(
                    FILES.iter().any(|(known, ..)| *known == asked),
                    "{name}: {asked}"
                );
            }
        }
    }
}
