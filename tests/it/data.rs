//! Real data and a browser, where they are; a test that goes without says so, and is counted.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

/// The folder of all pairs: in `DRAPE_DATA`, or in `shared/data` beside the workspace; none where it is not there.
pub(crate) fn pairs() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
    let data = std::env::var_os("DRAPE_DATA").map_or(beside, PathBuf::from);
    let pairs = data.join("pairs");
    if pairs.is_dir() {
        return Some(pairs);
    }
    skip(&format!("no {}; set DRAPE_DATA", pairs.display()));
    None
}

/// The authors' own pair, likewise.
pub(crate) fn horse_wolf() -> Option<PathBuf> {
    Some(pairs()?.join("horse_wolf"))
}

/// Says that a test has nothing to work on. It writes past the test runner, which shows nothing that a passing test
/// prints.
pub(crate) fn skip(why: &str) {
    static N_SKIPPED: AtomicUsize = AtomicUsize::new(0);
    let n = N_SKIPPED.fetch_add(1, Ordering::Relaxed) + 1;
    // Where the terminal is gone, nobody is left to tell.
    drop(writeln!(
        std::io::stderr(),
        "skipped: {why} ({n} skipped so far)"
    ));
}
