//! Parts of a source that are treated in their own way: free, rigid, or less attracted.

pub(crate) mod hidden;
mod named;

use std::fs;
use std::path::Path;
use std::sync::OnceLock;

use anyhow::{anyhow, ensure, Context as _};
use drape_studio::Parts;
use mesh_core::{TriangleBvh, VertexData, VertexId};
use neural_drape::Regions;

use crate::input::{Pair, Source};
use hidden::Hidden;

/// Which parts of the source are not draped like the rest.
#[derive(Clone, Debug, Default, clap::Args)]
pub(crate) struct RegionArgs {
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

/// The regions of a pair, and what was decided without being asked, in words.
pub(crate) struct Chosen {
    pub(crate) regions: Regions,
    pub(crate) notes: Vec<String>,
}

impl RegionArgs {
    /// As if these names had been given.
    pub(crate) fn named(parts: &Parts) -> Self {
        Self {
            free: parts.free.clone(),
            rigid: parts.rigid.clone(),
            draped: parts.draped.clone(),
            ..Self::default()
        }
    }

    /// Looks the parts up. Inner pieces that no one names are found.
    pub(crate) fn resolve(&self, pair: &Pair) -> anyhow::Result<Chosen> {
        let mut chosen = self.resolve_knowing(pair, &OnceLock::new())?;
        for note in &mut chosen.notes {
            *note += " (--free, --rigid and --draped decide otherwise, --no-hidden turns this off)";
        }
        Ok(chosen)
    }

    /// As [`Self::resolve`], with the inner surfaces of the pair where they are known already.
    pub(crate) fn resolve_knowing(
        &self,
        pair: &Pair,
        hidden: &OnceLock<Hidden>,
    ) -> anyhow::Result<Chosen> {
        let n = pair.source.mesh.n_vertices();
        let mut regions = Regions::none(n);
        if let Some(spec) = &self.weights {
            regions.attraction =
                weights(spec, pair).with_context(|| format!("--weights {spec}"))?;
        }
        for spec in &self.free {
            let part = named::find(spec, pair, hidden).with_context(|| format!("--free {spec}"))?;
            for v in part.ids().filter(|&v| part[v]) {
                regions.attraction[v] = 0.0;
            }
        }
        for spec in &self.rigid {
            let part =
                named::find(spec, pair, hidden).with_context(|| format!("--rigid {spec}"))?;
            for v in part.ids().filter(|&v| part[v]) {
                regions.rigid[v] = true;
            }
        }
        let mut is_draped = VertexData::new(n, false);
        for spec in &self.draped {
            let part =
                named::find(spec, pair, hidden).with_context(|| format!("--draped {spec}"))?;
            for v in part.ids().filter(|&v| part[v]) {
                is_draped[v] = true;
            }
        }
        let is_all_free = regions.attraction.iter().all(|&a| a == 0.0);
        ensure!(
            !is_all_free,
            "the free parts are the whole source: nothing is left to drape"
        );
        let notes = if self.no_hidden {
            Vec::new()
        } else {
            let hidden = hidden.get_or_init(|| Hidden::of(pair));
            hidden::add_inner_pieces(hidden, &is_draped, &mut regions)
        };
        Ok(Chosen { regions, notes })
    }
}

/// One weight per vertex; those that a file does not name are 1.
fn weights(spec: &str, pair: &Pair) -> anyhow::Result<VertexData<f64>> {
    let n = pair.source.mesh.n_vertices();
    if let Some(name) = spec.strip_prefix("property:") {
        let values = named::property(name, pair)?;
        return in_range(values.into_iter().collect());
    }
    let mut weights = VertexData::new(n, 1.0);
    let path = Path::new(spec);
    let text = fs::read_to_string(path).context("cannot be read")?;
    for (row, words) in numbered_lines(&text) {
        let place = || format!("line {row}");
        let [vertex, weight] = words[..] else {
            return Err(anyhow!("needs a vertex and a weight")).with_context(place);
        };
        let v = named::vertex(vertex, &pair.source).with_context(place)?;
        weights[v] = weight
            .parse()
            .with_context(|| format!("'{weight}' is no number"))
            .with_context(place)?;
    }
    in_range(weights)
}

fn in_range(weights: VertexData<f64>) -> anyhow::Result<VertexData<f64>> {
    let bad = weights.ids().find(|&v| !(0.0..=1.0).contains(&weights[v]));
    match bad {
        Some(v) => Err(anyhow!(
            "vertex {} has the weight {}; weights go from 0 to 1",
            v.index(),
            weights[v]
        )),
        None => Ok(weights),
    }
}

/// The words of each line that says something, and its number from 1; `#` begins a comment.
fn numbered_lines(text: &str) -> impl Iterator<Item = (usize, Vec<&str>)> {
    let lines = text.lines().enumerate().map(|(row, line)| {
        let line = line.split('#').next().unwrap_or_default();
        let words = line.split(|c: char| c.is_whitespace() || c == ',');
        (row + 1, words.filter(|w| !w.is_empty()).collect::<Vec<_>>())
    });
    lines.filter(|(_, words)| !words.is_empty())
}

/// The hierarchy of the source at rest.
fn bvh(source: &Source) -> TriangleBvh {
    TriangleBvh::new(source.triangulation.corners(&source.rest).collect())
}

/// Vertices with a triangle, piece by piece: each ascending, pieces in order of their first vertex.
fn pieces(source: &Source) -> Vec<Vec<VertexId>> {
    let pieces = source.mesh.pieces();
    let mut lists = vec![Vec::new(); pieces.n];
    for v in source.mesh.vertices() {
        if !source.mesh.outgoing(v).is_empty() {
            lists[pieces.of_vertex[v.index()] as usize].push(v);
        }
    }
    lists.retain(|list| !list.is_empty());
    lists
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_split_and_comments_dropped() {
        let lines: Vec<_> = numbered_lines("# a\n1, 0.5\n\n2 0 # b\n").collect();
        assert_eq!(lines, [(2, vec!["1", "0.5"]), (4, vec!["2", "0"])]);
    }
}
