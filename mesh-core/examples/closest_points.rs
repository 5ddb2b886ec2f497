//! The closest points of a million queries on a mesh: `closest_points [FILE]`.
//!
//! Without a file, the mesh is a ball of 81 920 triangles, where the right distances are known.
#![allow(clippy::print_stdout, reason = "an example tells what it found")]

use std::error::Error;
use std::time::Instant;

use mesh_core::sampling::SeededRng;
use mesh_core::{io, shapes, Point3, TargetSurface, TriangleSoup};

const N_QUERIES: usize = 1_000_000;

fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args().nth(1);
    let soup = match &file {
        Some(path) => io::read_soup(path)?,
        None => shapes::icosphere(6),
    };
    let start = Instant::now();
    let surface = TriangleSoup::new(soup)?;
    println!(
        "hierarchy of {} triangles: {:.2?}",
        surface.bvh().len(),
        start.elapsed()
    );

    let queries = queries(&surface);
    let start = Instant::now();
    let closest = surface.closest_points(&queries);
    let mean = closest
        .iter()
        .map(|c| c.distance_squared.sqrt())
        .sum::<f64>()
        / N_QUERIES as f64;
    println!(
        "{N_QUERIES} queries: {:.2?}, mean distance {mean:.6}",
        start.elapsed()
    );

    if file.is_none() {
        // The ball's faces lie inside the unit sphere by at most 1 − cos of half their width, less than 1e-4.
        let off = queries.iter().zip(&closest).map(|(query, closest)| {
            ((query.coords.norm() - 1.0).abs() - closest.distance_squared.sqrt()).abs()
        });
        let most = off.fold(0.0, f64::max);
        println!("farthest from the distance to the true sphere: {most:.1e}");
        assert!(most < 1e-3, "{most}");
    }
    Ok(())
}

/// Random points of the surface, each moved by up to a tenth of the longest side along every axis.
fn queries(surface: &TriangleSoup) -> Vec<Point3> {
    let mut rng = SeededRng::new(0);
    let reach = 0.1 * surface.bounds().longest_side();
    let samples = surface.sample(N_QUERIES, &mut rng);
    let mut moved = |p: Point3| p.map(|c| c + rng.uniform_in(-reach..reach));
    samples.into_iter().map(|s| moved(s.point)).collect()
}
