//! What results have reached, and how far a later one may fall behind it.
//!
//! ```toml
//! [[bound]]
//! pair = "horse_wolf"
//! preset = "standard"
//! seed = 0
//! q_transfer = 0.98918        # the best that was measured; what is allowed is this less the slack of the figure
//! folds = 0
//! ```

use std::collections::BTreeMap;
use std::fmt;
use std::fs;
use std::path::Path;

use anyhow::{ensure, Context as _};
use serde::Deserialize;

use super::row::Row;

/// A figure that is held, and how much worse than the best a result may be: a share of it and an amount.
struct Held {
    name: &'static str,
    is_better_high: bool,
    share: f64,
    amount: f64,
    /// Of which pairs it is held.
    of: Of,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Of {
    All,
    /// Those whose shapes have no part that the other lacks.
    Whole,
    /// The others.
    Partial,
}

const fn at_most(name: &'static str, share: f64, amount: f64, of: Of) -> Held {
    Held {
        name,
        is_better_high: false,
        share,
        amount,
        of,
    }
}

/// Counts of faults have no slack but crossings, of which a few come and go with the last bits. Processors and their load
/// differ, and the same run was seen to take 3.7 and 7.8 CPU-seconds on one machine: time has much.
const HELD: [Held; 9] = [
    Held {
        name: "q_transfer",
        is_better_high: true,
        share: 0.0,
        amount: 0.001,
        of: Of::Whole,
    },
    at_most("truth_mean", 0.02, 0.0, Of::All),
    at_most(MEAN_COVERED, 0.05, 0.0, Of::Partial),
    at_most("dirichlet", 0.02, 0.0, Of::Partial),
    at_most("folds", 0.0, 0.0, Of::All),
    at_most("skinny_new", 0.0, 0.0, Of::All),
    at_most("self_intersections_new", 0.05, 2.0, Of::All),
    at_most("landmark_rms", 0.1, 2e-4, Of::All),
    at_most("cpu_seconds", 1.5, 1.0, Of::All),
];

/// The smaller of the mean distances from the result to the target and back: that of the part which both shapes have.
pub(super) const MEAN_COVERED: &str = "mean_covered";
/// Significant digits that are kept of what was reached.
const DIGITS: i32 = 5;

/// What every run has reached.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Bounds {
    #[serde(default)]
    bound: Vec<Entry>,
}

/// What one run has reached.
#[derive(Clone, Debug, PartialEq, Deserialize)]
struct Entry {
    pair: String,
    preset: String,
    seed: u64,
    #[serde(flatten)]
    reached: BTreeMap<String, f64>,
}

/// How rows compare with the bounds.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Verdict {
    /// What fell behind.
    pub(crate) broken: Vec<Broken>,
    /// Rows that no bound is known for.
    pub(crate) n_unbounded: usize,
    /// Bounds of runs that are not among the rows.
    pub(crate) n_not_run: usize,
}

/// A figure that fell behind.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Broken {
    pair: String,
    preset: String,
    seed: u64,
    what: Fault,
}

#[derive(Clone, Debug, PartialEq)]
enum Fault {
    Failed(String),
    NotMeasured(String),
    Behind {
        figure: String,
        value: f64,
        limit: f64,
        reached: f64,
    },
}

impl Held {
    fn named(name: &str) -> Option<&'static Self> {
        HELD.iter().find(|held| held.name == name)
    }

    /// The worst value that is allowed where `reached` is the best.
    fn limit(&self, reached: f64) -> f64 {
        let slack = self.share * reached.abs() + self.amount;
        reached + if self.is_better_high { -slack } else { slack }
    }

    fn is_worse(&self, value: f64, limit: f64) -> bool {
        let is_within = if self.is_better_high {
            value >= limit
        } else {
            value <= limit
        };
        !is_within
    }

    /// `value` with few digits, rounded to the worse side.
    fn rounded(&self, value: f64) -> f64 {
        if value == 0.0 || value.fract() == 0.0 {
            return value;
        }
        let decimals = (DIGITS - 1 - value.abs().log10().floor() as i32).clamp(0, 12);
        let scale = 10f64.powi(decimals);
        let scaled = value * scale;
        let rounded = if self.is_better_high {
            scaled.floor()
        } else {
            scaled.ceil()
        };
        rounded / scale
    }

    fn is_held(&self, is_partial: bool) -> bool {
        match self.of {
            Of::All => true,
            Of::Whole => !is_partial,
            Of::Partial => is_partial,
        }
    }
}

