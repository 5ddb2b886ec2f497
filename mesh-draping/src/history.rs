//! The terms of the loss over a run.

use neural_drape::StepReport;

/// The value of every term in every iteration.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct History {
    /// A curve for each term that counted.
    pub curves: Vec<Curve>,
}

/// One term over the run.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// The term, as [`neural_drape::TermReport::name`].
    pub name: &'static str,
    /// Iteration and value, unweighted.
    pub points: Vec<(usize, f64)>,
}

impl History {
    /// Adds the terms of a step.
    pub fn record(&mut self, step: &StepReport) {
        for term in &step.terms {
            let curve = match self.curves.iter().position(|c| c.name == term.name) {
                Some(known) => known,
                None => {
                    self.curves.push(Curve {
                        name: term.name,
                        points: Vec::with_capacity(step.n_iterations),
                    });
                    self.curves.len() - 1
                }
            };
            self.curves[curve].points.push((step.iteration, term.value));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use neural_drape::TermReport;

    #[test]
    fn curves_grow_with_the_steps() {
        let step = |iteration| StepReport {
            iteration,
            n_iterations: 2,
            terms: vec![TermReport {
                name: "chamfer",
                value: 0.5,
                weight: 2.0,
            }],
            total: 1.0,
        };
        let mut history = History::default();
        history.record(&step(0));
        history.record(&step(1));
        assert_eq!(history.curves[0].points, [(0, 0.5), (1, 0.5)]);
    }
}
