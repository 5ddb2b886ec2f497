//! Two fuzz targets without a fuzzer: seeds with deterministic damage, handed to the whole command.
//!
//! `cargo run --workspace --bin drape-fuzz -- command|papers SECONDS FOLDER [FIRST]` runs inputs FIRST, FIRST + 1, …; the
//! same number is the same input on every machine. A process of its own runs them; this one watches it: a crash, an input
//! that takes more than 5 CPU-seconds, and more than 1 GB are finds, left in FOLDER by their number. Exit code 1 where
//! there is one.

#![allow(
    clippy::print_stdout,
    clippy::expect_used,
    reason = "a program for whoever works on the readers"
)]

#[path = "../src/command.rs"]
#[allow(
    missing_docs,
    unreachable_pub,
    reason = "shared with the package of the fuzzer"
)]
mod command;
mod mutate;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitCode, Stdio};
use std::time::{Duration, Instant};

use command::Place;
use mutate::input;

/// The most that one input may take, in CPU-seconds and in 10⁶ bytes.
const MOST_SECONDS: f64 = 5.0;
const MOST_MB: f64 = 1000.0;
/// The number of the input at work.
const AT_WORK: &str = "at-work";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        ["--run", target, folder, first] => run(target, Path::new(folder), number(first)),
        [target, seconds, folder] => watch(target, number(seconds), Path::new(folder), 0),
        [target, seconds, folder, first] => {
            watch(target, number(seconds), Path::new(folder), number(first))
        }
        _ => {
            println!("command|papers SECONDS FOLDER [FIRST]");
            ExitCode::from(2)
        }
    }
}

fn number(word: &str) -> u64 {
    word.parse().expect("a whole number")
}

/// Runs inputs for ever.
fn run(target: &str, folder: &Path, first: u64) -> ExitCode {
    let place = Place::new(&folder.join("place"));
    let seeds = seeds(target);
    for k in first.. {
        fs::write(folder.join(AT_WORK), k.to_string()).expect("a number is written");
        let bytes = input(&seeds, k);
        match target {
            "command" => place.mesh_file(&bytes),
            _ => place.papers(&bytes),
        }
    }
    ExitCode::SUCCESS
}

/// The files that damage starts from, each with the bytes before it that choose its role.
fn seeds(target: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/seeds");
    let folders: &[(&str, &[u8])] = match target {
        "command" => &[
            ("obj", &[0, 0]),
            ("off", &[0, 2]),
            ("ply", &[0, 1]),
            ("stl", &[0, 3]),
            ("gltf", &[0, 4]),
            ("xyz", &[0, 6]),
            ("any", &[0, 7]),
            ("whole", &[0, 7]),
        ],
        _ => &[("landmarks", &[0]), ("settings", &[1]), ("papers", &[3])],
    };
    let of_folder = |(name, prefix): &(&str, &[u8])| -> Vec<Vec<u8>> {
        let mut paths: Vec<PathBuf> = fs::read_dir(folder.join(name))
            .expect("seeds")
            .flatten()
            .map(|entry| entry.path())
            .collect();
        paths.sort();
        let seed = |path: &PathBuf| [prefix, &fs::read(path).expect("a seed")[..]].concat();
        paths.iter().map(seed).collect()
    };
    folders.iter().flat_map(of_folder).collect()
}

/// Keeps a process at work for so long, and says what was found.
fn watch(target: &str, seconds: u64, folder: &Path, first: u64) -> ExitCode {
    fs::create_dir_all(folder).expect("a folder");
    let (start, seeds) = (Instant::now(), seeds(target));
    let (mut next, mut finds, mut peak, mut slowest) = (first, Vec::new(), 0.0f64, 0.0f64);
    while start.elapsed().as_secs() < seconds {
        let mut child = begin(target, folder, next);
        let mut since = (next, 0.0);
        let found = loop {
            std::thread::sleep(Duration::from_millis(200));
            let k = at_work(folder, next);
            if let Some(status) = child.try_wait().expect("a child") {
                break Some(format!("ended with {status}"));
            }
            let used = Used::of(&child);
            if since.0 != k {
                since = (k, used.seconds);
            }
            peak = peak.max(used.peak_mb);
            slowest = slowest.max(used.seconds - since.1);
            if used.seconds - since.1 > MOST_SECONDS {
                break Some(format!("took more than {MOST_SECONDS} s"));
            }
            if used.peak_mb > MOST_MB {
                break Some(format!("took {:.0} MB", used.peak_mb));
            }
            if start.elapsed().as_secs() >= seconds {
                break None;
            }
        };
        // It may have ended already.
        let _ = child.kill();
        child.wait().expect("a child");
        next = at_work(folder, next) + 1;
        if let Some(what) = found {
            let path = folder.join(format!("{target}-{}", next - 1));
            fs::write(&path, input(&seeds, next - 1)).expect("a find is written");
            println!("FOUND {}: {what}", path.display());
            finds.push(path);
        }
    }
    println!(
        "{target}: {} inputs, {} finds, peak {peak:.0} MB, slowest {slowest:.1} CPU-seconds",
        next - first,
        finds.len()
    );
    ExitCode::from(u8::from(!finds.is_empty()))
}

/// A process that panics ends: only then is the input known.
fn begin(target: &str, folder: &Path, first: u64) -> Child {
    let program = std::env::current_exe().expect("this program");
    let log = fs::File::create(folder.join("stderr")).expect("a log");
    Command::new(program)
        .arg("--run")
        .arg(target)
        .arg(folder)
        .arg(first.to_string())
        .stdout(Stdio::null())
        .stderr(log)
        .spawn()
        .expect("a process")
}

fn at_work(folder: &Path, otherwise: u64) -> u64 {
    let text = fs::read_to_string(folder.join(AT_WORK)).unwrap_or_default();
    text.parse().unwrap_or(otherwise)
}

/// What a process has used so far.
struct Used {
    seconds: f64,
    peak_mb: f64,
}

impl Used {
    /// From `/proc`; nothing where there is none.
    fn of(child: &Child) -> Self {
        let read = |name: &str| {
            fs::read_to_string(format!("/proc/{}/{name}", child.id())).unwrap_or_default()
        };
        let stat = read("stat");
        let fields = stat.rsplit_once(')').map_or("", |(_, rest)| rest);
        let ticks: f64 = fields
            .split_whitespace()
            .skip(11)
            .take(2)
            .filter_map(|field| field.parse::<f64>().ok())
            .sum();
        let status = read("status");
        let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kib = peak.and_then(|text| text.trim().strip_suffix("kB"));
        let kib: Option<f64> = kib.and_then(|text| text.trim().parse().ok());
        Self {
            seconds: ticks / 100.0,
            peak_mb: kib.unwrap_or(0.0) * 1024.0 / 1e6,
        }
    }
}
