//! A number among the settings and the range that it must lie in.

use crate::DrapeError;

/// There are at most so many of anything that is counted: iterations, samples, neurons.
pub(crate) const MAX_COUNT: usize = 1_000_000_000;

/// A setting with the range it must lie in; NaN lies in none.
pub(crate) struct Setting {
    pub(crate) name: String,
    pub(crate) value: f64,
    pub(crate) low: f64,
    pub(crate) high: f64,
    pub(crate) expected: &'static str,
}

impl Setting {
    /// From 0 to 1.
    pub(crate) fn share(name: &str, value: f64) -> Self {
        Self {
            name: name.to_owned(),
            value,
            low: 0.0,
            high: 1.0,
            expected: "between 0 and 1",
        }
    }

    /// Above 0 and at most 1.
    pub(crate) fn positive_share(name: &str, value: f64) -> Self {
        Self {
            low: f64::MIN_POSITIVE,
            expected: "above 0 and at most 1",
            ..Self::share(name, value)
        }
    }

    /// 0 or any positive number.
    pub(crate) fn not_negative(name: &str, value: f64) -> Self {
        Self {
            high: f64::MAX,
            expected: "0 or more",
            ..Self::share(name, value)
        }
    }

    /// Any positive number.
    pub(crate) fn positive(name: &str, value: f64) -> Self {
        Self {
            low: f64::MIN_POSITIVE,
            expected: "above 0",
            ..Self::not_negative(name, value)
        }
    }

    /// A number of things of which there is at least one.
    pub(crate) fn count(name: &str, value: usize) -> Self {
        Self {
            low: 1.0,
            expected: "between 1 and 10^9",
            ..Self::count_or_none(name, value)
        }
    }

    /// A number of things of which there is at least one, and which files count in a byte.
    pub(crate) fn few(name: &str, value: usize) -> Self {
        Self {
            high: f64::from(u8::MAX),
            expected: "between 1 and 255",
            ..Self::count(name, value)
        }
    }

    /// A number of things of which there may be none.
    pub(crate) fn count_or_none(name: &str, value: usize) -> Self {
        Self {
            high: MAX_COUNT as f64,
            expected: "between 0 and 10^9",
            ..Self::share(name, value as f64)
        }
    }

    /// Decay rate of a running mean.
    pub(crate) fn decay_rate(name: &str, value: f64) -> Self {
        Self {
            high: 1.0 - f64::EPSILON,
            expected: "at least 0 and below 1",
            ..Self::share(name, value)
        }
    }

    /// A number that is added to a cosine or compared with one.
    pub(crate) fn cosine(name: &str, value: f64) -> Self {
        Self {
            low: -1.0,
            expected: "between -1 and 1",
            ..Self::share(name, value)
        }
    }

    /// The first that is out of its range is an error.
    pub(crate) fn check(settings: Vec<Self>) -> Result<(), DrapeError> {
        let is_outside = |s: &Self| !(s.low..=s.high).contains(&s.value);
        match settings.into_iter().find(is_outside) {
            Some(s) => Err(DrapeError::Setting {
                name: s.name,
                value: s.value,
                expected: s.expected,
            }),
            None => Ok(()),
        }
    }
}
