//! The `drape` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    drape_cli::run(std::env::args_os())
}
