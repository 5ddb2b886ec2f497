//! Options that several commands share.

mod bake;
mod gate;
mod inputs;
mod parts;
mod pipe;
mod settings;
mod view;

pub(crate) use bake::{bake, check_bakeable, check_maps, BakeArgs, MapArgs};
pub(crate) use gate::{write_between, GateArgs};
pub(crate) use inputs::{read_population, read_truth, Inputs, MorphArgs, Morphing, WeldArgs};
pub(crate) use parts::PartArgs;
pub(crate) use pipe::{is_pipe, say_beside, wrote, PipeArgs};
pub(crate) use settings::{InitialArg, SettingsArgs};
pub(crate) use view::ViewArgs;
