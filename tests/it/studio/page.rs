//! What tests do again and again on the studio's page.

use serde_json::{json, Value};

use super::browser::{point, Page};

/// Directions to look from, as yaw and pitch.
const LOOKS: [[f64; 2]; 8] = [
    [0.6, 0.25],
    [-0.6, 0.25],
    [1.6, 0.2],
    [-1.6, 0.2],
    [2.6, 0.25],
    [-2.6, 0.25],
    [0.3, 1.0],
    [0.3, -0.8],
];

/// A place of a shape, in the frame of its view.
pub(crate) type Place = [f64; 3];

/// Where a place of a shape is seen on the page, looked at from wherever it is not hidden.
pub(crate) fn find(page: &Page, side: &str, place: Place) -> [f64; 2] {
    for [yaw, pitch] in LOOKS {
        page.value(&format!(
            "studio.views.list.forEach((v) => v.camera.look({yaw}, {pitch})), studio.cameras.frameAll(), true"
        ));
        if let Some(at) = seen(page, side, place) {
            probed(page);
            return at;
        }
    }
    panic!("{place:?} is hidden on the {side}");
}

/// Waits until the page knows which markers are hidden.
pub(crate) fn probed(page: &Page) {
    page.settle();
    page.wait(
        "studio.views.list.every((v) => !v.isStale && !v.isUnprobed && v.probes.asked.size === 0)",
    );
}

/// Where a place is seen now; none where something is before it.
fn seen(page: &Page, side: &str, place: Place) -> Option<[f64; 2]> {
    let at = page.value(&format!(
        "(() => {{ const at = studio.onPage('{side}', {place:?}); return at && [at.x, at.y]; }})()"
    ));
    if at.is_null() {
        return None;
    }
    // A mouse stands on whole pixels; the nearest may miss the tip of an ear, one beside it does not.
    let [x, y] = point(&at).map(f64::round);
    let beside = [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [-1.0, 0.0], [0.0, -1.0]];
    let pixels = beside.map(|[right, down]| [x + right, y + down]);
    let mut pixels = pixels.into_iter();
    pixels.find(|&pixel| is_seen_at(page, side, place, pixel))
}

/// Whether a click there hits a place, to within two hundredths.
fn is_seen_at(page: &Page, side: &str, place: Place, [x, y]: [f64; 2]) -> bool {
    let picked = page.value(&format!(
        "(async () => {{ const view = studio.views.of('{side}'); \
         const hit = await studio.link.ask('query', {{ do: 'pick', shape: '{side}', ray: view.ray({{ clientX: {x}, clientY: {y} }}) }}); \
         return hit && (hit.target ?? view.shape.place(hit.source).point); }})()"
    ));
    !picked.is_null() && distance(&picked, place) < 0.02
}

pub(crate) fn distance(found: &Value, place: Place) -> f64 {
    let squares = (0..3).map(|k| (found[k].as_f64().unwrap_or(f64::NAN) - place[k]).powi(2));
    squares.sum::<f64>().sqrt()
}

/// Marks a place on the source and one on the target by clicking.
pub(crate) fn mark(page: &Page, on_source: Place, on_target: Place) {
    let before = n_landmarks(page);
    for (side, place) in [("source", on_source), ("target", on_target)] {
        let at = find(page, side, place);
        page.click(at);
        page.wait(&format!("studio.state.landmarks.length === {}", before + 1));
    }
    page.wait(&format!(
        "studio.state.landmarks.filter((l) => l.source && l.target).length === {}",
        before + 1
    ));
}

pub(crate) fn n_landmarks(page: &Page) -> u64 {
    let n = page.value("studio.state.landmarks.length");
    n.as_u64().unwrap_or_default()
}

/// Where a vertex is, in the frame of its view.
pub(crate) fn vertex(page: &Page, side: &str, row: u64) -> Place {
    let at = page.value(&format!("studio.views.of('{side}').shape.point({row})"));
    [0, 1, 2].map(|k| at[k].as_f64().unwrap_or(f64::NAN))
}

/// The positions that the result's view shows.
pub(crate) fn shown(page: &Page) -> Value {
    page.value("Array.from(studio.shown.positions)")
}

/// A figure that rose above another.
pub(crate) fn number(page: &Page, expression: &str) -> f64 {
    page.value(expression).as_f64().unwrap_or_else(|| {
        panic!(
            "{expression} is {}",
            page.value(&json!(expression).to_string())
        )
    })
}

/// The middle of a view.
pub(crate) fn middle(page: &Page, side: &str) -> [f64; 2] {
    point(&page.value(&format!(
        "(() => {{ const r = studio.views.of('{side}').element.getBoundingClientRect(); \
         return [Math.round(r.left + r.width / 2), Math.round(r.top + r.height / 2)]; }})()"
    )))
}

/// The colour in the middle of a view.
pub(crate) fn pixel(page: &Page, side: &str) -> [u64; 3] {
    pixel_beside(page, side, 0)
}

/// The colour so many pixels right of the middle of a view.
pub(crate) fn pixel_beside(page: &Page, side: &str, right: i32) -> [u64; 3] {
    let read = page.value(&format!(
        "(() => {{ const {{ gl, ratio }} = studio.painter.renderer; const b = studio.views.of('{side}').box; const out = new Uint8Array(4); \
         const [x, y] = [b.left + b.width / 2 + {right}, studio.views.size.height - b.top - b.height / 2].map((c) => Math.round(c * ratio)); \
         gl.readPixels(x, y, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, out); return [...out]; }})()"
    ));
    [0, 1, 2].map(|k| read[k].as_u64().unwrap_or_default())
}

/// Lets the graphics card forget everything, and waits until the page has drawn itself anew.
pub(crate) fn lose_graphics(page: &Page) {
    page.value("(globalThis.lose = studio.painter.renderer.gl.getExtension('WEBGL_lose_context')).loseContext(), true");
    page.wait("studio.painter.renderer.gl.isContextLost()");
    page.value("lose.restoreContext(), true");
    page.wait("!studio.painter.renderer.gl.isContextLost()");
    probed(page);
}
