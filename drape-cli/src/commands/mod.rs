//! One file per command: its arguments and what it does.

mod apply;
mod bake;
mod batch;
mod bench;
mod demo;
mod evaluate;
mod init;
mod inspect;
mod landmarks;
mod metrics;
mod presets;
mod replay;
mod studio;
mod transfer;

use std::process::ExitCode;

use clap::Subcommand;

/// Everything `drape` can do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Drape a mesh over a target: the whole method, from files to a file
    Transfer(Box<transfer::Args>),
    /// Deform a mesh by its landmarks only
    Init(init::Args),
    /// Send other points through the map of a finished drape
    Apply(apply::Args),
    /// Bake the target's colours, normals and relief into the texture coordinates of a draped mesh
    Bake(bake::Args),
    /// Look at landmarks: check, suggest more, mirror, convert
    Landmarks(landmarks::Args),
    /// Judge a draped mesh
    Metrics(metrics::Args),
    /// Tell what is in a mesh file
    Inspect(inspect::Args),
    /// List the presets, or print the settings of one as TOML
    Presets(presets::Args),
    /// Drape creatures built in code, whose truth is known, at any difficulty
    Bench(bench::Args),
    /// Drape one mesh over many targets
    Batch(batch::Args),
    /// Run and judge many pairs with many presets and seeds
    Evaluate(evaluate::Args),
    /// Mark, preview, drape, pause and add places in the browser
    Studio(studio::Args),
    /// Do a session of the studio again, to the same bits
    Replay(replay::Args),
    /// See a drape without any file of your own
    Demo(demo::Args),
}

impl Command {
    pub(crate) fn run(&self) -> anyhow::Result<ExitCode> {
        match self {
            Self::Transfer(args) => transfer::run(args),
            Self::Init(args) => init::run(args),
            Self::Apply(args) => apply::run(args),
            Self::Bake(args) => bake::run(args),
            Self::Landmarks(args) => landmarks::run(args),
            Self::Metrics(args) => metrics::run(args),
            Self::Inspect(args) => inspect::run(args),
            Self::Presets(args) => presets::run(args),
            Self::Bench(args) => bench::run(args),
            Self::Batch(args) => batch::run(args),
            Self::Evaluate(args) => evaluate::run(args),
            Self::Studio(args) => studio::run(args),
            Self::Replay(args) => replay::run(args),
            Self::Demo(args) => demo::run(args),
        }
    }
}
