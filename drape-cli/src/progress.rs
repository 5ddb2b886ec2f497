//! Progress on stderr: a bar on a terminal, a line every tenth elsewhere. Keeps the loss curves.

use std::io::IsTerminal as _;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use neural_drape::StepReport;

/// How many plain lines a run prints.
const N_LINES: usize = 10;

/// Shows and records the steps of one run.
pub(crate) struct Progress {
    shown: Shown,
    start: Instant,
    history: History,
    n_iterations: usize,
    /// Iterations of earlier runs, and how many there were so far.
    n_before: usize,
    n_shown: usize,
}

enum Shown {
    Bar(ProgressBar),
    Lines,
}

/// The value of every term in every iteration.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct History {
    pub(crate) curves: Vec<Curve>,
}

/// One term over the run.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Curve {
    pub(crate) name: &'static str,
    /// Iteration and value, unweighted.
    pub(crate) points: Vec<(usize, f64)>,
}

impl History {
    fn record(&mut self, step: &StepReport) {
        for term in &step.terms {
            let curve = match self.curves.iter().position(|c| c.name == term.name) {
                Some(known) => &mut self.curves[known],
                None => {
                    let points = Vec::with_capacity(step.n_iterations);
                    self.curves.push(Curve {
                        name: term.name,
                        points,
                    });
                    let last = self.curves.len() - 1;
                    &mut self.curves[last]
                }
            };
            curve.points.push((step.iteration, term.value));
        }
    }
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
            history: History::default(),
            n_iterations,
            n_before: 0,
            n_shown: 0,
        }
    }

    /// What comes is another run, shown as the continuation.
    pub(crate) fn go_on(&mut self) {
        self.n_before = self.n_shown;
    }

    pub(crate) fn show(&mut self, step: &StepReport) {
        // A drape that goes on after its end has more iterations than it had.
        self.n_iterations = self.n_iterations.max(self.n_before + step.n_iterations);
        let step = &StepReport {
            iteration: self.n_before + step.iteration,
            n_iterations: self.n_iterations,
            ..step.clone()
        };
        self.n_shown = step.iteration + 1;
        self.history.record(step);
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

    /// Takes the bar away and gives the curves.
    pub(crate) fn finish(self) -> History {
        if let Shown::Bar(bar) = self.shown {
            bar.finish_and_clear();
        }
        self.history
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
    fn curves_grow_with_the_steps() {
        let mut history = History::default();
        history.record(&step(0, 2));
        history.record(&step(1, 2));
        assert_eq!(history.curves[0].points, [(0, 0.5), (1, 0.5)]);
    }

    #[test]
    fn a_drape_may_go_on_after_its_end() {
        let mut progress = Progress::start(2);
        for (k, n) in [(0, 2), (1, 2), (2, 4), (3, 4)] {
            progress.show(&step(k, n));
        }
        assert_eq!(progress.n_iterations, 4);
        assert_eq!(progress.finish().curves[0].points.len(), 4);
    }
}
