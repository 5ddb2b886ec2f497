//! Parts by name: groups, objects, materials, PLY properties, lists of vertices.

use std::path::Path;
use std::sync::OnceLock;

use mesh_core::io::Contents;
use mesh_core::{FaceData, FaceId, HalfedgeMesh, VertexData, VertexId};

use super::error::PartProblem;
use super::vertex_list::read_vertices;
use super::{HiddenSurfaces, InnerSurface};
use crate::Pair;

/// What selects the vertices of inner surfaces: all of them, or with `:K` the K-th.
const HIDDEN: &str = "hidden";
/// More names than this of a kind are not listed.
const MAX_LISTED: usize = 12;

/// The vertices of a part.
pub(super) fn find(
    name: &str,
    pair: &Pair,
    hidden: &OnceLock<HiddenSurfaces>,
) -> Result<VertexData<bool>, PartProblem> {
    let source = &pair.source;
    let n = source.rest().len();
    let inner = || &hidden.get_or_init(|| HiddenSurfaces::of(pair)).inner;
    let contents = source.file().map(|file| file.contents());
    let part = if name == HIDDEN {
        all(n, inner().iter().flat_map(|i| &i.vertices))
    } else if let Some(number) = name.strip_prefix("hidden:") {
        all(n, &nth(number, inner())?.vertices)
    } else if let Some(name) = name.strip_prefix("property:") {
        property(name, pair)?.into_iter().map(|x| x > 0.5).collect()
    } else if let Some(vertices) = source.part(name) {
        all(n, vertices)
    } else if let Some(part) = contents.and_then(|c| of_faces(name, c, source.mesh())) {
        part
    } else if Path::new(name).is_file() {
        read_vertices(Path::new(name), source)?
    } else {
        return Err(PartProblem::Unknown {
            known: contents.map_or_else(|| NO_NAMES.to_owned(), known_names),
        });
    };
    if part.iter().any(|&is_in| is_in) {
        Ok(part)
    } else {
        Err(PartProblem::Empty)
    }
}

fn all<'a>(n: usize, vertices: impl IntoIterator<Item = &'a VertexId>) -> VertexData<bool> {
    let mut part = VertexData::new(n, false);
    vertices.into_iter().for_each(|&v| part[v] = true);
    part
}

/// An inner surface by its number, counted from 1.
fn nth<'a>(number: &str, inner: &'a [InnerSurface]) -> Result<&'a InnerSurface, PartProblem> {
    let row = number.parse::<usize>().ok().and_then(|k| k.checked_sub(1));
    row.and_then(|row| inner.get(row))
        .ok_or_else(|| PartProblem::NoInnerSurface {
            number: number.to_owned(),
            n: inner.len(),
        })
}

/// The vertices all of whose faces have the name: those it shares with other parts belong to the others.
fn of_faces(name: &str, contents: &Contents, mesh: &HalfedgeMesh) -> Option<VertexData<bool>> {
    let lists = [&contents.groups, &contents.objects, &contents.materials];
    let named = lists.into_iter().flatten().filter(|n| n.name == name);
    let found: Vec<_> = named.collect();
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
pub(super) fn property(name: &str, pair: &Pair) -> Result<Vec<f64>, PartProblem> {
    let file = pair.source.file();
    let values = file.and_then(|file| file.vertex_scalars(name));
    let values = values.ok_or_else(|| PartProblem::NoProperty {
        name: name.to_owned(),
    })?;
    Ok(pair.source.gather(&values))
}

const NO_NAMES: &str = "no names in the source";

fn known_names(contents: &Contents) -> String {
    let lists = [
        ("groups", &contents.groups),
        ("objects", &contents.objects),
        ("materials", &contents.materials),
    ];
    let full = lists.iter().filter(|(_, list)| !list.is_empty());
    let texts: Vec<String> = full
        .map(|(kind, list)| {
            let listed = list.iter().take(MAX_LISTED);
            let names: Vec<&str> = listed.map(|n| n.name.as_str()).collect();
            format!("the {kind} {}", names.join(", "))
        })
        .collect();
    if texts.is_empty() {
        NO_NAMES.to_owned()
    } else {
        texts.join("; ")
    }
}
