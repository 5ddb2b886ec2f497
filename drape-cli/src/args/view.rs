//! How pictures are taken.

use mesh_render::{Up, View};

/// How pictures are taken.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct ViewArgs {
    /// Direction to look from: quarter, front, side, back, top or AZIMUTH,ELEVATION in degrees; may be repeated
    #[arg(long, value_name = "VIEW", allow_hyphen_values = true)]
    pub(crate) view: Vec<View>,
    /// Axis that points up in the target's file: x, y, z, -x, -y or -z; found from the shapes where not given
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true)]
    pub(crate) up: Option<Up>,
}

impl ViewArgs {
    /// As if nothing had been given.
    pub(crate) fn none() -> Self {
        Self {
            view: Vec::new(),
            up: None,
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
}