/// A figure of a row, by the name of its bound.
pub(super) fn figure(row: &Row, name: &str) -> Option<f64> {
    if name == MEAN_COVERED {
        let one = row.figure("mean_l2_result_to_target")?;
        return Some(one.min(row.figure("mean_l2_target_to_result")?));
    }
    row.figure(name)
}

impl Bounds {
    /// The bounds of a file.
    pub(crate) fn read(path: &Path) -> anyhow::Result<Self> {
        let text = fs::read_to_string(path)
            .with_context(|| format!("{}: cannot be read", path.display()))?;
        Self::parse(&text).with_context(|| path.display().to_string())
    }

    fn parse(text: &str) -> anyhow::Result<Self> {
        let bounds: Self = toml::from_str(text)?;
        for entry in &bounds.bound {
            for name in entry.reached.keys() {
                let names: Vec<&str> = HELD.iter().map(|held| held.name).collect();
                ensure!(
                    Held::named(name).is_some(),
                    "{}: there is no bound '{name}'; there are {}",
                    entry.pair,
                    names.join(", ")
                );
            }
        }
        Ok(bounds)
    }

    fn of_row(&self, row: &Row) -> Option<&Entry> {
        self.bound.iter().find(|entry| entry.is_of(row))
    }

    /// What of `rows` fell behind.
    pub(crate) fn compare(&self, rows: &[Row]) -> Verdict {
        let is_run = |entry: &&Entry| rows.iter().any(|row| entry.is_of(row));
        Verdict {
            broken: rows
                .iter()
                .filter_map(|row| Some((row, self.of_row(row)?)))
                .flat_map(|(row, entry)| entry.broken_by(row))
                .collect(),
            n_unbounded: rows.iter().filter(|row| self.of_row(row).is_none()).count(),
            n_not_run: self.bound.len() - self.bound.iter().filter(is_run).count(),
        }
    }

    /// The bounds with all that `rows` gained, in the order of the rows; no bound is loosened, and none is lost.
    pub(crate) fn tightened(&self, rows: &[Row], is_partial: impl Fn(&str) -> bool) -> Self {
        let done = rows.iter().filter(|row| row.error.is_none());
        let mut bound: Vec<Entry> = done
            .map(|row| {
                let known = self.of_row(row).cloned();
                let mut entry = known.unwrap_or_else(|| Entry::new(row));
                entry.tighten(row, is_partial(&row.pair));
                entry
            })
            .collect();
        let others = self.bound.iter().filter(|entry| {
            let is_kept = |kept: &Entry| kept.key() == entry.key();
            !bound.iter().any(is_kept)
        });
        let others: Vec<Entry> = others.cloned().collect();
        bound.extend(others);
        Self { bound }
    }

    /// The text of a file of bounds.
    pub(crate) fn to_toml(&self) -> String {
        let mut text = String::from(
            "# The best that each run has reached, written by `drape evaluate --tighten`. A result may be worse\n\
             # by a small slack that belongs to each figure. Bounds are tightened by what was gained and never loosened.\n",
        );
        for entry in &self.bound {
            text += &entry.to_toml();
        }
        text
    }
}

impl Entry {
    fn new(row: &Row) -> Self {
        Self {
            pair: row.pair.clone(),
            preset: row.preset.clone(),
            seed: row.seed,
            reached: BTreeMap::new(),
        }
    }

    fn key(&self) -> (&str, &str, u64) {
        (&self.pair, &self.preset, self.seed)
    }

    fn is_of(&self, row: &Row) -> bool {
        self.key() == (row.pair.as_str(), row.preset.as_str(), row.seed)
    }

    fn broken_by(&self, row: &Row) -> Vec<Broken> {
        let broken = |what| Broken {
            pair: row.pair.clone(),
            preset: row.preset.clone(),
            seed: row.seed,
            what,
        };
        if let Some(error) = &row.error {
            return vec![broken(Fault::Failed(error.clone()))];
        }
        let bounds = HELD
            .iter()
            .filter_map(|held| Some((held, *self.reached.get(held.name)?)));
        bounds
            .filter_map(|(held, reached)| {
                let name = held.name.to_owned();
                let Some(value) = figure(row, held.name) else {
                    return Some(broken(Fault::NotMeasured(name)));
                };
                let limit = held.limit(reached);
                held.is_worse(value, limit).then(|| {
                    broken(Fault::Behind {
                        figure: name,
                        value,
                        limit,
                        reached,
                    })
                })
            })
            .collect()
    }

    fn tighten(&mut self, row: &Row, is_partial: bool) {
        for held in HELD.iter().filter(|held| held.is_held(is_partial)) {
            let Some(value) = figure(row, held.name) else {
                continue;
            };
            let value = held.rounded(value);
            let reached = self.reached.entry(held.name.to_owned()).or_insert(value);
            if held.is_worse(*reached, value) {
                *reached = value;
            }
        }
    }

