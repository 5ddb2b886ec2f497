//! Seconds from a file to a target that answers queries: `load_target FILE`. Processor time and memory are the
//! system's to tell: `/usr/bin/time -v`.
#![allow(clippy::print_stdout, reason = "an example tells what it did")]

use std::error::Error;
use std::time::Instant;

use mesh_core::{io, Point3, TargetSurface, TriangleBvh, TriangleSoup};

fn main() -> Result<(), Box<dyn Error>> {
    let Some(path) = std::env::args().nth(1) else {
        return Err("usage: load_target FILE".into());
    };
    let start = Instant::now();
    let soup = io::read_soup(&path)?;
    let read = start.elapsed();
    println!(
        "{} vertices, {} faces: read in {:.2} s",
        soup.positions.len(),
        soup.faces.len(),
        read.as_secs_f64()
    );
    let triangles = soup.faces.iter().filter(|f| f.len() == 3);
    let corners = triangles.map(|f| [0, 1, 2].map(|k| soup.positions[f[k] as usize]));
    let corners: Vec<[Point3; 3]> = corners.collect();
    let start = Instant::now();
    let bvh = TriangleBvh::new(corners);
    println!("box hierarchy in {:.2} s", start.elapsed().as_secs_f64());
    drop(bvh);

    let start = Instant::now();
    let target = TriangleSoup::new(soup)?;
    println!(
        "target with boundary and orientation in {:.2} s",
        start.elapsed().as_secs_f64()
    );
    let closest = target.closest_point(&Point3::new(2.0, 0.0, 0.0));
    println!("closest point to (2, 0, 0): {:.4?}", closest.point);
    Ok(())
}
