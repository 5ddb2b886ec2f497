//! Mean and spread over seeds of a figure that is a mean over pairs.

use crate::suite::Row;

/// A mean over seeds and how much these differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spread {
    pub(super) mean: f64,
    /// Standard deviation over the seeds, `√(Σ (x − mean)² / (n − 1))`; none for one seed.
    pub(super) deviation: Option<f64>,
}

impl Spread {
    /// Of `values`, one per seed; none without any.
    pub(super) fn of(values: &[f64]) -> Option<Self> {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let squares: f64 = values.iter().map(|x| (x - mean).powi(2)).sum();
        (!values.is_empty()).then(|| Self {
            mean,
            deviation: (values.len() > 1).then(|| (squares / (n - 1.0)).sqrt()),
        })
    }

    /// The spread over seeds of the mean over pairs of a figure. A seed counts with the pairs that have the figure.
    pub(super) fn of_rows(rows: &[&Row], figure: impl Fn(&Row) -> Option<f64>) -> Option<Self> {
        let mut seeds: Vec<u64> = rows.iter().map(|row| row.seed).collect();
        seeds.sort_unstable();
        seeds.dedup();
        let mean_of = |seed: &u64| {
            let of_seed = rows.iter().filter(|row| row.seed == *seed);
            let values: Vec<f64> = of_seed.filter_map(|row| figure(row)).collect();
            (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
        };
        Self::of(&seeds.iter().filter_map(mean_of).collect::<Vec<_>>())
    }

    /// `mean ± deviation`, both times `factor`.
    pub(super) fn text(&self, factor: f64, decimals: usize) -> String {
        let mean = format!("{:.decimals$}", self.mean * factor);
        match self.deviation {
            Some(deviation) => format!("{mean} ± {:.decimals$}", deviation * factor),
            None => mean,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_deviation_is_that_of_a_sample() {
        let spread = Spread::of(&[1.0, 2.0, 3.0]).unwrap();
        assert_eq!((spread.mean, spread.deviation), (2.0, Some(1.0)));
        assert_eq!(spread.text(10.0, 1), "20.0 ± 10.0");
        assert_eq!(Spread::of(&[4.0]).unwrap().text(1.0, 2), "4.00");
        assert_eq!(Spread::of(&[]), None);
    }
}
