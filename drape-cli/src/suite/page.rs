//! The figures of runs as Markdown, between two marks of a page that people write.

use std::fmt::Write as _;

use anyhow::{bail, Context as _};

use super::bounds::{figure, MEAN_COVERED};
use super::row::Row;
use super::run_list::RunList;

/// The lines of a page between which a command writes.
#[derive(Clone, Debug)]
pub(crate) struct Marks {
    begin: String,
    end: String,
}

impl Marks {
    /// Those of the figures of a list of runs.
    pub(crate) fn figures() -> Self {
        Self {
            begin: "<!-- figures: written by `drape evaluate --page`; what is written by hand stands around them -->".to_owned(),
            end: "<!-- end of figures -->".to_owned(),
        }
    }

    /// Those of a study.
    pub(crate) fn study(name: &str) -> Self {
        Self {
            begin: format!("<!-- study: written by `drape evaluate --study {name} --page` -->"),
            end: format!("<!-- end of study {name} -->"),
        }
    }

    /// `page` with `text` in place of what stands between the marks.
    ///
    /// # Errors
    /// A page without them.
    pub(crate) fn fill(&self, page: &str, text: &str) -> anyhow::Result<String> {
        let Self { begin, end } = self;
        let lacks = |mark: &str| format!("no line '{mark}'");
        let (before, rest) = page.split_once(begin).with_context(|| lacks(begin))?;
        let (_, after) = rest.split_once(end).with_context(|| lacks(end))?;
        Ok(format!("{before}{begin}\n\n{text}\n{end}{after}"))
    }
}

/// A column: figure, heading, factor, decimals.
type Column = (&'static str, &'static str, f64, usize);

const Q: Column = ("q_transfer", "Q", 1.0, 4);
const HAUSDORFF: Column = ("hausdorff", "Hausdorff e-2", 100.0, 2);
const COVERED: Column = (MEAN_COVERED, "mean, covered e-2", 100.0, 3);
/// Of every pair.
const COMMON: [Column; 10] = [
    ("mean_l2_result_to_target", "mean to target e-2", 100.0, 3),
    ("mean_l2_target_to_result", "mean to result e-2", 100.0, 3),
    ("dirichlet", "Dirichlet", 1.0, 4),
    ("folds", "new folds", 1.0, 0),
    ("skinny_new", "new skinny", 1.0, 0),
    ("self_intersections_new", "new crossings", 1.0, 0),
    ("landmark_rms", "landmark RMS e-2", 100.0, 3),
    ("truth_mean", "truth, mean", 1.0, 4),
    ("cpu_seconds", "CPU-s", 1.0, 1),
    ("peak_mb", "peak MB", 1.0, 0),
];

/// The figures of finished runs.
pub(crate) struct Page<'a> {
    /// What was run.
    pub(crate) list: &'a RunList,
    /// What came out.
    pub(crate) rows: &'a [Row],
    /// The state of the program's sources, in the caller's words.
    pub(crate) commit: &'a str,
}

impl Page<'_> {
    /// `text` with these figures in place of those between its marks.
    ///
    /// # Errors
    /// A run without a result, or a text without the marks.
    pub(crate) fn written_into(&self, text: &str) -> anyhow::Result<String> {
        if let Some(row) = self.rows.iter().find(|row| row.error.is_some()) {
            bail!("{} has no result, so that no page is written", row.pair);
        }
        Marks::figures().fill(text, &self.figures())
    }

    fn figures(&self) -> String {
        let mut text = self.origin();
        let mut sections: Vec<&str> = Vec::new();
        for row in self.rows {
            let section = self.list.section(&row.pair).unwrap_or_default();
            if !sections.contains(&section) {
                sections.push(section);
            }
        }
        for section in sections {
            let rows = self.rows.iter();
            let rows = rows.filter(|row| self.list.section(&row.pair) == Some(section));
            let _ = write!(
                text,
                "\n## {section}\n\n{}",
                self.table(&rows.collect::<Vec<_>>())
            );
        }
        text
    }

    fn origin(&self) -> String {
        origin(self.rows, self.commit)
            + " Lengths are in longest sides of the target's\n\
               box; a run is judged against the true mesh where its target is a defective variant of it. CPU-seconds are those of the\n\
               whole command, reading, judging and writing included.\n"
    }

    fn table(&self, rows: &[&Row]) -> String {
        let is_partial = rows.iter().any(|row| self.list.is_partial(&row.pair));
        let first: &[Column] = if is_partial {
            &[COVERED]
        } else {
            &[Q, HAUSDORFF]
        };
        let columns: Vec<Column> = first.iter().chain(&COMMON).copied().collect();
        let headings = columns
            .iter()
            .map(|(_, heading, ..)| format!(" {heading} |"));
        let mut text = format!("| run |{}\n", headings.collect::<String>());
        let _ = writeln!(text, "|---|{}", "---|".repeat(columns.len()));
        for row in rows {
            let cells = columns
                .iter()
                .map(|column| cell(figure(row, column.0), *column));
            let _ = writeln!(text, "| {} |{}", self.name(row), cells.collect::<String>());
        }
        if rows.len() > 1 {
            let means = columns.iter().map(|&(name, heading, factor, decimals)| {
                // A mean of counts is no count.
                cell(mean(rows, name), (name, heading, factor, decimals.max(1)))
            });
            let _ = writeln!(text, "| mean |{}", means.collect::<String>());
        }
        text
    }

    /// The pair, with its preset and seed where not all have the same.
    fn name(&self, row: &Row) -> String {
        let is_alike = |other: &Row| other.preset == row.preset && other.seed == row.seed;
        if self.rows.iter().all(is_alike) {
            return row.pair.clone();
        }
        format!("{}, {}, {}", row.pair, row.preset, row.seed)
    }
}

