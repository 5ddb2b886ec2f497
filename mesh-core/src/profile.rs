//! Where time went.

use std::time::Duration;

/// A clock that only goes forward: of the wall, or of the processor.
pub type Clock = fn() -> Duration;

/// One kind of work: what all its turns took together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// What was done.
    pub name: &'static str,
    /// How long it took, over all turns.
    pub total: Duration,
    /// How often it was done.
    pub n_turns: usize,
}

/// A stopwatch with a hand for each kind of work; the one that is off reads no clock and keeps nothing.
///
/// ```
/// use mesh_core::Profile;
/// let mut profile = Profile::on(std::time::Duration::default);
/// let sum: u32 = profile.time("adding", || (1..10).sum());
/// assert_eq!((sum, profile.spans()[0].name, profile.spans()[0].n_turns), (45, "adding", 1));
/// ```
#[derive(Clone, Debug, Default)]
pub struct Profile {
    clock: Option<Clock>,
    spans: Vec<Span>,
}

impl Profile {
    /// A stopwatch that stands still.
    pub const fn off() -> Self {
        Self {
            clock: None,
            spans: Vec::new(),
        }
    }

    /// A stopwatch by this clock.
    pub const fn on(clock: Clock) -> Self {
        Self {
            clock: Some(clock),
            spans: Vec::new(),
        }
    }

    /// A stopwatch by the same clock, at zero.
    #[must_use]
    pub fn fresh(&self) -> Self {
        Self {
            clock: self.clock,
            spans: Vec::new(),
        }
    }

    /// Does `work` and counts what it took under `name`.
    #[inline]
    pub fn time<R>(&mut self, name: &'static str, work: impl FnOnce() -> R) -> R {
        let Some(clock) = self.clock else {
            return work();
        };
        let start = clock();
        let done = work();
        self.add(name, clock().saturating_sub(start), 1);
        done
    }

    /// What each kind of work took, in the order in which they first ended.
    pub fn spans(&self) -> &[Span] {
        &self.spans
    }

    /// Adds what another stopwatch measured.
    pub fn extend(&mut self, other: &Self) {
        for span in &other.spans {
            self.add(span.name, span.total, span.n_turns);
        }
    }

    fn add(&mut self, name: &'static str, took: Duration, n_turns: usize) {
        match self.spans.iter_mut().find(|s| s.name == name) {
            Some(span) => {
                span.total += took;
                span.n_turns += n_turns;
            }
            None => self.spans.push(Span {
                name,
                total: took,
                n_turns,
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};

    use super::*;

    /// A clock that goes forward by a second with every look.
    fn ticking() -> Duration {
        static SECONDS: AtomicU64 = AtomicU64::new(0);
        Duration::from_secs(SECONDS.fetch_add(1, Ordering::Relaxed))
    }

    #[test]
    fn turns_of_one_name_add_up() {
        let mut profile = Profile::on(ticking);
        for _ in 0..3 {
            profile.time("a", || ());
        }
        let mut all = Profile::off();
        all.extend(&profile);
        all.extend(&profile);
        let [span] = all.spans() else {
            panic!("one kind of work")
        };
        assert_eq!((span.name, span.n_turns), ("a", 6));
        assert_eq!(span.total, Duration::from_secs(6));
    }

    #[test]
    fn off_keeps_nothing() {
        let mut profile = Profile::off();
        assert_eq!(profile.time("a", || 7), 7);
        assert!(profile.spans().is_empty());
    }
}
