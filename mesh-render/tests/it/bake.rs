//! A painted creature, and its colours in the texture of the head that was draped over it: the paint is a function of places
//! on the source at rest, so that it is known what every texel should be.

use std::error::Error;
use std::fmt::Write as _;

use mesh_core::io::MeshFile;
use mesh_core::{Location, Point3, Positions, TriangleBvh, Vector3};
use mesh_creatures::{CreaturePair, Dial, Individual, PairConfig, Plan};
use mesh_draping::{landmarks, Preset, Seams, Source, Target, Transfer};
use mesh_render::bake::{Bake, Paint, Texture};

/// Texels along the side.
const SIZE: usize = 512;

#[test]
#[allow(
    clippy::print_stdout,
    reason = "the error of a colour is a figure to look at"
)]
fn a_painted_creature_has_its_colours_in_the_texture() -> Result<(), Box<dyn Error>> {
    let dial = Dial {
        angle: 20.0,
        ratio: 1.3,
    };
    let config = PairConfig {
        n_landmarks: 12,
        ..PairConfig::standard()
    };
    let (template, other) = (
        Individual::template(Plan::Head),
        Individual::drawn(Plan::Head, 1, dial),
    );
    let pair = CreaturePair::new(&template, &other, &config);
    let file = MeshFile::from_bytes("source.obj", pair.source.to_obj().into_bytes())?;
    let source = Source::of_file(file, Seams::EXACT)?;
    let truth = Positions::from(source.gather(&pair.truth));
    let painted = painted(&source, &truth, &pair).into_bytes();
    let painted = MeshFile::from_bytes("target.ply", painted)?;
    let paint = Paint::of_file(&painted)?;
    let target = Target::of_file(painted)?;
    let marks = landmarks::parse(&pair.landmarks_json(), None, &source, target.vertices())?;
    let outcome = Transfer::new(&source, &target, &marks, Preset::quick()).run()?;

    let right = right(&source)?;
    // What is left at the true places is rounding and the target's triangles; at those of a short drape, its drift.
    let shapes = [("truth", &truth, 0.004), ("draped", &outcome.draped, 0.015)];
    for (name, shape, most) in shapes {
        let (texture, _) = Bake::new(&source, shape, &target, SIZE)?.colors(&paint)?;
        let error = error(&texture, &right);
        println!("{name}: mean error of a colour {error:.4} of 1");
        assert!(error < most, "{name}: {error}");
    }
    Ok(())
}

/// The target as a PLY file with the colour of the place at rest that each of its vertices belongs to.
fn painted(source: &Source, truth: &Positions, pair: &CreaturePair) -> String {
    let triangulation = source.triangulation();
    let surface = TriangleBvh::new(triangulation.corners(truth).collect());
    let hits = surface.closest_points(&pair.target.positions);
    let colors = pair.target.positions.iter().zip(hits).map(|(p, hit)| {
        let Location::Triangle { index, barycentric } = hit.location else {
            unreachable!("a mesh has triangles");
        };
        let corners = triangulation.triangles()[index as usize];
        let weighted = corners.iter().zip(barycentric);
        let rest = weighted.map(|(&v, weight)| source.rest()[v].coords * weight);
        (*p, paint_at(&Point3::from(rest.sum::<Vector3>()), source))
    });
    colored(colors, &pair.target.faces)
}

/// Red, green and blue of a place of the source at rest, each from 0 to 1: stripes along three directions.
fn paint_at(rest: &Point3, source: &Source) -> [f64; 3] {
    let bounds = source.bounds();
    let at = (rest - bounds.min) / bounds.longest_side();
    let stripe = |x: f64| 0.5 + 0.45 * (14.0 * x).sin();
    [
        stripe(at.x + 0.4 * at.y),
        stripe(at.y),
        stripe(at.z - 0.3 * at.x),
    ]
}

/// A PLY file with a colour at each vertex.
fn colored(vertices: impl Iterator<Item = (Point3, [f64; 3])>, faces: &[Vec<u32>]) -> String {
    let (mut rows, mut n) = (String::new(), 0);
    for (p, [r, g, b]) in vertices {
        let _ = writeln!(rows, "{} {} {} {r} {g} {b}", p.x, p.y, p.z);
        n += 1;
    }
    for face in faces {
        let corners = face.iter().map(|v| format!(" {v}"));
        let _ = writeln!(rows, "{}{}", face.len(), corners.collect::<String>());
    }
    let scalars = ["x", "y", "z", "red", "green", "blue"];
    let properties = scalars.map(|name| format!("property double {name}\n"));
    format!(
        "ply\nformat ascii 1.0\nelement vertex {n}\n{}element face {}\n\
         property list uchar int vertex_indices\nend_header\n{rows}",
        properties.concat(),
        faces.len()
    )
}

/// What every texel should be: the paint at its place, found by baking the places of the source over itself.
fn right(source: &Source) -> Result<Texture<3>, Box<dyn Error>> {
    let bounds = source.bounds();
    let places = source.rest().iter().map(|p| {
        let at = (p - bounds.min) / bounds.longest_side();
        (*p, [at.x, at.y, at.z])
    });
    let faces = source.mesh().faces().map(|f| {
        let corners = source.mesh().face_vertices(f).iter();
        corners.map(|v| v.index() as u32).collect()
    });
    let file = colored(places, &faces.collect::<Vec<Vec<u32>>>());
    let file = MeshFile::from_bytes("places.ply", file.into_bytes())?;
    let paint = Paint::of_file(&file)?;
    let bake = Bake::new(source, source.rest(), &Target::of_file(file)?, SIZE)?;
    let paint_of = |[x, y, z]: [f32; 3]| {
        let at = Vector3::new(x.into(), y.into(), z.into());
        let rest = bounds.min + at * bounds.longest_side();
        paint_at(&rest, source).map(|c| c as f32)
    };
    let (texture, _) = bake.colors(&paint)?;
    Ok(texture.map(paint_of))
}

/// The mean difference of a sample.
fn error(found: &Texture<3>, right: &Texture<3>) -> f64 {
    let pairs = found
        .texels()
        .as_flattened()
        .iter()
        .zip(right.texels().as_flattened());
    let total: f64 = pairs.map(|(a, b)| f64::from((a - b).abs())).sum();
    total / found.texels().as_flattened().len() as f64
}
