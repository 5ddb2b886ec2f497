//! Parts of the source that are treated in their own way.

use mesh_draping::parts::ResolvedParts;
use mesh_draping::{Pair, Parts};

use crate::words;

/// Which parts of the source are not draped like the rest.
#[derive(Clone, Debug, Default, clap::Args)]
pub(crate) struct PartArgs {
    /// Part that attracts nothing and is carried along smoothly, as the lining of a mouth: the name of a group, object or
    /// material, property:NAME of a PLY file, a file of vertex numbers, or "hidden", "hidden:1" and so on
    /// for inner surfaces; may be repeated
    #[arg(long, value_name = "PART")]
    free: Vec<String>,
    /// Part whose pieces move as one body each, as eyeballs and teeth; named like --free; may be repeated
    #[arg(long, value_name = "PART")]
    rigid: Vec<String>,
    /// Inner part that is draped like the rest, although nobody sees it; named like --free; may be repeated
    #[arg(long, value_name = "PART")]
    draped: Vec<String>,
    /// How strongly each vertex is attracted, from 0 to 1: a file of lines "vertex weight", or property:NAME of a PLY file
    #[arg(long, value_name = "FILE")]
    weights: Option<String>,
    /// Do not treat inner pieces that no one named as carried along
    #[arg(long)]
    no_hidden: bool,
}

impl PartArgs {
    /// Looks the parts up.
    pub(crate) fn resolve(&self, pair: &Pair) -> anyhow::Result<ResolvedParts> {
        let parts = Parts {
            free: self.free.clone(),
            rigid: self.rigid.clone(),
            draped: self.draped.clone(),
            weights: self.weights.clone(),
            is_hidden_draped: self.no_hidden,
        };
        parts
            .resolve(pair)
            .map_err(|error| anyhow::anyhow!(words::part_error(&error)))
    }
}
