//! Solids built in code, for tests, examples and benches. Faces turn outwards.

use std::collections::HashMap;

use crate::{Point3, PolygonSoup};

fn soup(positions: Vec<Point3>, faces: Vec<Vec<u32>>) -> PolygonSoup {
    PolygonSoup { positions, faces }
}

/// A regular tetrahedron with corners on the unit sphere.
pub fn tetrahedron() -> PolygonSoup {
    let s = 1.0 / 3f64.sqrt();
    let corners = [[s, s, s], [s, -s, -s], [-s, s, -s], [-s, -s, s]];
    let faces = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];
    soup(
        corners.map(Point3::from).to_vec(),
        faces.map(|f| f.to_vec()).to_vec(),
    )
}

/// An icosahedron, each triangle split in four `n_splits` times, on the unit sphere: 20 · 4ⁿ triangles.
pub fn icosphere(n_splits: usize) -> PolygonSoup {
    let g = (1.0 + 5f64.sqrt()) / 2.0;
    let mut positions: Vec<Point3> = [
        [-1., g, 0.],
        [1., g, 0.],
        [-1., -g, 0.],
        [1., -g, 0.],
        [0., -1., g],
        [0., 1., g],
        [0., -1., -g],
        [0., 1., -g],
        [g, 0., -1.],
        [g, 0., 1.],
        [-g, 0., -1.],
        [-g, 0., 1.],
    ]
    .map(on_unit_sphere)
    .to_vec();
    let mut triangles: Vec<[u32; 3]> = vec![
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ];
    for _ in 0..n_splits {
        triangles = split_in_four(&mut positions, &triangles);
    }
    soup(positions, triangles.iter().map(|t| t.to_vec()).collect())
}

fn on_unit_sphere(p: [f64; 3]) -> Point3 {
    let p = Point3::from(p);
    Point3::from(p.coords / p.coords.norm())
}

fn split_in_four(positions: &mut Vec<Point3>, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut middle_of: HashMap<(u32, u32), u32> = HashMap::new();
    let mut middle = |a: u32, b: u32| {
        *middle_of.entry((a.min(b), a.max(b))).or_insert_with(|| {
            let sum = positions[a as usize].coords + positions[b as usize].coords;
            positions.push(on_unit_sphere(sum.into()));
            positions.len() as u32 - 1
        })
    };
    let mut split = Vec::with_capacity(4 * triangles.len());
    for &[a, b, c] in triangles {
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        split.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    split
}

/// A cube of `n` × `n` quads a side, blown up to the unit sphere: 6 n² quads.
///
/// # Panics
/// If `n` is 0.
pub fn quad_sphere(n: usize) -> PolygonSoup {
    assert!(n > 0, "a side needs at least one quad");
    let mut row_of: HashMap<[i64; 3], u32> = HashMap::new();
    let mut positions = Vec::new();
    let mut faces = Vec::new();
    let m = n as i64;
    for axis in 0..3 {
        for side in [-m, m] {
            let mut row = |i: i64, j: i64| {
                let mut p = [0; 3];
                p[axis] = side;
                p[(axis + 1) % 3] = 2 * i - m;
                p[(axis + 2) % 3] = 2 * j - m;
                *row_of.entry(p).or_insert_with(|| {
                    positions.push(on_unit_sphere(p.map(|c| spread(c as f64 / m as f64))));
                    positions.len() as u32 - 1
                })
            };
            for i in 0..m {
                for j in 0..m {
                    let mut quad = vec![row(i, j), row(i + 1, j), row(i + 1, j + 1), row(i, j + 1)];
                    if side < 0 {
                        quad.reverse();
                    }
                    faces.push(quad);
                }
            }
        }
    }
    soup(positions, faces)
}

/// Makes the quads of a blown-up cube nearly equal in size.
fn spread(c: f64) -> f64 {
    (c * std::f64::consts::FRAC_PI_4).tan()
}

/// A flat open sheet of `nx` × `ny` unit quads in the plane z = 0, facing +z.
pub fn open_grid(nx: usize, ny: usize) -> PolygonSoup {
    let row = |i: usize, j: usize| (j * (nx + 1) + i) as u32;
    let positions = (0..=ny)
        .flat_map(|j| (0..=nx).map(move |i| Point3::new(i as f64, j as f64, 0.0)))
        .collect();
    let faces = (0..ny)
        .flat_map(|j| (0..nx).map(move |i| (i, j)))
        .map(|(i, j)| vec![row(i, j), row(i + 1, j), row(i + 1, j + 1), row(i, j + 1)])
        .collect();
    soup(positions, faces)
}

/// An open cone of `n` triangles: apex at height 1, base circle of radius 1 in the plane z = 0.
pub fn cone(n: usize) -> PolygonSoup {
    let base = (0..n).map(|k| {
        let angle = std::f64::consts::TAU * k as f64 / n as f64;
        Point3::new(angle.cos(), angle.sin(), 0.0)
    });
    let positions = std::iter::once(Point3::new(0.0, 0.0, 1.0))
        .chain(base)
        .collect();
    let faces = (0..n as u32)
        .map(|k| vec![0, 1 + k, 1 + (k + 1) % n as u32])
        .collect();
    soup(positions, faces)
}

/// A closed prism over a regular `n`-gon: two n-gons and `n` quads.
pub fn prism(n: usize) -> PolygonSoup {
    let ring = |z: f64| {
        (0..n).map(move |k| {
            let angle = std::f64::consts::TAU * k as f64 / n as f64;
            Point3::new(angle.cos(), angle.sin(), z)
        })
    };
    let m = n as u32;
    let mut faces = vec![(0..m).rev().collect(), (m..2 * m).collect::<Vec<_>>()];
    faces.extend((0..m).map(|k| vec![k, (k + 1) % m, m + (k + 1) % m, m + k]));
    soup(ring(0.0).chain(ring(1.0)).collect(), faces)
}
