//! Rows as a table for spreadsheets and as a page with pictures.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::Path;

use super::row::Row;
use mesh_render::html::{escape, page, section};

/// A column of the page: figure, heading, factor, decimals.
const COLUMNS: [(&str, &str, f64, usize); 10] = [
    ("q_transfer", "Q", 1.0, 4),
    ("dirichlet", "Dirichlet", 1.0, 4),
    ("hausdorff", "Hausdorff e-2", 100.0, 2),
    ("mean_l2_sum", "mean L2 sum e-2", 100.0, 3),
    ("landmark_rms", "landmark RMS e-2", 100.0, 2),
    ("truth_mean", "truth e-2", 100.0, 3),
    ("folds", "new folds", 1.0, 0),
    ("skinny_new", "new skinny", 1.0, 0),
    ("self_intersections_new", "new crossings", 1.0, 0),
    ("cpu_seconds", "CPU-s", 1.0, 1),
];

/// All rows and all figures.
pub(super) fn csv(rows: &[Row]) -> String {
    let names: BTreeSet<&str> = rows
        .iter()
        .flat_map(|row| row.figures.keys())
        .map(String::as_str)
        .collect();
    let mut csv = String::from("pair,preset,seed,error");
    for name in &names {
        let _ = write!(csv, ",{name}");
    }
    csv.push('\n');
    for row in rows {
        let error = row.error.as_deref().unwrap_or_default();
        let _ = write!(
            csv,
            "{},{},{},{}",
            quoted(&row.pair),
            quoted(&row.preset),
            row.seed,
            quoted(error)
        );
        for name in &names {
            let value = row.figure(name).map(|v| v.to_string()).unwrap_or_default();
            let _ = write!(csv, ",{value}");
        }
        csv.push('\n');
    }
    csv
}

/// A field of RFC 4180.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

/// The page: means per preset, then every pair with its pictures, which lie beside it.
pub(super) fn html(rows: &[Row], folder: &Path) -> String {
    let title = "Evaluation";
    let n_failed = rows.iter().filter(|row| row.error.is_some()).count();
    let mut body = format!(
        "<h1>{title}</h1>\n<p class=\"soft\">{} runs, {n_failed} failed</p>\n",
        rows.len()
    );
    body += &section("Mean over pairs and seeds", &presets_table(rows));
    for pair in in_order(rows.iter().map(|row| row.pair.as_str())) {
        let of_pair: Vec<&Row> = rows.iter().filter(|row| row.pair == pair).collect();
        body += &section(pair, &(pair_table(&of_pair) + &pictures(&of_pair, folder)));
    }
    page(title, &body)
}

fn in_order<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut seen = Vec::new();
    for name in names {
        if !seen.contains(&name) {
            seen.push(name);
        }
    }
    seen
}

fn header(first: &[&str]) -> String {
    let names = first.iter().map(|name| format!("<th>{name}</th>"));
    let figures = COLUMNS
        .iter()
        .map(|(_, heading, ..)| format!("<th class=\"n\">{heading}</th>"));
    format!("<tr>{}</tr>", names.chain(figures).collect::<String>())
}

fn presets_table(rows: &[Row]) -> String {
    let mut html = format!(
        "<div class=\"scroll\"><table>{}",
        header(&["preset", "runs", "failed"])
    );
    for preset in in_order(rows.iter().map(|row| row.preset.as_str())) {
        let of_preset: Vec<&Row> = rows.iter().filter(|row| row.preset == preset).collect();
        let n_failed = of_preset.iter().filter(|row| row.error.is_some()).count();
        let _ = write!(
            html,
            "<tr><td>{}</td><td>{}</td><td>{n_failed}</td>",
            escape(preset),
            of_preset.len()
        );
        for &(name, _, factor, decimals) in &COLUMNS {
            let decimals = if decimals == 0 { 1 } else { decimals };
            html += &cell(mean(&of_preset, name), factor, decimals);
        }
        html += "</tr>";
    }
    html + "</table></div>\n"
}

/// The mean over the rows that have the figure.
fn mean(rows: &[&Row], name: &str) -> Option<f64> {
    let values: Vec<f64> = rows.iter().filter_map(|row| row.figure(name)).collect();
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

fn cell(value: Option<f64>, factor: f64, decimals: usize) -> String {
    let text = value
        .map(|v| format!("{:.decimals$}", v * factor))
        .unwrap_or_default();
    format!("<td class=\"n\">{text}</td>")
}

fn pair_table(rows: &[&Row]) -> String {
    let mut html = format!(
        "<div class=\"scroll\"><table>{}",
        header(&["preset", "seed"])
    );
    for row in rows {
        let _ = write!(
            html,
            "<tr><td>{}</td><td>{}</td>",
            escape(&row.preset),
            row.seed
        );
        match &row.error {
            Some(error) => {
                let _ = write!(
                    html,
                    "<td class=\"bad\" colspan=\"{}\">{}</td>",
                    COLUMNS.len(),
                    escape(error)
                );
            }
            None => html.extend(
                COLUMNS
                    .iter()
                    .map(|&(name, _, factor, decimals)| cell(row.figure(name), factor, decimals)),
            ),
        }
        html += "</tr>";
    }
    html + "</table></div>\n"
}

/// The strip of every run: source, target, initial deformation, result, distances.
fn pictures(rows: &[&Row], folder: &Path) -> String {
    let strip = |row: &&Row| {
        let address = row
            .picture
            .strip_prefix(folder)
            .unwrap_or(&row.picture)
            .to_string_lossy();
        let caption = escape(&format!("{}, seed {}", row.preset, row.seed));
        format!(
            "<figure><a href=\"{0}\"><img src=\"{0}\" alt=\"{caption}\" loading=\"lazy\"></a><figcaption>{caption}</figcaption></figure>\n",
            escape(&address)
        )
    };
    rows.iter()
        .filter(|row| row.error.is_none())
        .map(strip)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::row::tests::row;
    use super::*;

    fn rows() -> Vec<Row> {
        vec![
            row("a", "standard", Some(0.5)),
            row("b", "standard", Some(0.7)),
            row("a", "paper", None),
        ]
    }

    #[test]
    fn csv_quotes_what_must_be_quoted() {
        let csv = csv(&rows());
        let lines: Vec<&str> = csv.lines().collect();
        assert_eq!(lines[0], "pair,preset,seed,error,q_transfer");
        assert_eq!(lines[1], "a,standard,0,,0.5");
        assert_eq!(lines[3], "a,paper,0,\"no, \"\"really\"\"\",");
    }

    #[test]
    fn the_page_has_means_pairs_and_errors() {
        let html = html(&rows(), Path::new("x"));
        assert!(html.contains("<td class=\"n\">0.6000</td>"));
        assert!(html.contains("<h2>a</h2>") && html.contains("<h2>b</h2>"));
        assert!(html.contains("&quot;really&quot;"));
    }
}
