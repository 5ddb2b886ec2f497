//! Ranges of the settings, and what they mean at an iteration.

use crate::{DrapeConfig, DrapeError, ParametrizationConfig, Weights};

/// A setting with the range it must lie in.
struct Setting {
    name: &'static str,
    value: f64,
    low: f64,
    high: f64,
    expected: &'static str,
}

fn share(name: &'static str, value: f64) -> Setting {
    Setting {
        name,
        value,
        low: 0.0,
        high: 1.0,
        expected: "between 0 and 1",
    }
}

fn not_negative(name: &'static str, value: f64) -> Setting {
    Setting {
        name,
        value,
        low: 0.0,
        high: f64::MAX,
        expected: "0 or more",
    }
}

fn count(name: &'static str, value: usize) -> Setting {
    Setting {
        name,
        value: value as f64,
        low: 1.0,
        high: 1e9,
        expected: "between 1 and 10^9",
    }
}

impl DrapeConfig {
    /// Every setting lies in its range.
    ///
    /// # Errors
    /// The first that does not.
    pub fn check(&self) -> Result<(), DrapeError> {
        let mut settings = vec![
            not_negative("learning_rate.peak", self.learning_rate.peak),
            share("learning_rate.decay", self.learning_rate.decay),
            share("sampling.face_uniform", self.sampling.face_uniform),
            count("sampling.n_samples", self.sampling.n_samples),
            share("worst_share", self.worst_share),
            share("skinny_threshold", self.skinny_threshold),
            Setting {
                low: -1.0,
                expected: "between -1 and 1",
                ..share("fold_limit", self.fold_limit)
            },
        ];
        settings.extend(self.vertices_settings());
        match settings
            .iter()
            .find(|s| !(s.low..=s.high).contains(&s.value))
        {
            Some(s) => Err(DrapeError::Setting {
                name: s.name,
                value: s.value,
                expected: s.expected,
            }),
            None => Ok(()),
        }
    }

    fn vertices_settings(&self) -> Vec<Setting> {
        let ParametrizationConfig::Vertices(v) = &self.parametrization else {
            return Vec::new();
        };
        let beta = |value| Setting {
            high: 1.0 - f64::EPSILON,
            expected: "at least 0 and below 1",
            ..share("betas", value)
        };
        vec![
            not_negative("smoothing_start", v.smoothing_start),
            not_negative("smoothing_end", v.smoothing_end),
            share("adaptivity", v.adaptivity),
            share("adapt_from", v.adapt_from),
            count("n_levels", v.n_levels),
            beta(v.betas[0]),
            beta(v.betas[1]),
        ]
    }

    pub(crate) fn weights_at(&self, iteration: usize) -> Weights {
        let mut start = 0;
        for stage in &self.stages {
            if iteration < start + stage.n_iterations {
                let t = (iteration - start) as f64 / stage.n_iterations as f64;
                return Weights::between(&stage.from, &stage.to, t);
            }
            start += stage.n_iterations;
        }
        self.stages.last().map_or(Weights::ZERO, |s| s.to)
    }

    /// The iteration at which each stage starts.
    pub(crate) fn stage_starts(&self) -> Vec<usize> {
        self.stages
            .iter()
            .scan(0, |next, stage| {
                let start = *next;
                *next += stage.n_iterations;
                Some(start)
            })
            .collect()
    }
}
