//! Small pairs built in code, and short settings.

use mesh_draping::mesh_core::{shapes, Landmark, Point3, PolygonSoup, Positions, VertexId};
use mesh_draping::{Pair, Preset, Seams, Source, Target};

/// Settings with this many iterations in each of two stages.
pub(crate) fn short(n_iterations: usize) -> Preset {
    let mut preset = Preset::standard();
    for stage in &mut preset.drape.stages {
        stage.n_iterations = n_iterations;
    }
    preset
}

/// A longer, larger and moved ball of triangles.
pub(crate) fn ellipsoid() -> PolygonSoup {
    let mut soup = shapes::icosphere(3);
    soup.positions.iter_mut().for_each(|p| *p = stretched(p));
    soup
}

fn stretched(p: &Point3) -> Point3 {
    Point3::new(4.0 * p.x + 10.0, 3.0 * p.y, 2.5 * p.z - 5.0)
}

/// A ball of quads with `n` along each side, six places of which are marked on an ellipsoid.
pub(crate) fn ball_and_ellipsoid(n: usize) -> Pair {
    let source = Source::of_soup(shapes::quad_sphere(n), Seams::EXACT).expect("a ball is a mesh");
    let landmarks = landmarks(source.rest());
    Pair {
        target: Target::of_soup(ellipsoid()).expect("an ellipsoid is a surface"),
        source,
        landmarks,
    }
}

/// The vertices that reach farthest each way, and where they belong.
fn landmarks(rest: &Positions) -> Vec<Landmark> {
    let farthest = |axis: usize, sign: f64| {
        let along = |v: &VertexId| sign * rest[*v][axis];
        let v = rest.ids().max_by(|a, b| along(a).total_cmp(&along(b)));
        let v = v.expect("a ball has vertices");
        Landmark::new(v, stretched(&rest[v]))
    };
    [0, 1, 2]
        .into_iter()
        .flat_map(|axis| [farthest(axis, 1.0), farthest(axis, -1.0)])
        .collect()
}

/// Whether both have the same bits.
pub(crate) fn same_bits(a: &Positions, b: &Positions) -> bool {
    let bits = |p: &Point3| [p.x, p.y, p.z].map(f64::to_bits);
    a.len() == b.len() && a.iter().zip(b.iter()).all(|(p, q)| bits(p) == bits(q))
}
