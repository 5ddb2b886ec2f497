//! How pictures are taken.

use mesh_render::{Up, View};

/// How pictures are taken.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct ViewArgs {
    /// Direction to look from: quarter, front, side, back, top or AZIMUTH,ELEVATION in degrees; may be repeated
    #[arg(long, value_name = "VIEW", allow_hyphen_values = true)]
    pub(crate) view: Vec<View>,
    /// Axis that points up in the target's file
    #[arg(long, value_name = "AXIS", default_value = "y")]
    pub(crate) up: UpArg,
}

/// [`Up`] on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum UpArg {
    /// +Y up, front towards +Z (Blender's OBJ export, Maya, glTF)
    Y,
    /// +Z up, front towards −Y (Blender's own axes, scanners)
    Z,
}

impl ViewArgs {
    /// As if nothing had been given.
    pub(crate) fn none() -> Self {
        Self {
            view: Vec::new(),
            up: UpArg::Y,
        }
    }

    /// The views asked for, or these.
    pub(crate) fn views_or(&self, default: &[View]) -> Vec<View> {
        if self.view.is_empty() {
            default.to_vec()
        } else {
            self.view.clone()
        }
    }

    /// The axis that points up.
    pub(crate) fn up(&self) -> Up {
        match self.up {
            UpArg::Y => Up::Y,
            UpArg::Z => Up::Z,
        }
    }
}
