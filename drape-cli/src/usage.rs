//! Time and memory that a run took.

use std::fmt;
use std::fs;
use std::time::Instant;

use serde::Serialize;

/// Clock ticks a second in `/proc`; Linux fixes it for programs whatever the kernel's own rate.
const TICKS_PER_SECOND: f64 = 100.0;

/// A running stopwatch for wall and processor time.
pub(crate) struct Stopwatch {
    start: Instant,
    cpu_at_start: Option<f64>,
}

/// What a run took. Figures that the system does not tell are left out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Usage {
    /// Seconds on the clock.
    pub(crate) wall_seconds: f64,
    /// Seconds of all processors together.
    pub(crate) cpu_seconds: Option<f64>,
    /// Largest memory of the whole process, in units of 10⁶ bytes.
    pub(crate) peak_mb: Option<f64>,
}

impl Stopwatch {
    pub(crate) fn start() -> Self {
        Self {
            start: Instant::now(),
            cpu_at_start: cpu_seconds(),
        }
    }

    pub(crate) fn read(&self) -> Usage {
        Usage {
            wall_seconds: self.start.elapsed().as_secs_f64(),
            cpu_seconds: cpu_seconds()
                .zip(self.cpu_at_start)
                .map(|(now, start)| now - start),
            peak_mb: peak_mb(),
        }
    }
}

impl Usage {
    /// The figures by name, for requirements and tables.
    pub(crate) fn figures(&self) -> Vec<(&'static str, f64)> {
        let figures = [
            ("wall_seconds", Some(self.wall_seconds)),
            ("cpu_seconds", self.cpu_seconds),
            ("peak_mb", self.peak_mb),
        ];
        figures
            .into_iter()
            .filter_map(|(name, value)| Some((name, value?)))
            .collect()
    }
}

impl fmt::Display for Usage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.1} s", self.wall_seconds)?;
        if let Some(cpu) = self.cpu_seconds {
            write!(f, ", {cpu:.1} CPU-seconds")?;
        }
        if let Some(peak) = self.peak_mb {
            write!(f, ", peak memory {peak:.0} MB")?;
        }
        Ok(())
    }
}

/// User and system time of this process.
fn cpu_seconds() -> Option<f64> {
    parse_stat(&fs::read_to_string("/proc/self/stat").ok()?)
}

/// Fields 14 and 15, counted after the program's name, which may itself hold spaces and parentheses.
fn parse_stat(stat: &str) -> Option<f64> {
    let (_, after_name) = stat.rsplit_once(')')?;
    let mut fields = after_name.split_whitespace().skip(11);
    let mut ticks = || fields.next()?.parse::<f64>().ok();
    Some((ticks()? + ticks()?) / TICKS_PER_SECOND)
}

fn peak_mb() -> Option<f64> {
    parse_peak(&fs::read_to_string("/proc/self/status").ok()?)
}

fn parse_peak(status: &str) -> Option<f64> {
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib * 1024.0 / 1e6)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn proc_files_are_understood() {
        let stat = "7 (a ) b) S 1 7 7 0 -1 4194304 100 0 0 0 150 50 0 0 20 0 1 0 99 1 1";
        assert_eq!(parse_stat(stat), Some(2.0));
        assert_eq!(parse_peak("VmPeak: 9 kB\nVmHWM:\t  1000 kB\n"), Some(1.024));
        assert_eq!(parse_peak("nothing"), None);
    }

    #[test]
    fn time_passes() {
        let watch = Stopwatch::start();
        let usage = watch.read();
        assert!(usage.wall_seconds >= 0.0);
        assert!(usage
            .figures()
            .iter()
            .any(|(name, _)| *name == "wall_seconds"));
    }
}
