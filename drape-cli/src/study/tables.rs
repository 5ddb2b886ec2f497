//! The tables of a study: one for each thing that is changed.

use std::fmt::Write as _;

use super::spread::Spread;
use super::Theme;
use crate::suite::Row;

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

/// Rows of the paper's Table 1 on SHREC'07/BIM: method, Chamfer e-4, Hausdorff e-2, Dirichlet, Q.
const TABLE_1: [(&str, &str, f64, f64, f64); 3] = [
    ("HOT, as the paper gives it", "13.78", 4.57, 12.76, 0.327),
    ("RHM, as the paper gives it", "8.78", 3.49, 6.54, 0.534),
    ("the paper", "8.34", 2.22, 3.29, 0.791),
];

/// The heading of a theme and its table: Q of each pair, then means over the pairs, each with its spread over seeds.
pub(super) fn theme(theme: &Theme, pairs: &[&str], rows: &[Row]) -> String {
    let many = pairs.len() > 1;
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
