//! Where the time of a run went: stage by stage, and part by part of the iterations where that was asked for.

use std::fmt::Write as _;
use std::time::{Duration, Instant};

use mesh_core::Span;
use mesh_draping::{Stages, DRAPING};
use serde_json::{json, Value};

use crate::usage::Usage;

/// What asks for a profile.
#[derive(Debug, clap::Args)]
pub(crate) struct ProfileArgs {
    /// Tell where the time went, stage by stage and term by term
    #[arg(long)]
    pub(crate) profile: bool,
}

impl ProfileArgs {
    /// Stopwatches for the stages, and for the parts of the iterations if they are asked for.
    pub(crate) fn stages(&self) -> Stages {
        let stages = Stages::on(wall_time, processor_time);
        if self.profile {
            stages.with_parts(processor_time)
        } else {
            stages
        }
    }
}

/// Seconds on the clock by stage.
pub(crate) fn seconds(stages: &Stages) -> Vec<(&'static str, f64)> {
    let spans = stages.wall().spans().iter();
    spans.map(|s| (s.name, s.total.as_secs_f64())).collect()
}

/// The table that `--profile` prints.
pub(crate) fn table(stages: &Stages, usage: &Usage) -> String {
    let mut table = format!(
        "{:<28}{:>9}{:>9}\n",
        "where the time went", "wall s", "CPU s"
    );
    let (wall, cpu) = (stages.wall().spans(), stages.cpu().spans());
    for (wall, cpu) in wall.iter().zip(cpu) {
        let [w, c] = [wall, cpu].map(|s| s.total.as_secs_f64());
        // Writing into a string cannot fail.
        let _ = writeln!(table, "{:<28}{w:>9.3}{c:>9.3}", wall.name);
    }
    let drapes = cpu.iter().filter(|s| s.name.starts_with(DRAPING));
    table += &parts_table(stages.parts().spans(), drapes.map(|s| s.total).sum());
    let _ = writeln!(table, "all: {usage}");
    table
}

fn parts_table(parts: &[Span], whole: Duration) -> String {
    let whole = whole.as_secs_f64();
    let mut rows = String::new();
    let mut row = |name: &str, seconds: f64, n_turns: &str| {
        let share = 100.0 * seconds / whole.max(f64::MIN_POSITIVE);
        let _ = writeln!(
            rows,
            "  {name:<26}{:>9}{seconds:>9.3}{share:>5.0} %{n_turns}",
            ""
        );
    };
    let mut rest = whole;
    for Span {
        name,
        total,
        n_turns,
    } in sorted(parts)
    {
        row(name, total.as_secs_f64(), &format!("{n_turns:>7} times"));
        rest -= total.as_secs_f64();
    }
    row("everything else", rest.max(0.0), "");
    rows
}

/// The same as JSON: CPU-seconds by name.
pub(crate) fn json(stages: &Stages) -> Value {
    let seconds = |spans: &[Span]| -> Value {
        let pairs = spans.iter();
        pairs
            .map(|s| (s.name.to_owned(), json!(s.total.as_secs_f64())))
            .collect::<serde_json::Map<_, _>>()
            .into()
    };
    json!({ "cpu_seconds": seconds(stages.cpu().spans()), "parts": seconds(stages.parts().spans()) })
}

/// Longest first.
fn sorted(spans: &[Span]) -> Vec<Span> {
    let mut spans = spans.to_vec();
    spans.sort_by_key(|s| std::cmp::Reverse(s.total));
    spans
}

/// Time on the clock since this was first asked.
fn wall_time() -> Duration {
    static START: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
    START.get_or_init(Instant::now).elapsed()
}

/// What all processors together have spent on this process.
#[cfg(unix)]
pub(crate) fn processor_time() -> Duration {
    let now = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Duration::new(
        u64::try_from(now.tv_sec).unwrap_or_default(),
        u32::try_from(now.tv_nsec).unwrap_or_default(),
    )
}

/// Time on the clock, where the system's count of processor time is not known.
#[cfg(not(unix))]
pub(crate) fn processor_time() -> Duration {
    wall_time()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spin() -> u64 {
        (0..2_000_000u64).fold(0, |a, b| std::hint::black_box(a ^ b))
    }

    #[test]
    fn work_takes_processor_time_and_is_told() {
        let mut stages = ProfileArgs { profile: true }.stages();
        stages.time(DRAPING, spin);
        let usage = crate::usage::Stopwatch::start().read();
        let told = table(&stages, &usage);
        assert!(told.lines().any(|line| line.starts_with(DRAPING)), "{told}");
        assert!(told.contains("everything else"), "{told}");
        let seconds = &json(&stages)["cpu_seconds"][DRAPING];
        assert!(seconds.as_f64().is_some_and(|s| s > 0.0), "{seconds}");
    }

    #[test]
    fn without_the_option_there_are_stages_alone() {
        let mut stages = ProfileArgs { profile: false }.stages();
        stages.time(DRAPING, || ());
        assert_eq!(seconds(&stages)[0].0, DRAPING);
        assert!(stages.parts().spans().is_empty());
    }
}
