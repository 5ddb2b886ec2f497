//! Parts by name: groups, objects, materials, PLY properties, lists of vertices.

use std::fs;
use std::path::Path;
use std::sync::OnceLock;

use anyhow::{bail, ensure, Context as _};
use mesh_core::{FaceData, FaceId, VertexData, VertexId};

use super::hidden::{Hidden, Inner};
use super::numbered_lines;
use crate::input::{Pair, Source};

/// What selects the vertices of inner surfaces: all of them, or with `:K` the K-th.
pub(super) const HIDDEN: &str = "hidden";

/// The vertices of a part.
pub(super) fn find(
    spec: &str,
    pair: &Pair,
    hidden: &OnceLock<Hidden>,
) -> anyhow::Result<VertexData<bool>> {
    let n = pair.source.mesh.n_vertices();
    let inner = || &hidden.get_or_init(|| Hidden::of(pair)).inner;
    let part = if spec == HIDDEN {
        all(n, inner().iter().flat_map(|i| &i.vertices))
    } else if let Some(number) = spec.strip_prefix("hidden:") {
        all(n, &nth(number, inner())?.vertices)
    } else if let Some(name) = spec.strip_prefix("property:") {
        property(name, pair)?.into_iter().map(|x| x > 0.5).collect()
    } else if let Some(part) = of_faces(spec, pair) {
        part
    } else if Path::new(spec).is_file() {
        let text = fs::read_to_string(spec).context("cannot be read")?;
        let mut part = VertexData::new(n, false);
        for (row, words) in numbered_lines(&text) {
            for word in words {
                part[vertex(word, &pair.source).with_context(|| format!("line {row}"))?] = true;
            }
        }
        part
    } else {
        bail!(
            "is neither a name in the source nor a file; there are {}",
            names(pair)
        );
    };
    ensure!(
        part.iter().any(|&is_in| is_in),
        "selects no vertex of the source"
    );
    Ok(part)
}

fn all<'a>(n: usize, vertices: impl IntoIterator<Item = &'a VertexId>) -> VertexData<bool> {
    let mut part = VertexData::new(n, false);
    vertices.into_iter().for_each(|&v| part[v] = true);
    part
}

/// An inner surface by its number, counted from 1.
fn nth<'a>(number: &str, inner: &'a [Inner]) -> anyhow::Result<&'a Inner> {
    let row = number.parse::<usize>().ok().and_then(|k| k.checked_sub(1));
    row.and_then(|row| inner.get(row)).with_context(|| {
        format!(
            "there is no inner surface '{number}': the source has {}, counted from 1 (drape inspect --hidden)",
            inner.len()
        )
    })
}

/// The vertices all of whose faces have the name: those it shares with other parts belong to the others.
fn of_faces(name: &str, pair: &Pair) -> Option<VertexData<bool>> {
    let contents = pair.file.contents();
    let mesh = &pair.source.mesh;
    let lists = [&contents.groups, &contents.objects, &contents.materials];
    let found: Vec<_> = lists
        .into_iter()
        .flatten()
        .filter(|named| named.name == name)
        .collect();
    if found.is_empty() {
        return None;
    }
    let mut is_in = FaceData::new(mesh.n_faces(), false);
    for row in found.iter().flat_map(|f| &f.faces).cloned().flatten() {
        if row < mesh.n_faces() {
            is_in[FaceId::new(row)] = true;
        }
    }
    let mut inside = VertexData::new(mesh.n_vertices(), false);
    let mut outside = VertexData::new(mesh.n_vertices(), false);
    for f in mesh.faces() {
        for &v in mesh.face_vertices(f) {
            if is_in[f] {
                inside[v] = true;
            } else {
                outside[v] = true;
            }
        }
    }
    let both = inside.iter().zip(outside.iter());
    Some(both.map(|(&inside, &outside)| inside && !outside).collect())
}

/// The values of a PLY vertex property; of rows that are one vertex the first speaks.
pub(super) fn property(name: &str, pair: &Pair) -> anyhow::Result<Vec<f64>> {
    let values = pair.file.vertex_scalars(name).with_context(|| {
        format!("the source has no scalar vertex property '{name}' (PLY files have)")
    })?;
    Ok(pair.source.weld.gather(&values))
}

/// A vertex by its row in the file.
pub(super) fn vertex(word: &str, source: &Source) -> anyhow::Result<VertexId> {
    let row: usize = word
        .parse()
        .with_context(|| format!("'{word}' is no vertex number"))?;
    source.vertex_at(row).with_context(|| {
        format!(
            "vertex {row} does not exist: the source has {}, counted from 0",
            source.n_file_vertices()
        )
    })
}

fn names(pair: &Pair) -> String {
    let contents = pair.file.contents();
    let lists = [
        ("groups", &contents.groups),
        ("objects", &contents.objects),
        ("materials", &contents.materials),
    ];
    let full = lists.iter().filter(|(_, list)| !list.is_empty());
    let texts: Vec<String> = full
        .map(|(kind, list)| {
            let names: Vec<&str> = list.iter().take(12).map(|n| n.name.as_str()).collect();
            format!("the {kind} {}", names.join(", "))
        })
        .collect();
    if texts.is_empty() {
        "no names in the source".to_owned()
    } else {
        texts.join("; ")
    }
}
