//! What a map of a surface does to directions near each vertex.

use std::collections::HashMap;

use nalgebra::Matrix3;
use rayon::prelude::*;

use crate::io::unit;
use crate::triangulation::fan;
use crate::{Point3, PolygonSoup, Vector3};

/// Radius around a vertex in which triangles count, as a share of the root of the whole area at rest. Displacements are longer
/// than triangles: where a closed mouth opens, slivers between the lips stretch tenfold, and what the lips do must not
/// follow these.
const REACH: f64 = 0.04;

/// A triangle: its centre at rest, its map, and its area at rest, doubled.
struct Piece {
    centre: Point3,
    map: Matrix3<f64>,
    area: f64,
    has_moved: bool,
}

/// The gradient at each vertex of the map from the positions of `rest` to `moved`; none where nothing around it moved.
///
/// `J = Σ w_f |A_f| F_f / Σ w_f |A_f|` over the triangles at the vertex (w = 1) and those within 0.04 r of it
/// (`w = (1 − d²/r²)²`, d the distance to the centre of the triangles in one cell of a grid), areas at rest. `F_f` takes two edges of the triangle at rest and
/// their normal of length `√(2 |A_f|)` to those of the moved one (the fourth corner of Sumner and Popović 2004, Eq. 1),
/// so that J is exact where the map turns, scales and shifts. Vertices that end at one place share theirs: the copies
/// of a vertex that is split along a seam. A vertex without a triangle near it has the mean of all.
///
/// # Panics
/// If there is not one position per vertex of `rest`, or a face names a vertex that is not there.
pub fn map_gradients(rest: &PolygonSoup, moved: &[Point3]) -> Vec<Option<Matrix3<f64>>> {
    let place_of = places(moved);
    let mut at_vertex = vec![Sum::default(); moved.len()];
    let mut total = Sum::default();
    let mut pieces = Vec::new();
    for corners in rest.faces.iter().flat_map(|face| fan(face)) {
        let Some(piece) = piece(&rest.positions, moved, corners) else {
            continue;
        };
        total.add(&piece, 1.0);
        for v in corners {
            at_vertex[place_of[v as usize]].add(&piece, 1.0);
        }
        pieces.push(piece);
    }
    let near = Near::new(&pieces, REACH * (0.5 * total.weight).sqrt());
    let gradient_at = |row: usize| {
        let mut sum = at_vertex[row];
        near.add_to(&mut sum, &rest.positions[row]);
        match sum.weight > 0.0 {
            true => sum.has_moved.then(|| sum.mean()),
            false => {
                (rest.positions[row] != moved[row] && total.weight > 0.0).then(|| total.mean())
            }
        }
    };
    let at_place: Vec<Option<Matrix3<f64>>> = (0..moved.len())
        .into_par_iter()
        .with_min_len(64)
        .map(|row| (place_of[row] == row).then(|| gradient_at(row)).flatten())
        .collect();
    place_of.iter().map(|&place| at_place[place]).collect()
}

/// A weighted sum of maps.
#[derive(Clone, Copy, Default)]
struct Sum {
    map: Matrix3<f64>,
    weight: f64,
    has_moved: bool,
}

impl Sum {
    fn add(&mut self, piece: &Piece, weight: f64) {
        self.map += piece.map * (weight * piece.area);
        self.weight += weight * piece.area;
        self.has_moved |= piece.has_moved;
    }

    fn add_all(&mut self, other: &Self, weight: f64) {
        self.map += other.map * weight;
        self.weight += weight * other.weight;
        self.has_moved |= other.has_moved;
    }

    fn mean(&self) -> Matrix3<f64> {
        self.map / self.weight
    }
}

/// Triangles summed up in the cells of a grid, so that however dense a mesh is, few sums are near a vertex.
struct Near {
    cells: HashMap<[i64; 3], Cell>,
    radius: f64,
}

/// The triangles of a cell and their centre, weighted by area.
#[derive(Clone, Copy, Default)]
struct Cell {
    sum: Sum,
    centre: Vector3,
}

/// Cells along the radius.
const FINENESS: i64 = 2;

impl Near {
    fn new(pieces: &[Piece], radius: f64) -> Self {
        let mut near = Self {
            cells: HashMap::new(),
            radius,
        };
        for piece in pieces {
            let at = near.cell_at(&piece.centre);
            let cell = near.cells.entry(at).or_default();
            cell.sum.add(piece, 1.0);
            cell.centre += piece.centre.coords * piece.area;
        }
        for cell in near.cells.values_mut() {
            cell.centre /= cell.sum.weight;
        }
        near
    }

    fn cell_at(&self, p: &Point3) -> [i64; 3] {
        [p.x, p.y, p.z].map(|c| (c / self.radius * FINENESS as f64).floor() as i64)
    }

