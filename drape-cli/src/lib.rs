//! The `drape` command: drape your mesh over that shape.
//!
//! Everything is in [`run`], so that the binary is one line and tests can be another.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "the command line speaks to its user"
)]

mod args;
mod commands;
mod creatures;
mod inspection;
mod output;
mod profile;
mod program;
mod progress;
mod requirement;
mod study;
mod suite;
mod usage;
mod words;

use std::ffi::OsString;
use std::process::ExitCode;

use anyhow::Context as _;
use clap::error::ErrorKind;
use clap::Parser;

pub use program::Program;

/// No more threads are started, whatever is asked for: each takes memory, and none beyond the processors helps.
const MAX_THREADS: usize = 512;
/// Bad input, bad options, or a run that could not be finished.
const FAILED: u8 = 2;

/// Drape your mesh over that shape.
#[derive(Debug, Parser)]
#[command(name = "drape", version, about, max_term_width = 100)]
struct Cli {
    /// Threads to use; all processors where not given. The result does not depend on it
    #[arg(long, global = true, value_name = "N")]
    threads: Option<std::num::NonZeroUsize>,
    #[command(subcommand)]
    command: commands::Command,
}

/// Runs the command line `args`, program name first. Exit codes: 0 done, 1 a requirement is not met, 2 failed.
pub fn run(args: impl IntoIterator<Item = OsString>) -> ExitCode {
    let cli = match Cli::try_parse_from(args) {
        Ok(cli) => cli,
        Err(error) => return refuse(&error),
    };
    cli.run().unwrap_or_else(|error| {
        eprintln!("error: {}", one_line(&format!("{error:#}")));
        ExitCode::from(FAILED)
    })
}

/// As [`run`], for a program that is not the running executable: a script of another language's package.
pub fn run_as(program: Program, args: impl IntoIterator<Item = OsString>) -> ExitCode {
    program.remember();
    run(args)
}

impl Cli {
    fn run(&self) -> anyhow::Result<ExitCode> {
        let Some(n) = self.threads else {
            return self.command.run();
        };
        if n.get() > MAX_THREADS {
            output::warn(&[format!(
                "--threads {n} is more than this program starts: it uses {MAX_THREADS}"
            )]);
        }
        let n = n.get().min(MAX_THREADS);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build();
        pool.context("cannot start threads")?
            .install(|| self.command.run())
    }
}

/// Help and version go to stdout as they are; a mistake gives one line.
fn refuse(error: &clap::Error) -> ExitCode {
    if error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
        eprint!("{error}");
        return ExitCode::from(FAILED);
    }
    if !error.use_stderr() {
        return match output::say(&error.render().to_string()) {
            Ok(()) => ExitCode::SUCCESS,
            Err(_) => ExitCode::from(FAILED),
        };
    }
    let text = error.render().to_string();
    let mistake = text.split("\n\n").next().unwrap_or_default();
    eprintln!("{} (see drape --help)", one_line(mistake));
    ExitCode::from(FAILED)
}

/// Text without line breaks, and without what a terminal would take as a command.
fn one_line(text: &str) -> String {
    let joined = text.lines().map(str::trim).collect::<Vec<_>>().join(" ");
    mesh_core::io::printable(&joined).into_owned()
}
