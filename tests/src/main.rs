//! The `drape` command, for the end-to-end tests in `it/`.

use std::process::ExitCode;

fn main() -> ExitCode {
    drape_cli::run(std::env::args_os())
}
