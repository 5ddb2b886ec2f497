//! Parts of a source that are treated in their own way: free, rigid, less attracted, or inner ones draped after all.

mod error;
mod hidden;
mod named;
mod vertex_list;

pub use error::{LineProblem, PartError, PartList, PartProblem};
pub use hidden::{inner_surfaces, HiddenSurfaces, InnerKind, InnerSurface};

use std::path::Path;
use std::sync::OnceLock;

use mesh_core::VertexData;
use neural_drape::Regions;
use serde::{Deserialize, Serialize};

use crate::{Note, Pair};

/// Which parts of the source are not draped like the rest, by name.
///
/// A part is the name of a group, object or material of the file, `property:NAME` of a PLY file (where it is above 0.5),
/// the path of a file of vertex numbers, or `hidden`, `hidden:1` and so on for inner surfaces ([`HiddenSurfaces`]).
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Parts {
    /// Those that attract nothing and are carried along smoothly, as the lining of a mouth.
    pub free: Vec<String>,
    /// Those whose pieces move as one body each, as eyeballs and teeth.
    pub rigid: Vec<String>,
    /// Inner parts that are draped like the rest, although nobody sees them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub draped: Vec<String>,
    /// How strongly each vertex is attracted, from 0 to 1: the path of a file of lines "vertex weight", or
    /// `property:NAME` of a PLY file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub weights: Option<String>,
    /// Whether inner pieces that nobody named are draped like the rest; else they are carried along where the target
    /// has nothing like them.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_hidden_draped: bool,
}

/// How a part is draped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Treatment {
    /// Like the rest.
    Draped,
    /// It attracts nothing and is carried along.
    Free,
    /// Its pieces move as one body each.
    Rigid,
}

/// Parts that were looked up.
#[derive(Clone, Debug, PartialEq)]
pub struct ResolvedParts {
    /// How each vertex is treated.
    pub regions: Regions,
    /// What was decided without being asked.
    pub notes: Vec<Note>,
}

impl Parts {
    /// Looks the parts up on the source of a pair. Inner pieces that nobody names are found.
    ///
    /// # Errors
    /// The first part that is not found; free parts that are the whole source.
    pub fn resolve(&self, pair: &Pair) -> Result<ResolvedParts, PartError> {
        self.resolve_with(pair, &OnceLock::new())
    }

    /// As [`Self::resolve`]; the inner surfaces of the pair are taken from `hidden`, or found and kept there.
    ///
    /// # Errors
    /// As [`Self::resolve`].
    pub fn resolve_with(
        &self,
        pair: &Pair,
        hidden: &OnceLock<HiddenSurfaces>,
    ) -> Result<ResolvedParts, PartError> {
        let n = pair.source.rest().len();
        let mut regions = Regions::none(n);
        if let Some(spec) = &self.weights {
            regions.attraction = weights(spec, pair).map_err(named(PartList::Weights, spec))?;
        }
        for v in union(&self.free, PartList::Free, pair, hidden)?.ids_where() {
            regions.attraction[v] = 0.0;
        }
        regions.rigid = union(&self.rigid, PartList::Rigid, pair, hidden)?.0;
        let is_draped = union(&self.draped, PartList::Draped, pair, hidden)?.0;
        if regions.attraction.iter().all(|&a| a == 0.0) {
            return Err(PartError::AllFree);
        }
        let notes = if self.is_hidden_draped {
            Vec::new()
        } else {
            let hidden = hidden.get_or_init(|| HiddenSurfaces::of(pair));
            hidden.free_unnamed(&is_draped, &mut regions)
        };
        Ok(ResolvedParts { regions, notes })
    }
}

/// Vertices that are chosen.
struct Chosen(VertexData<bool>);

impl Chosen {
    fn ids_where(&self) -> impl Iterator<Item = mesh_core::VertexId> + '_ {
        self.0.ids().filter(|&v| self.0[v])
    }
}

/// The vertices of all parts of a list.
fn union(
    names: &[String],
    list: PartList,
    pair: &Pair,
    hidden: &OnceLock<HiddenSurfaces>,
) -> Result<Chosen, PartError> {
    let mut all = Chosen(VertexData::new(pair.source.rest().len(), false));
    for name in names {
        let part = named::find(name, pair, hidden).map_err(named(list, name))?;
        Chosen(part).ids_where().for_each(|v| all.0[v] = true);
    }
    Ok(all)
}

fn named(list: PartList, name: &str) -> impl Fn(PartProblem) -> PartError + '_ {
    move |problem| PartError::Part {
        list,
        name: name.to_owned(),
        problem,
    }
}

/// One weight per vertex; those that a file does not name are 1.
fn weights(spec: &str, pair: &Pair) -> Result<VertexData<f64>, PartProblem> {
    let weights = match spec.strip_prefix("property:") {
        Some(name) => named::property(name, pair)?.into_iter().collect(),
        None => vertex_list::read_weights(Path::new(spec), &pair.source)?,
    };
    match weights.ids().find(|&v| !(0.0..=1.0).contains(&weights[v])) {
        Some(v) => Err(PartProblem::Weight {
            row: pair.source.file_row(v),
            weight: weights[v],
        }),
        None => Ok(weights),
    }
}
