//! The tables of a study: one for each thing that is changed.

use std::fmt::Write as _;

use super::spread::Spread;
use super::Theme;
use crate::creatures::Case;
use crate::suite::{Row, INITIAL};

/// A column beside Q: figure, heading, factor, decimals.
type Column = (&'static str, &'static str, f64, usize);

const COLUMNS: [Column; 6] = [
    ("hausdorff", "Hausdorff e-2", 100.0, 2),
    ("dirichlet", "Dirichlet", 1.0, 3),
    ("truth_mean", "truth e-2", 100.0, 3),
    ("folds", "new folds", 1.0, 1),
    ("skinny_new", "new skinny", 1.0, 1),
    ("cpu_seconds", "CPU-s", 1.0, 1),
];

/// Most pairs whose Q stand in columns of their own.
const MANY: usize = 10;

/// Rows of the paper's Table 1 on SHREC'07/BIM: method, Chamfer e-4, Hausdorff e-2, Dirichlet, Q.
const TABLE_1: [(&str, &str, f64, f64, f64); 3] = [
    ("HOT, as the paper gives it", "13.78", 4.57, 12.76, 0.327),
    ("RHM, as the paper gives it", "8.78", 3.49, 6.54, 0.534),
    ("the paper", "8.34", 2.22, 3.29, 0.791),
];

/// The heading of a theme and its table: Q of each pair, then means over the pairs, each with its spread over seeds.
pub(super) fn theme(theme: &Theme, pairs: &[&str], rows: &[Row]) -> String {
    let many = (2..=MANY).contains(&pairs.len());
    let of_pairs = pairs
        .iter()
        .filter(|_| many)
        .map(|pair| format!(" Q, {pair} |"));
    let means = ["mean Q"].into_iter().chain(COLUMNS.iter().map(|c| c.1));
    let headings: Vec<String> = of_pairs.chain(means.map(|m| format!(" {m} |"))).collect();
    let mut text = format!("\n### {}\n\n| |{}\n", theme.title, headings.concat());
    let _ = writeln!(text, "|---|{}", "---|".repeat(headings.len()));
    for (label, preset) in theme.variants {
        let of_preset: Vec<&Row> = rows.iter().filter(|row| row.preset == *preset).collect();
        let _ = writeln!(text, "| {label} |{}", cells(&of_preset, pairs, many));
    }
    text
}

fn cells(rows: &[&Row], pairs: &[&str], many: bool) -> String {
    let q = |rows: &[&Row]| cell(Spread::of_rows(rows, |r| r.figure("q_transfer")), 1.0, 3);
    let of_pair = |pair: &&str| {
        let of_pair: Vec<&Row> = rows.iter().copied().filter(|r| r.pair == **pair).collect();
        q(&of_pair)
    };
    let of_pairs = pairs.iter().filter(|_| many).map(of_pair);
    let figures = COLUMNS.iter().map(|&(name, _, factor, decimals)| {
        cell(Spread::of_rows(rows, |r| r.figure(name)), factor, decimals)
    });
    of_pairs.chain([q(rows)]).chain(figures).collect()
}

fn cell(spread: Option<Spread>, factor: f64, decimals: usize) -> String {
    spread.map_or_else(
        || " – |".to_owned(),
        |spread| format!(" {} |", spread.text(factor, decimals)),
    )
}

/// Table 1 of the paper on SHREC'07/BIM, and in its last row the runs of the study's own settings. The paper's Chamfer distance is
/// between samples whose number it does not tell, so that ours has none beside it.
pub(super) fn table_1(rows: &[Row]) -> String {
    let mut text = String::from(
        "\n### Beside the paper's Table 1\n\n\
         The paper's rows are means over the 200 pairs of SHREC'07/BIM; ours is over the pairs above.\n\n\
         | | Chamfer e-4 | Hausdorff e-2 | Dirichlet | Q |\n|---|---|---|---|---|\n",
    );
    for (name, chamfer, hausdorff, dirichlet, q) in TABLE_1 {
        let _ = writeln!(
            text,
            "| {name} | {chamfer} | {hausdorff} | {dirichlet} | {q} |"
        );
    }
    let ours: Vec<&Row> = rows.iter().filter(|row| row.preset == "study").collect();
    let figure = |name: &'static str, factor, decimals| {
        cell(
            Spread::of_rows(&ours, |row| row.figure(name)),
            factor,
            decimals,
        )
    };
    let (hausdorff, dirichlet) = (figure("hausdorff", 100.0, 2), figure("dirichlet", 1.0, 2));
    let q = figure("q_transfer", 1.0, 3);
    let _ = writeln!(
        text,
        "| preset `study`, these pairs | – |{hausdorff}{dirichlet}{q}"
    );
    text
}

/// A row for each stand of the dial: means over its creatures.
pub(super) fn dial(stands: &[Vec<Case>], rows: &[Row]) -> String {
    let mut text = String::from(
        "\n| turn of joints | ratio of lengths | landmarks | Q | lowest Q | truth e-2 | initial e-2 | gain | lowest gain | \
         new folds | new skinny | new crossings | CPU-s |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for cases in stands {
        if let Some(case) = cases.first() {
            let (angle, ratio, n) = (case.dial.angle, case.dial.ratio, case.n_landmarks);
            let cells = Stand { cases, rows }.cells();
            let _ = writeln!(text, "| {angle}° | {ratio} | {n} | {} |", cells.join(" | "));
        }
    }
    text
}

/// The runs at one stand of the dial.
struct Stand<'a> {
    cases: &'a [Case],
    rows: &'a [Row],
}

impl Stand<'_> {
    /// A figure of every case whose run has it, of the initial deformation or of the default.
    fn figures(&self, is_initial: fn(&str) -> bool, name: &'static str) -> Vec<f64> {
        let of_case = |case: &Case| {
            let pair = case.name();
            let mut rows = self.rows.iter();
            let row = rows.find(|row| row.pair == pair && is_initial(&row.preset));
            row.and_then(|row| row.figure(name))
        };
        self.cases.iter().filter_map(of_case).collect()
    }

    fn cells(&self) -> [String; 10] {
        let of_run = |name| self.figures(|preset| preset != INITIAL, name);
        let (q, truth) = (of_run("q_transfer"), of_run("truth_mean"));
        let initial = self.figures(|preset| preset == INITIAL, "truth_mean");
        let gains = initial.iter().zip(&truth);
        let gains: Vec<f64> = gains.map(|(before, after)| before / after).collect();
        let shown = |value: f64, factor: f64, decimals: usize| match value.is_finite() {
            true => format!("{:.decimals$}", factor * value),
            false => "–".to_owned(),
        };
        [
            shown(mean(&q), 1.0, 4),
            shown(least(&q), 1.0, 4),
            shown(mean(&truth), 100.0, 3),
            shown(mean(&initial), 100.0, 3),
            shown(mean(&initial) / mean(&truth), 1.0, 2),
            shown(least(&gains), 1.0, 2),
            shown(mean(&of_run("folds")), 1.0, 1),
            shown(mean(&of_run("skinny_new")), 1.0, 1),
            shown(mean(&of_run("self_intersections_new")), 1.0, 1),
            shown(mean(&of_run("cpu_seconds")), 1.0, 1),
        ]
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn least(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::INFINITY, f64::min)
}
