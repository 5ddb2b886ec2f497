//! Pairs of creatures built in code, as files: those of the bench and that of the demo.

mod bench;
mod demo;
mod files;
mod table;

pub(crate) use bench::{Case, Grid};
pub(crate) use demo::pair as demo_pair;
pub(crate) use files::{write, PairFiles};
pub(crate) use table::{BenchRow, Table};
