//! Curves over the angle of limbs, as an SVG picture that stands alone.

use std::fmt::Write as _;

use super::pairs::Setting;
use super::spread::Spread;
use super::Theme;
use crate::suite::Row;

/// Size of one panel's axes, in user units.
const WIDTH: f64 = 260.0;
const HEIGHT: f64 = 180.0;
/// Around each panel: left, top; right and below is as much as left.
const MARGIN: [f64; 2] = [46.0, 34.0];
/// A colour for each variant, apart for the colour-blind, too (Okabe and Ito 2008).
const COLORS: [&str; 3] = ["#0072b2", "#d55e00", "#666666"];

/// Mean distance to the truth over the angle, a panel for each number of landmarks, a curve for each variant with bars of one
/// standard deviation over the seeds.
pub(super) fn svg(theme: &Theme, settings: &[Setting], rows: &[Row]) -> String {
    let mut numbers: Vec<usize> = settings.iter().map(|s| s.n_landmarks).collect();
    numbers.dedup();
    let points = |n: usize, preset: &str| -> Vec<(f64, Spread)> {
        let of_panel = settings.iter().filter(|s| s.n_landmarks == n);
        of_panel
            .filter_map(|s| Some((s.angle, at(s, preset, rows)?)))
            .collect()
    };
    let all = numbers.iter().flat_map(|&n| {
        theme
            .variants
            .iter()
            .flat_map(move |(_, preset)| points(n, preset))
    });
    let top = |(_, s): (f64, Spread)| s.mean + s.deviation.unwrap_or(0.0);
    let highest = all.map(top).fold(f64::MIN_POSITIVE, f64::max);
    let axes = Axes {
        angles: angles(settings),
        highest,
    };
    let pitch = WIDTH + 2.0 * MARGIN[0];
    let (width, height) = (pitch * numbers.len() as f64, HEIGHT + 3.0 * MARGIN[1]);
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"11\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
    );
    for (column, &n) in numbers.iter().enumerate() {
        let left = pitch * column as f64 + MARGIN[0];
        let _ = writeln!(text, "<g transform=\"translate({left} {})\">", MARGIN[1]);
        text += &axes.drawn(&format!("{n} landmarks"));
        for ((label, preset), color) in theme.variants.iter().zip(COLORS) {
            text += &axes.curve(&points(n, preset), label, color);
        }
        text += "</g>\n";
    }
    text + "</svg>\n"
}

fn at(setting: &Setting, preset: &str, rows: &[Row]) -> Option<Spread> {
    let name = setting.name();
    let is_here = |row: &&Row| row.pair == name && row.preset == preset;
    let here: Vec<&Row> = rows.iter().filter(is_here).collect();
    Spread::of_rows(&here, |row| row.figure("truth_mean"))
}

fn angles(settings: &[Setting]) -> [f64; 2] {
    let angles = settings.iter().map(|s| s.angle);
    angles.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], a| {
        [low.min(a), high.max(a)]
    })
}

/// Where a value lies in a panel.
struct Axes {
    /// Smallest and largest angle, in degrees.
    angles: [f64; 2],
    /// The largest distance, in longest sides.
    highest: f64,
}

impl Axes {
    fn x(&self, angle: f64) -> f64 {
        let [low, high] = self.angles;
        WIDTH * (angle - low) / (high - low).max(f64::MIN_POSITIVE)
    }

    fn y(&self, distance: f64) -> f64 {
        HEIGHT * (1.0 - distance / self.highest)
    }

    fn drawn(&self, title: &str) -> String {
        let [low, high] = self.angles;
        let highest = 100.0 * self.highest;
        format!(
            "<text x=\"0\" y=\"-12\" font-weight=\"bold\">{title}</text>\n\
             <path d=\"M0 0V{HEIGHT}H{WIDTH}\" fill=\"none\" stroke=\"#000\"/>\n\
             <text x=\"-6\" y=\"4\" text-anchor=\"end\">{highest:.1}</text>\n\
             <text x=\"-6\" y=\"{HEIGHT}\" text-anchor=\"end\">0</text>\n\
             <text x=\"0\" y=\"{below}\" text-anchor=\"middle\">{low}°</text>\n\
             <text x=\"{WIDTH}\" y=\"{below}\" text-anchor=\"middle\">{high}°</text>\n\
             <text x=\"{middle}\" y=\"{below}\" text-anchor=\"middle\">truth e-2 over the angle of limbs</text>\n",
            below = HEIGHT + 16.0,
            middle = 0.5 * WIDTH,
        )
    }

    fn curve(&self, points: &[(f64, Spread)], label: &str, color: &str) -> String {
        let mut line = String::new();
        let mut bars = String::new();
        for (angle, spread) in points {
            let (x, y) = (self.x(*angle), self.y(spread.mean));
            let command = if line.is_empty() { 'M' } else { 'L' };
            let _ = write!(line, "{command}{x:.1} {y:.1}");
            let d = spread.deviation.unwrap_or(0.0);
            let (low, high) = (self.y((spread.mean - d).max(0.0)), self.y(spread.mean + d));
            let _ = write!(bars, "M{x:.1} {low:.1}V{high:.1}");
        }
        let (x, y) = points
            .last()
            .map_or((0.0, 0.0), |(angle, s)| (self.x(*angle), self.y(s.mean)));
        format!(
            "<path d=\"{line}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"2\"/><path d=\"{bars}\" stroke=\"{color}\"/>\n\
             <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\" fill=\"{color}\">{label}</text>\n",
            x - 4.0,
            y - 6.0
        )
    }
}
