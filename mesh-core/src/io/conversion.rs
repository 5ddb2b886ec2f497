//! What a file loses when it is written in another format.

use super::contents::Contents;
use super::document::{Codec, Geometry};
use super::format::Format;
use crate::PolygonSoup;

/// What a new file of `to` does not keep of a file of `from`, in one line; none if it keeps all.
pub(super) fn lost(
    from: Format,
    to: Format,
    soup: &PolygonSoup,
    contents: &Contents,
) -> Option<String> {
    let (from, to) = (from.codec(), to.codec());
    let lost = lost_elements(from, to, soup, contents);
    let mut changed = Vec::new();
    let n_polygons = soup.faces.iter().filter(|face| face.len() > 3).count();
    if n_polygons > 0 && to.geometry.is_triangles() {
        let verb = if n_polygons == 1 { "becomes" } else { "become" };
        changed.push(format!(
            "{} {verb} triangles",
            counted(n_polygons, "polygons")
        ));
    }
    if to.geometry == Geometry::SeparateTriangles {
        changed.push("each triangle gets corners of its own".to_owned());
    }
    if to.geometry == Geometry::Triangles && contents.n_uvs > 0 && keeps_uvs(from, to) {
        changed.push("vertices are split where texture coordinates differ".to_owned());
    }
    if to.geometry.is_triangles() {
        changed.push("coordinates are rounded to single precision".to_owned());
    }
    if lost.is_empty() && changed.is_empty() {
        return None;
    }
    let kept = (!lost.is_empty()).then(|| format!("these are not kept: {}", lost.join(", ")));
    let told: Vec<String> = kept.into_iter().chain(changed).collect();
    let (from, to) = (from.name, to.name);
    Some(format!("from {from} to {to}, {}", told.join("; ")))
}

fn lost_elements(from: &Codec, to: &Codec, soup: &PolygonSoup, contents: &Contents) -> Vec<String> {
    let (n_uvs, n_faces) = (contents.n_uvs, soup.faces.len());
    let counts = [
        (
            if to.geometry == Geometry::Points {
                n_faces
            } else {
                0
            },
            "faces",
        ),
        (
            if keeps_uvs(from, to) { 0 } else { n_uvs },
            "texture coordinates",
        ),
        (contents.n_normals, "normals"),
        (contents.n_colors, "vertex colours"),
        (contents.n_lines_and_points, "line and point elements"),
        (contents.n_morph_targets, "morph targets"),
        (contents.n_skins, "skins"),
        (contents.n_animations, "animations"),
        (contents.objects.len(), "object names"),
        (contents.groups.len(), "groups"),
        (contents.materials.len(), "materials"),
        (contents.n_smoothing_groups, "smoothing groups"),
        (contents.n_comments, "comments"),
    ];
    let lost = counts.iter().filter(|(n, _)| *n > 0);
    lost.map(|&(n, what)| counted(n, what)).collect()
}

/// `2 groups`, `1 group`.
fn counted(n: usize, plural: &str) -> String {
    match n {
        1 => format!("1 {}", plural.trim_end_matches('s')),
        _ => format!("{n} {plural}"),
    }
}

/// Whether texture coordinates go from one format to the other.
fn keeps_uvs(from: &Codec, to: &Codec) -> bool {
    from.has_uvs && to.has_uvs
}
