//! Landmarks as a file that the command line reads.

use anyhow::Result;
use mesh_core::FaceId;
use serde_json::{json, Value};

use crate::session::{Mark, MarkKind, SourcePlace};
use crate::Scene;

/// The landmarks that are complete, as JSON.
pub(crate) fn write(scene: &Scene, marks: &[Mark]) -> Result<String> {
    let complete = marks.iter().filter_map(|mark| {
        let (source, target) = (mark.source?, mark.target?);
        let mut entry = json!({
            "source": source_place(scene, &source),
            "target": { "point": target },
            "kind": match mark.kind { MarkKind::Soft => "soft", MarkKind::Rigid => "rigid" },
        });
        if !mark.name.is_empty() {
            entry["name"] = Value::from(mark.name.clone());
        }
        Some(entry)
    });
    let file = json!({ "landmarks": complete.collect::<Vec<_>>() });
    Ok(serde_json::to_string_pretty(&file)? + "\n")
}

/// A vertex where the place is one, else a face and a weight for each of its corners.
fn source_place(scene: &Scene, place: &SourcePlace) -> Value {
    let source = &scene.source;
    let corner = place.weights.iter().position(|&w| w == 1.0);
    if let Some(row) = corner.and_then(|corner| source.file_row(place.vertices[corner])) {
        return json!({ "vertex": row });
    }
    let triangle = place.mesh_point().vertices;
    let row = source
        .triangulation
        .triangles()
        .iter()
        .position(|t| *t == triangle);
    let Some(face) = row.map(|row| source.triangulation.parent(row)) else {
        let p = place.mesh_point().position(&source.rest);
        return json!({ "point": [p.x, p.y, p.z] });
    };
    json!({ "face": face.index(), "barycentric": corner_weights(scene, face, place) })
}

fn corner_weights(scene: &Scene, face: FaceId, place: &SourcePlace) -> Vec<f64> {
    let of_corner = |v: u32| {
        let shares = place.vertices.iter().zip(place.weights);
        shares
            .filter(|(&w, _)| w == v)
            .map(|(_, weight)| weight)
            .sum()
    };
    let corners = scene.source.mesh.face_vertices(face).iter();
    corners.map(|v| of_corner(v.index() as u32)).collect()
}
