//! What the bench found: a row for each pair and preset, and means.

use std::fmt::Write as _;

use serde::Serialize;

use super::Case;
use crate::suite::Row;

/// How a preset did on a pair. Lengths are in longest sides of the target's box.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct BenchRow {
    pub(crate) pair: String,
    pub(crate) plan: String,
    /// Largest turn of a joint, in degrees.
    pub(crate) angle: f64,
    /// Largest ratio of lengths.
    pub(crate) ratio: f64,
    pub(crate) landmarks: usize,
    pub(crate) variant: String,
    pub(crate) seed: u64,
    pub(crate) preset: String,
    /// Why there is no result; none where there is one.
    pub(crate) error: Option<String>,
    pub(crate) q_transfer: Option<f64>,
    /// Mean distance of the result's vertices to their true places.
    pub(crate) truth: Option<f64>,
    /// The same of the initial deformation.
    pub(crate) truth_initial: Option<f64>,
    /// How many times nearer to the truth the result is.
    pub(crate) gain: Option<f64>,
    pub(crate) folds: Option<f64>,
    pub(crate) skinny: Option<f64>,
    pub(crate) crossings: Option<f64>,
    pub(crate) cpu_seconds: Option<f64>,
}

impl BenchRow {
    /// The row of a run, beside the run that stopped at the initial deformation.
    pub(crate) fn new(case: &Case, run: &Row, initial: Option<&Row>) -> Self {
        let truth = run.figure("truth_mean");
        let truth_initial = initial.and_then(|row| row.figure("truth_mean"));
        Self {
            pair: case.name(),
            plan: case.plan.name().to_owned(),
            angle: case.dial.angle,
            ratio: case.dial.ratio,
            landmarks: case.n_landmarks,
            variant: case.variant.name().to_owned(),
            seed: case.seed,
            preset: run.preset.clone(),
            error: run.error.clone(),
            q_transfer: run.figure("q_transfer"),
            truth,
            truth_initial,
            gain: truth
                .zip(truth_initial)
                .map(|(after, before)| before / after),
            folds: run.figure("folds"),
            skinny: run.figure("skinny_new"),
            crossings: run.figure("self_intersections_new"),
            cpu_seconds: run.figure("cpu_seconds"),
        }
    }

    /// In the order of [`COLUMNS`].
    fn figures(&self) -> [Option<f64>; 8] {
        [
            self.q_transfer,
            self.truth,
            self.truth_initial,
            self.gain,
            self.folds,
            self.skinny,
            self.crossings,
            self.cpu_seconds,
        ]
    }
}

/// Headings, factors, widths and decimals of the figures.
const COLUMNS: [(&str, f64, usize, usize); 8] = [
    ("Q", 1.0, 7, 4),
    ("truth e-2", 100.0, 10, 3),
    ("initial e-2", 100.0, 12, 3),
    ("gain", 1.0, 6, 2),
    ("folds", 1.0, 6, 0),
    ("skinny", 1.0, 7, 0),
    ("crossings", 1.0, 10, 0),
    ("CPU-s", 1.0, 7, 1),
];

/// All rows, for people and for programs.
#[derive(Clone, Debug)]
pub(crate) struct Table(pub(crate) Vec<BenchRow>);

impl Table {
    /// Rows, then means for each plan and for all, preset by preset.
    pub(crate) fn text(&self) -> String {
        let width = self
            .0
            .iter()
            .map(|row| row.pair.len())
            .max()
            .unwrap_or(0)
            .max(16);
        let mut text = format!("{:width$} {:10}", "pair", "preset");
        for (heading, _, w, _) in COLUMNS {
            let _ = write!(text, " {heading:>w$}");
        }
        text.push('\n');
        for row in &self.0 {
            let figures = line(row.figures(), 0);
            let shown = row
                .error
                .as_ref()
                .map_or(figures, |error| format!(" failed: {error}"));
            let _ = writeln!(text, "{:width$} {:10}{shown}", row.pair, row.preset);
        }
        for preset in names(&self.0, |row| &row.preset) {
            let of_preset: Vec<&BenchRow> =
                self.0.iter().filter(|row| row.preset == preset).collect();
            let plans = names(&self.0, |row| &row.plan);
            for plan in plans.iter().copied().filter(|_| plans.len() > 1) {
                let of_plan = of_preset.iter().copied().filter(|row| row.plan == plan);
                text += &mean_line(
                    &format!("mean of {plan}"),
                    preset,
                    &of_plan.collect::<Vec<_>>(),
                    width,
                );
            }
            text += &mean_line("mean of all", preset, &of_preset, width);
        }
        text
    }

    /// A row for each pair and preset, with a heading.
    pub(crate) fn csv(&self) -> String {
        let mut csv = String::from(
            "pair,plan,angle,ratio,landmarks,variant,seed,preset,q_transfer,truth,truth_initial,gain,folds,skinny,crossings,cpu_seconds\n",
        );
        for row in &self.0 {
            let r = row;
            let _ = write!(
                csv,
                "{},{},{},{},{},{},{},{}",
                r.pair, r.plan, r.angle, r.ratio, r.landmarks, r.variant, r.seed, r.preset
            );
            let figures = row.figures();
            for figure in figures {
                let _ = write!(
                    csv,
                    ",{}",
                    figure.map(|x| x.to_string()).unwrap_or_default()
                );
            }
            csv.push('\n');
        }
        csv
    }
}

fn line(figures: [Option<f64>; 8], more_decimals: usize) -> String {
    let cell =
        |(figure, (_, factor, width, decimals)): (Option<f64>, (&str, f64, usize, usize))| {
            let decimals = if decimals == 0 {
                more_decimals
            } else {
                decimals
            };
            let text = figure
                .map(|x| format!("{:.decimals$}", factor * x))
                .unwrap_or_default();
            format!(" {text:>width$}")
        };
    figures.into_iter().zip(COLUMNS).map(cell).collect()
}

fn mean_line(name: &str, preset: &str, rows: &[&BenchRow], width: usize) -> String {
    let mut means = [None; 8];
    for (k, mean) in means.iter_mut().enumerate() {
        let values: Vec<f64> = rows.iter().filter_map(|row| row.figures()[k]).collect();
        *mean = (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64);
    }
    format!("{name:width$} {preset:10}{}\n", line(means, 1))
}

/// Different names, in the order in which they come.
fn names<'a>(rows: &'a [BenchRow], name: impl Fn(&'a BenchRow) -> &'a str) -> Vec<&'a str> {
    let mut seen = Vec::new();
    for row in rows {
        if !seen.contains(&name(row)) {
            seen.push(name(row));
        }
    }
    seen
}