    /// Adds all that is within the radius of `p`.
    fn add_to(&self, sum: &mut Sum, p: &Point3) {
        let [x, y, z] = self.cell_at(p);
        let around = |c: i64| (-FINENESS..=FINENESS).map(move |step| c.saturating_add(step));
        for at in
            around(x).flat_map(|x| around(y).flat_map(move |y| around(z).map(move |z| [x, y, z])))
        {
            let Some(cell) = self.cells.get(&at) else {
                continue;
            };
            let t = (cell.centre - p.coords).norm_squared() / (self.radius * self.radius);
            if t < 1.0 {
                sum.add_all(&cell.sum, (1.0 - t).powi(2));
            }
        }
    }
}

/// For each vertex the first of those that are where it is.
fn places(moved: &[Point3]) -> Vec<usize> {
    let mut first_at = HashMap::with_capacity(moved.len());
    let key = |p: &Point3| [p.x, p.y, p.z].map(|c| (c + 0.0).to_bits());
    moved
        .iter()
        .enumerate()
        .map(|(row, p)| *first_at.entry(key(p)).or_insert(row))
        .collect()
}

fn piece(rest: &[Point3], moved: &[Point3], [a, b, c]: [u32; 3]) -> Option<Piece> {
    let frame = |x: &[Point3]| {
        let [a, b, c] = [a, b, c].map(|v| x[v as usize]);
        let area = (b - a).cross(&(c - a));
        let normal = unit(area)? * area.norm().sqrt();
        Some((Matrix3::from_columns(&[b - a, c - a, normal]), area.norm()))
    };
    let ((from, area), (to, _)) = (frame(rest)?, frame(moved)?);
    let [p, q, r] = [a, b, c].map(|v| rest[v as usize].coords);
    let map = to * from.try_inverse()?;
    map.iter().all(|c| c.is_finite()).then(|| Piece {
        centre: Point3::from((p + q + r) / 3.0),
        map,
        area,
        has_moved: [a, b, c]
            .map(|v| v as usize)
            .iter()
            .any(|&v| rest[v] != moved[v]),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;

    #[test]
    fn a_similarity_is_its_own_gradient_at_every_vertex() {
        let similar = Rotation3::from_euler_angles(0.3, -1.1, 2.0).into_inner() * 92.0;
        for soup in [crate::shapes::icosphere(1), crate::shapes::quad_sphere(3)] {
            let moved = soup.positions.iter();
            let moved: Vec<Point3> = moved
                .map(|p| Point3::from(similar * p.coords) + Vector3::new(5.0, -1.0, 3.0))
                .collect();
            for map in map_gradients(&soup, &moved) {
                assert!((map.unwrap() - similar).norm() < 1e-10);
            }
        }
    }

    #[test]
    fn where_nothing_moved_there_is_no_map_and_loose_vertices_follow_the_whole() {
        let mut soup = crate::shapes::open_grid(3, 1);
        soup.faces = soup
            .faces
            .iter()
            .flat_map(|f| [vec![f[0], f[1], f[2]], vec![f[0], f[2], f[3]]])
            .collect();
        soup.positions.push(Point3::new(9.0, 9.0, 9.0));
        let mut moved = soup.positions.clone();
        assert!(map_gradients(&soup, &moved).iter().all(Option::is_none));
        moved[0].x -= 1.0;
        moved[8].x -= 1.0;
        let maps = map_gradients(&soup, &moved);
        assert!(maps[0].is_some() && maps[3].is_none() && maps[8].is_some());
    }

    #[test]
    fn copies_of_a_vertex_share_their_map() {
        let p = |x: f64, y: f64| Point3::new(x, y, 0.0);
        let soup = PolygonSoup {
            positions: vec![
                p(0., 0.),
                p(1., 0.),
                p(1., 1.),
                p(0., 0.),
                p(1., 1.),
                p(0., 1.),
            ],
            faces: vec![vec![0, 1, 2], vec![3, 4, 5]],
        };
        let mut moved = soup.positions.clone();
        moved[1].z = 1.0;
        moved[5].z = -2.0;
        let maps = map_gradients(&soup, &moved);
        assert_eq!((maps[0], maps[2]), (maps[3], maps[4]));
        assert_ne!(maps[1], maps[5]);
    }

    #[test]
    fn a_sliver_that_stretches_does_not_lead_its_neighbours() {
        // A fine square sheet whose middle row of faces is a hundredth as high as the others, and opens to be as high.
        let mut soup = crate::shapes::open_grid(40, 41);
        let height = |row: f64| if row <= 20.0 { row } else { row - 0.99 };
        let moved: Vec<Point3> = soup.positions.clone();
        for p in &mut soup.positions {
            p.y = height(p.y);
        }
        soup.faces = soup
            .faces
            .iter()
            .flat_map(|f| [vec![f[0], f[1], f[2]], vec![f[0], f[2], f[3]]])
            .collect();
        for map in map_gradients(&soup, &moved) {
            let stretch = map.map_or(1.0, |m| (m * Vector3::y()).norm());
            assert!((0.99..2.5).contains(&stretch), "{stretch}");
        }
    }
}