    fn to_toml(&self) -> String {
        let mut text = format!(
            "\n[[bound]]\npair = {:?}\npreset = {:?}\nseed = {}\n",
            self.pair, self.preset, self.seed
        );
        for (name, value) in HELD
            .iter()
            .filter_map(|held| Some((held.name, self.reached.get(held.name)?)))
        {
            text += &format!("{name} = {value}\n");
        }
        text
    }
}

impl fmt::Display for Broken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            pair, preset, seed, ..
        } = self;
        write!(f, "{pair} {preset} seed {seed}: ")?;
        match &self.what {
            Fault::Failed(error) => write!(f, "no result: {error}"),
            Fault::NotMeasured(figure) => write!(f, "{figure} was not measured"),
            Fault::Behind {
                figure,
                value,
                limit,
                reached,
            } => {
                let side = if value < limit { "below" } else { "above" };
                write!(
                    f,
                    "{figure} {value:.6} is {side} the bound {limit:.6} (reached: {reached})"
                )
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::row::tests::row;
    use super::*;

    fn measured(q: f64, folds: f64, cpu: f64) -> Row {
        let mut row = row("horse", "standard", Some(q));
        row.figures.insert("folds".to_owned(), folds);
        row.figures.insert("cpu_seconds".to_owned(), cpu);
        row
    }

    fn bounds() -> Bounds {
        Bounds::default().tightened(&[measured(0.989_187, 1.0, 4.0)], |_| false)
    }

    #[test]
    fn a_result_may_fall_behind_by_its_slack_and_no_more() {
        let broken = |q, folds, cpu| bounds().compare(&[measured(q, folds, cpu)]).broken;
        assert!(broken(0.9882, 1.0, 10.9).is_empty());
        for (row, figure, limit) in [
            ((0.9881, 1.0, 4.0), "q_transfer", "0.988180"),
            ((0.99, 2.0, 4.0), "folds", "1.000000"),
            ((0.99, 0.0, 11.1), "cpu_seconds", "11.000000"),
        ] {
            let found = broken(row.0, row.1, row.2);
            let words = found[0].to_string();
            assert_eq!(found.len(), 1);
            assert!(
                words.starts_with("horse standard seed 0: ") && words.contains(figure),
                "{words}"
            );
            assert!(words.contains(limit), "{words}");
        }
    }

    #[test]
    fn bounds_are_tightened_and_never_loosened() {
        let better = bounds().tightened(&[measured(0.5, 0.0, 9.0)], |_| false);
        let reached = &better.bound[0].reached;
        assert_eq!(
            (
                reached["q_transfer"],
                reached["folds"],
                reached["cpu_seconds"]
            ),
            (0.98918, 0.0, 4.0)
        );
        let again = better.tightened(&[], |_| false);
        assert_eq!(again, better);
    }

    #[test]
    fn a_file_is_read_as_it_was_written() {
        let bounds = bounds();
        assert_eq!(Bounds::parse(&bounds.to_toml()).unwrap(), bounds);
        let error =
            Bounds::parse("[[bound]]\npair='a'\npreset='b'\nseed=0\nbeauty=1\n").unwrap_err();
        assert!(error.to_string().contains("beauty"));
    }

    #[test]
    fn what_is_missing_is_found() {
        let verdict = bounds().compare(&[
            row("horse", "standard", None),
            row("wolf", "quick", Some(0.9)),
        ]);
        assert!(verdict.broken[0].to_string().contains("no result"));
        assert_eq!((verdict.n_unbounded, verdict.n_not_run), (1, 0));
        assert_eq!(bounds().compare(&[]).n_not_run, 1);
        let unmeasured = bounds()
            .compare(&[row("horse", "standard", Some(0.99))])
            .broken;
        assert_eq!(unmeasured.len(), 2);
    }

    #[test]
    fn of_shapes_with_parts_that_the_other_lacks_the_covered_part_is_held() {
        let mut row = measured(0.1, 0.0, 4.0);
        row.figures
            .insert("mean_l2_result_to_target".to_owned(), 0.05);
        row.figures
            .insert("mean_l2_target_to_result".to_owned(), 0.002);
        let bounds = Bounds::default().tightened(&[row], |_| true);
        let reached = &bounds.bound[0].reached;
        assert_eq!(reached.get(MEAN_COVERED), Some(&0.002));
        assert!(!reached.contains_key("q_transfer"));
    }
}
