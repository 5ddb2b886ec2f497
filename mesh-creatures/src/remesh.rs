//! The surface of an individual in other triangles than its template's.

use mesh_core::measure::triangle_normal;
use mesh_core::sampling::SeededRng;
use mesh_core::{Point3, PolygonSoup, Proxy, Triangulation};

use crate::cage::Cage;
use crate::flips::make_delaunay;
use crate::template::smooth;

/// Splits of the control mesh's quads in the fine surface that vertices are taken from.
const FINE_SPLITS: usize = 2;

/// How far towards a random place of a random neighbouring triangle a vertex goes, between these parts of the way.
const JITTER: [f64; 2] = [0.25, 0.55];

/// The smooth surface of `cage` in about `n` vertices, closed, in random order.
///
/// The quads of the control mesh are split, cut into triangles and their vertices moved within the surface by a random
/// part of an edge, so that none is the template's; then edges collapse, the least harmful first, until `n` vertices are
/// left, and edges are flipped until opposite angles sum to at most 180° wherever that turns no triangle over.
pub(crate) fn remeshed(cage: &Cage, n: usize, rng: &mut SeededRng) -> PolygonSoup {
    let fine = jittered(&smooth(cage, FINE_SPLITS), rng);
    let (mesh, rest) = match fine.into_halfedge() {
        Ok(parts) => parts,
        Err(error) => unreachable!("a subdivided control mesh is sound: {error}"),
    };
    let proxy = Proxy::new(&Triangulation::new(&mesh, &rest), &rest, n, &[]);
    let PolygonSoup { positions, faces } = proxy.soup().clone();
    let mut triangles: Vec<[u32; 3]> = faces.iter().map(|f| [f[0], f[1], f[2]]).collect();
    make_delaunay(&positions, &mut triangles);
    shuffled(positions, triangles, rng)
}

/// The quads cut along random diagonals, and every vertex at a random place of a triangle around it.
fn jittered(quads: &PolygonSoup, rng: &mut SeededRng) -> PolygonSoup {
    let x = &quads.positions;
    let mut triangles: Vec<[u32; 3]> = Vec::with_capacity(2 * quads.faces.len());
    for f in &quads.faces {
        let k = rng.below(2);
        let at = |j: usize| f[(k + j) % 4];
        triangles.extend([[at(0), at(1), at(2)], [at(0), at(2), at(3)]]);
    }
    let mut around: Vec<Vec<usize>> = vec![Vec::new(); x.len()];
    for (t, corners) in triangles.iter().enumerate() {
        corners.iter().for_each(|&v| around[v as usize].push(t));
    }
    let mut moved = Vec::with_capacity(x.len());
    for (v, p) in x.iter().enumerate() {
        let corners = triangles[around[v][rng.below(around[v].len())]];
        let sum = corners
            .iter()
            .map(|&c| x[c as usize].coords)
            .sum::<mesh_core::Vector3>();
        let way = rng.uniform_in(JITTER[0]..JITTER[1]);
        moved.push(p + (Point3::from(sum / 3.0) - p) * way);
    }
    PolygonSoup {
        positions: moved,
        faces: triangles.iter().map(|t| t.to_vec()).collect(),
    }
}

fn shuffled(
    positions: Vec<Point3>,
    mut triangles: Vec<[u32; 3]>,
    rng: &mut SeededRng,
) -> PolygonSoup {
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    rng.shuffle(&mut order);
    rng.shuffle(&mut triangles);
    let mut places = positions.clone();
    for (p, &row) in positions.iter().zip(&order) {
        places[row as usize] = *p;
    }
    let renamed = triangles
        .iter()
        .map(|t| t.iter().map(|&v| order[v as usize]).collect());
    PolygonSoup {
        positions: places,
        faces: renamed.collect(),
    }
}

/// The normal of a triangle of `soup`; none without area.
pub(crate) fn normal(positions: &[Point3], face: &[u32]) -> Option<mesh_core::Vector3> {
    triangle_normal([0, 1, 2].map(|k| positions[face[k] as usize]))
}
