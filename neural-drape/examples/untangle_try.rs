use std::sync::Arc;
use std::time::Instant;
use neural_drape::mesh_core::{io, Positions, Triangulation, UnitFrame};
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let weld = io::read_soup(&args[1]).unwrap().weld(0.0);
    let (mesh, rest) = weld.soup.clone().into_halfedge().unwrap();
    let t = Arc::new(Triangulation::new(&mesh, &rest));
    let out = io::read_soup(&args[2]).unwrap();
    let x: Positions = weld.gather(&out.positions).into_iter().collect();
    let began = Instant::now();
    let end = neural_drape::repair(&t, &rest, &x, &[]);
    let s = began.elapsed().as_secs_f64();
    println!("{} crossings {} -> {}, folds {} -> {}, skinny {} -> {}, {s:.2} s", args[2], end.before.crossings.len(), end.left.crossings.len(), end.before.folds.len(), end.left.folds.len(), end.before.skinny.len(), end.left.skinny.len());
    let moved: Vec<f64> = x.iter().zip(&end.positions).map(|(a, b)| (a - b).norm()).collect();
    let side = UnitFrame::principal(x.as_slice()).scale;
    let n = moved.iter().filter(|m| **m > 0.0).count();
    println!("  moved {n}, mean {:.5}, max {:.5}", moved.iter().sum::<f64>() / n.max(1) as f64 / side, moved.iter().fold(0.0f64, |a, b| a.max(*b)) / side);
    if let Some(path) = args.get(3) {
        let positions = weld.spread(end.positions.as_slice());
        let mut text = String::new();
        for p in positions { text += &format!("v {} {} {}\n", p.x, p.y, p.z); }
        for f in &out.faces { text += "f"; for v in f { text += &format!(" {}", v + 1); } text += "\n"; }
        std::fs::write(path, text).unwrap();
    }
}
