//! Progress on stderr: a bar on a terminal, a line every tenth elsewhere.

use std::io::IsTerminal as _;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use neural_drape::StepReport;

/// How many plain lines a run prints.
const N_LINES: usize = 10;

/// Shows the steps of one run.
pub(crate) struct Progress {
    shown: Shown,
    start: Instant,
    n_iterations: usize,
}

enum Shown {
    Bar(ProgressBar),
    Lines,
}

impl Progress {
    pub(crate) fn start(n_iterations: usize) -> Self {
        let shown = if std::io::stderr().is_terminal() {
            let bar = ProgressBar::new(n_iterations as u64);
            let style =
                ProgressStyle::with_template("{bar:28} {pos}/{len}  {eta} left  {wide_msg}");
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            bar.enable_steady_tick(Duration::from_millis(500));
            Shown::Bar(bar)
        } else {
            Shown::Lines
        };
        Self {
            shown,
            start: Instant::now(),
            n_iterations,
        }
    }

    pub(crate) fn show(&mut self, step: &StepReport) {
        // A drape that goes on after its end has more iterations than it had.
        self.n_iterations = self.n_iterations.max(step.n_iterations);
        let step = &StepReport {
            n_iterations: self.n_iterations,
            ..step.clone()
        };
        match &self.shown {
            Shown::Bar(bar) => {
                bar.set_length(step.n_iterations as u64);
                bar.set_position(step.iteration as u64 + 1);
                bar.set_message(terms(step));
            }
            Shown::Lines => {
                if let Some(line) = line(step, self.start.elapsed()) {
                    eprintln!("{line}");
                }
            }
        }
    }

    /// Takes the bar away.
    pub(crate) fn finish(self) {
        if let Shown::Bar(bar) = self.shown {
            bar.finish_and_clear();
        }
    }
}

/// The loss and its weighted terms.
fn terms(step: &StepReport) -> String {
    let terms = step
        .terms
        .iter()
        // Adding zero turns −0 into 0.
        .map(|t| format!("{} {:.3}", t.name, t.value * t.weight + 0.0));
    format!(
        "loss {:.4}: {}",
        step.total,
        terms.collect::<Vec<_>>().join(", ")
    )
}

/// The plain line of a step that completes a tenth of the run.
fn line(step: &StepReport, elapsed: Duration) -> Option<String> {
    let (done, n) = (step.iteration + 1, step.n_iterations);
    let tenth = |done: usize| done * N_LINES / n.max(1);
    if tenth(done) == tenth(done - 1) {
        return None;
    }
    let left = elapsed.as_secs_f64() * (n - done) as f64 / done as f64;
    let percent = 100 * done / n.max(1);
    Some(format!(
        "{percent:>3} %  {done}/{n}  {left:.0} s left  {}",
        terms(step)
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use neural_drape::TermReport;

    fn step(iteration: usize, n_iterations: usize) -> StepReport {
        let term = TermReport {
            name: "chamfer",
            value: 0.5,
            weight: 2.0,
        };
        StepReport {
            iteration,
            n_iterations,
            terms: vec![term],
            total: 1.0,
        }
    }

    #[test]
    fn ten_lines_for_any_length() {
        for n in [10, 37, 500] {
            let lines = (0..n).filter_map(|k| line(&step(k, n), Duration::from_secs(1)));
            assert_eq!(lines.count(), 10);
        }
        let last = line(&step(9, 10), Duration::from_secs(1)).unwrap();
        assert_eq!(last, "100 %  10/10  0 s left  loss 1.0000: chamfer 1.000");
    }

    #[test]
    fn a_drape_may_go_on_after_its_end() {
        let mut progress = Progress::start(2);
        for (k, n) in [(0, 2), (1, 2), (2, 4), (3, 4)] {
            progress.show(&step(k, n));
        }
        assert_eq!(progress.n_iterations, 4);
        progress.finish();
    }
}
