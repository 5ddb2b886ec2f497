//! temporary
use std::sync::Arc;
use mesh_core::{Triangulation};
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let read = |p: &str| mesh_core::io::read_soup(p).unwrap();
    let (source, rest) = read(&args[1]).into_halfedge().unwrap();
    let (_, x) = read(&args[2]).into_halfedge().unwrap();
    let t = Arc::new(Triangulation::new(&source, &rest));
    let began = std::time::Instant::now();
    let target = read(&args[3]);
    let target: Box<dyn mesh_core::TargetSurface> = if target.faces.is_empty() {
        Box::new(mesh_core::PointCloud::new(target.positions, None).unwrap())
    } else {
        Box::new(mesh_core::TriangleSoup::new(target).unwrap())
    };
    let r = neural_drape::repair(&t, &rest, &x, &[], Some(target.as_ref()));
    println!("{} -> {} crossings, folds {} -> {}, skinny {} -> {}, {:.2} s", r.before.crossings.len(), r.left.crossings.len(), r.before.folds.len(), r.left.folds.len(), r.before.skinny.len(), r.left.skinny.len(), began.elapsed().as_secs_f64());
    let mut out = String::new();
    for p in r.positions.iter() { out += &format!("v {} {} {}\n", p.x, p.y, p.z); }
    for line in std::fs::read_to_string(&args[2]).unwrap().lines().filter(|l| l.starts_with("f ")) { out += line; out.push('\n'); }
    std::fs::write(&args[4], out).unwrap();
}