/// When, of what and where the figures of `rows` were measured, and how many runs they are.
pub(crate) fn origin(rows: &[Row], commit: &str) -> String {
    let newest = rows.iter().map(|row| row.finished).max().unwrap_or(0);
    let [year, month, day] = date(newest);
    let processor = processor().map_or_else(String::new, |name| format!(", {name}"));
    let (version, n) = (env!("CARGO_PKG_VERSION"), rows.len());
    format!("{year}-{month:02}-{day:02}, version {version}, commit {commit}{processor}: {n} runs.")
}

fn cell(value: Option<f64>, (_, _, factor, decimals): Column) -> String {
    value.map_or_else(
        || " – |".to_owned(),
        |v| format!(" {:.decimals$} |", v * factor),
    )
}

/// The mean over rows that have the figure.
fn mean(rows: &[&Row], name: &str) -> Option<f64> {
    let values: Vec<f64> = rows.iter().filter_map(|row| figure(row, name)).collect();
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// Year, month and day of a time in seconds since 1970, in UTC.
///
/// Days are counted from 1 March of year 0 in eras of 400 years, which all have the same number of days. Source: Richards
/// 2013, "Calendars", in the Explanatory Supplement to the Astronomical Almanac.
fn date(seconds: u64) -> [u64; 3] {
    let days = seconds / 86_400 + 719_468;
    let (era, day_of_era) = (days / 146_097, days % 146_097);
    let year_of_era =
        (day_of_era - day_of_era / 1_460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = (month_from_march + 2) % 12 + 1;
    let year = era * 400 + year_of_era + u64::from(month <= 2);
    [year, month, day]
}

/// The processor's name, where the system tells it.
fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::super::row::tests::row;
    use super::super::Manifest;
    use super::*;

    const MANIFEST: &str = "[[pair]]\nname = 'horse'\nsource = 's.obj'\ntarget = 't.obj'\nsection = 'Animals'\n\
        [[pair]]\nname = 'mask'\nsource = 's.obj'\ntarget = 't.obj'\nsection = 'Masks'\npartial = true\n";

    fn page(text: &str) -> String {
        let Marks { begin, end } = Marks::figures();
        format!("# Mine\n{begin}\n{text}\n{end}\nmy words\n")
    }

    fn written(rows: &[Row], text: &str) -> anyhow::Result<String> {
        let manifest = Manifest::parse(MANIFEST, Path::new(""), None)?;
        let list = RunList::new(vec![manifest])?;
        let page = Page {
            list: &list,
            rows,
            commit: "abc1234",
        };
        page.written_into(text)
    }

    #[test]
    fn figures_stand_between_the_marks_and_all_else_stays() {
        let mut mask = row("mask", "standard", Some(0.1));
        mask.figures
            .insert("mean_l2_result_to_target".to_owned(), 0.05);
        mask.figures
            .insert("mean_l2_target_to_result".to_owned(), 0.002);
        let rows = [row("horse", "standard", Some(0.98765)), mask];
        let page = written(&rows, &page("stale")).unwrap();
        assert!(
            page.starts_with("# Mine\n")
                && page.ends_with("\nmy words\n")
                && !page.contains("stale")
        );
        assert!(page.contains("1970-01-01, version ") && page.contains("commit abc1234"));
        assert!(page.contains("## Animals\n") && page.contains("| horse | 0.9877 | – |"));
        assert!(page.contains("| mask | 0.200 | 5.000 | 0.200 | – |"));
        // Written again, nothing changes.
        assert_eq!(written(&rows, &page).unwrap(), page);
    }

    #[test]
    fn no_page_is_written_without_marks_or_with_a_run_that_failed() {
        assert!(written(&[], "# Mine\n").is_err());
        assert!(written(&[row("horse", "standard", None)], &page("")).is_err());
    }

    #[test]
    fn presets_and_seeds_are_told_where_they_differ() {
        let rows = [
            row("horse", "standard", Some(0.5)),
            row("horse", "quick", Some(0.7)),
        ];
        let page = written(&rows, &page("")).unwrap();
        assert!(
            page.contains("| horse, quick, 0 | 0.7000 |") && page.contains("| mean | 0.6000 |")
        );
    }

    #[test]
    fn dates_are_those_of_the_calendar() {
        assert_eq!(date(0), [1970, 1, 1]);
        assert_eq!(date(951_782_400), [2000, 2, 29]);
        assert_eq!(date(1_735_689_599), [2024, 12, 31]);
        assert_eq!(date(4_107_542_400), [2100, 3, 1]);
    }
}
