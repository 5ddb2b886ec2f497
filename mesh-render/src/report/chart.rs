//! Loss curves as inline SVG: one small chart for each term, since their scales differ.

use std::fmt::Write as _;

use mesh_draping::Curve;

use super::html::escape;

const WIDTH: f64 = 240.0;
const HEIGHT: f64 = 96.0;
/// Points drawn of a curve; the rest would fall on the same pixels.
const MAX_POINTS: usize = 240;
/// Ratio of the largest to the smallest value from which a logarithmic axis reads better.
const LOG_RATIO: f64 = 20.0;

/// A figure with the curve, its largest and smallest value and its length.
pub(super) fn chart(curve: &Curve) -> String {
    let values = || curve.points.iter().map(|p| p.1).filter(|v| v.is_finite());
    let (low, high) = values().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
        (l.min(v), h.max(v))
    });
    let n = curve.points.last().map_or(0, |p| p.0 + 1);
    if low > high {
        return String::new();
    }
    let is_log = low > 0.0 && high / low > LOG_RATIO;
    let first = curve.points[0].0;
    let axis = Axis { low, high, is_log };
    let mut path = String::new();
    for &(iteration, value) in thin(&curve.points).filter(|p| p.1.is_finite()) {
        let x = WIDTH * (iteration - first) as f64 / (n - 1 - first).max(1) as f64;
        let y = HEIGHT * (1.0 - axis.share(value));
        let command = if path.is_empty() { 'M' } else { 'L' };
        let _ = write!(path, "{command}{x:.1} {y:.1}");
    }
    format!(
        "<figure class=\"chart\"><figcaption>{name}{scale}</figcaption>\
         <svg viewBox=\"-2 -2 {w} {h}\" preserveAspectRatio=\"none\" role=\"img\" aria-label=\"{name} over the run\">\
         <path class=\"axis\" d=\"M0 0V{HEIGHT}H{WIDTH}\"/><path class=\"curve\" d=\"{path}\"/></svg>\
         <p><span>{high}</span><span>{low}</span><span>{n}</span></p></figure>",
        name = escape(curve.name),
        scale = if is_log { " <small>log</small>" } else { "" },
        w = WIDTH + 4.0,
        h = HEIGHT + 4.0,
        high = short(high),
        low = short(low),
    )
}

/// At most [`MAX_POINTS`] of the points, ends included.
fn thin(points: &[(usize, f64)]) -> impl Iterator<Item = &(usize, f64)> {
    let step = points.len().div_ceil(MAX_POINTS).max(1);
    let last = points.len().saturating_sub(1);
    points
        .iter()
        .enumerate()
        .filter(move |(k, _)| k % step == 0 || *k == last)
        .map(|(_, p)| p)
}

struct Axis {
    low: f64,
    high: f64,
    is_log: bool,
}

impl Axis {
    /// Where a value is between the smallest (0) and the largest (1).
    fn share(&self, value: f64) -> f64 {
        let place = |v: f64| if self.is_log { v.ln() } else { v };
        let range = place(self.high) - place(self.low);
        if range > 0.0 {
            (place(value) - place(self.low)) / range
        } else {
            0.5
        }
    }
}

/// Three significant digits.
pub(super) fn short(value: f64) -> String {
    let size = value.abs();
    if size != 0.0 && !(1e-3..1e5).contains(&size) {
        return format!("{value:.2e}");
    }
    let decimals = if size >= 100.0 {
        0
    } else if size >= 10.0 {
        1
    } else if size >= 1.0 {
        2
    } else {
        4
    };
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(points: Vec<(usize, f64)>) -> Curve {
        Curve {
            name: "a & b",
            points,
        }
    }

    #[test]
    fn the_path_spans_the_picture_and_the_name_is_escaped() {
        let svg = chart(&curve((0..1000).map(|k| (k, 1000.0 - k as f64)).collect()));
        assert!(svg.contains("M0.0 0.0") && svg.contains(&format!("L{WIDTH:.1} {HEIGHT:.1}")));
        assert!(svg.contains("a &amp; b") && svg.contains("log"));
        assert!(svg.matches('L').count() <= MAX_POINTS + 1);
    }

    #[test]
    fn constant_single_and_empty_curves_draw() {
        assert!(chart(&curve(vec![(0, 2.0), (1, 2.0)])).contains("M0.0 48.0"));
        assert!(chart(&curve(vec![(3, 2.0)])).contains("M0.0 48.0"));
        assert!(chart(&curve(vec![])).is_empty());
        assert!(chart(&curve(vec![(0, f64::NAN)])).is_empty());
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!(
            [0.0, 0.25, 3.0, 12345.6, 1e-7].map(short),
            ["0.0000", "0.2500", "3.00", "12346", "1.00e-7"]
        );
    }
}
