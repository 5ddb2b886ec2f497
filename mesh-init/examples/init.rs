//! Initial deformation of a mesh from files:
//! `init SOURCE TARGET LANDMARKS.json OUT [paper|standard]`, with landmarks as
//! `{"source_vertices": [row, …], "target_points": [[x, y, z], …]}`.
#![allow(clippy::print_stdout, reason = "an example tells what it did")]

use std::error::Error;
use std::time::Instant;

use mesh_core::{io, Landmark, Point3, Triangulation, UnitFrame, VertexId};
use mesh_init::{initialize, InitConfig, InitInput};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [source, target, landmarks, out, rest @ ..] = arguments.as_slice() else {
        return Err("usage: init SOURCE TARGET LANDMARKS.json OUT [paper|standard]".into());
    };
    let config = match rest {
        [] => InitConfig::standard(),
        [name] if name == "standard" => InitConfig::standard(),
        [name] if name == "paper" => InitConfig::paper(),
        _ => return Err("a preset is paper or standard".into()),
    };

    let file = io::read_mesh(source)?;
    let (mesh, rest) = file.soup().clone().into_halfedge()?;
    let landmarks = read_landmarks(landmarks)?;
    let input = InitInput {
        triangulation: &Triangulation::new(&mesh, &rest),
        rest: &rest,
        landmarks: &landmarks,
        target_frame: UnitFrame::principal(&io::read_soup(target)?.positions),
    };
    let start = Instant::now();
    let initial = initialize(input, &config)?;
    println!(
        "{:.3} s, {} vertices on pieces without a landmark",
        start.elapsed().as_secs_f64(),
        initial.n_extrapolated
    );
    file.write(out, &initial.positions)?;
    Ok(())
}

fn read_landmarks(path: &str) -> Result<Vec<Landmark>, Box<dyn Error>> {
    let json: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(path)?)?;
    let (Some(rows), Some(points)) = (
        json["source_vertices"].as_array(),
        json["target_points"].as_array(),
    ) else {
        return Err(format!("{path}: source_vertices and target_points are needed").into());
    };
    let landmark = |(row, point): (&serde_json::Value, &serde_json::Value)| {
        let [x, y, z] = [0, 1, 2].map(|k| point[k].as_f64());
        let place = Point3::new(x?, y?, z?);
        Some(Landmark::new(
            VertexId::new(usize::try_from(row.as_u64()?).ok()?),
            place,
        ))
    };
    let pairs = rows.iter().zip(points);
    pairs
        .map(landmark)
        .collect::<Option<_>>()
        .ok_or_else(|| format!("{path}: not a row and a point each").into())
}
