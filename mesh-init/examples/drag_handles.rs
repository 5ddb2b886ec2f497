//! Handles on a mesh are dragged, and the mesh follows, frame by frame.
#![allow(clippy::print_stdout, reason = "an example tells what it found")]

use std::error::Error;
use std::time::Instant;

use mesh_init::mesh_core::{
    shapes, Landmark, Point3, Positions, Triangulation, UnitFrame, Vector3, VertexId,
};
use mesh_init::{InitConfig, InteractiveInit};

/// A mesh of more vertices is deformed as one of so many, which carries it.
const MAX_VERTICES: usize = 3000;
const N_FRAMES: usize = 30;

fn main() -> Result<(), Box<dyn Error>> {
    // A long, rounded body of 15 002 vertices.
    let (mesh, ball) = shapes::quad_sphere(50).into_halfedge()?;
    let rest = ball.map(|p| Point3::new(3.0 * p.x, p.y, p.z));
    let triangulation = Triangulation::new(&mesh, &rest);
    let frame = UnitFrame::principal(rest.as_slice());
    let start = Instant::now();
    let mut body =
        InteractiveInit::new(&triangulation, &rest, MAX_VERTICES, InitConfig::standard())?;
    println!("{} vertices, ready in {:.0?}", rest.len(), start.elapsed());

    // Both ends and four places in between: the first is dragged, the others stay.
    let [x, y, z] = [3.0 * Vector3::x(), Vector3::y(), Vector3::z()];
    let mut handles = [x, -x, y, -y, z, -z].map(|place| {
        let v = nearest(&rest, &place.into());
        Landmark::new(v, rest[v])
    });
    let start = Instant::now();
    let mut shape = body.solve(&handles, frame)?.positions;
    for _ in 0..N_FRAMES {
        handles[0].target += Vector3::new(-0.005, 0.01, 0.02);
        shape = body.solve(&handles, frame)?.positions;
    }
    println!("{:.1?} a frame", start.elapsed() / N_FRAMES as u32);

    let miss = |h: &Landmark| (h.source.position(&shape) - h.target).norm();
    let most = handles.iter().map(miss).fold(0.0, f64::max);
    println!("a handle misses its place by {most:.1e} at most, of a body 6 long");
    assert!(most < 0.05, "{most}");
    Ok(())
}

fn nearest(x: &Positions, place: &Point3) -> VertexId {
    let distance = |v: &VertexId| (x[*v] - place).norm();
    x.ids()
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
        .expect("the body has vertices")
}
