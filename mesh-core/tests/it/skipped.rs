//! Tests that go without data say so, and are counted.

use std::io::Write as _;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Says that a test has nothing to work on, past the test runner, which shows nothing that a passing test prints.
pub(crate) fn skip(why: &str) {
    static N_SKIPPED: AtomicUsize = AtomicUsize::new(0);
    let n = N_SKIPPED.fetch_add(1, Ordering::Relaxed) + 1;
    // Where the terminal is gone, nobody is left to tell.
    drop(writeln!(
        std::io::stderr(),
        "skipped: {why} ({n} skipped so far)"
    ));
}
