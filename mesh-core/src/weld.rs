//! Seams closed: vertices at one place become one, and values go back to all of them.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hash, Hasher};

use crate::{Point3, PolygonSoup};

/// A soup without repeated vertices, and the way back to the one with.
#[derive(Clone, Debug, PartialEq)]
pub struct Weld {
    /// The welded soup: vertices in order of first appearance, faces as they were, some perhaps degenerate.
    pub soup: PolygonSoup,
    /// For each vertex of the soup that was welded, its row in `soup`.
    pub row_of: Vec<u32>,
}

impl Weld {
    /// One value per vertex before the weld, from one per vertex after.
    pub fn spread<T: Clone>(&self, values: &[T]) -> Vec<T> {
        self.row_of
            .iter()
            .map(|&row| values[row as usize].clone())
            .collect()
    }

    /// One value per vertex after the weld, from one per vertex before: that of the first vertex that became it.
    ///
    /// # Panics
    /// If there is not one value per vertex.
    pub fn gather<T: Clone>(&self, values: &[T]) -> Vec<T> {
        assert_eq!(values.len(), self.row_of.len(), "one value per vertex");
        let mut gathered = Vec::with_capacity(self.soup.positions.len());
        for (value, &row) in values.iter().zip(&self.row_of) {
            // Rows after the weld are in order of first appearance.
            if row as usize == gathered.len() {
                gathered.push(value.clone());
            }
        }
        gathered
    }
}

impl PolygonSoup {
    /// Vertices within `eps` of each other as one; 0 for equal positions only, in units of the coordinates.
    ///
    /// A vertex joins the first of those before it that stand for themselves and are no farther than `eps`.
    ///
    /// ```
    /// use mesh_core::{Point3, PolygonSoup};
    /// let split = PolygonSoup {
    ///     positions: [[0., 0.], [1., 0.], [0., 1.], [1., 0.], [1., 1.], [0., 1.]].map(|[x, y]| Point3::new(x, y, 0.)).to_vec(),
    ///     faces: vec![vec![0, 1, 2], vec![3, 4, 5]],
    /// };
    /// let weld = split.weld(0.0);
    /// assert_eq!(weld.soup.faces, [[0, 1, 2], [1, 3, 2]]);
    /// assert_eq!(weld.spread(&weld.soup.positions), split.positions);
    /// ```
    ///
    /// # Panics
    /// If a face names a vertex that is not there (see [`Self::check`]).
    pub fn weld(&self, eps: f64) -> Weld {
        let (positions, row_of) = weld_points(&self.positions, eps);
        let welded = |face: &Vec<u32>| face.iter().map(|&v| row_of[v as usize]).collect();
        Weld {
            soup: PolygonSoup {
                positions,
                faces: self.faces.iter().map(welded).collect(),
            },
            row_of,
        }
    }
}

/// The different points among `points` in order of first appearance, and the row among them of each.
pub(crate) fn weld_points(points: &[Point3], eps: f64) -> (Vec<Point3>, Vec<u32>) {
    if is_below_rounding(points, eps) {
        weld_equal(points)
    } else {
        weld_close(points, eps)
    }
}

/// Whether `eps` cannot tell any two points apart that are not equal.
fn is_below_rounding(points: &[Point3], eps: f64) -> bool {
    let largest = points.iter().map(|p| p.coords.amax()).fold(0.0, f64::max);
    eps.is_nan() || eps <= largest * (f64::EPSILON / 4.0)
}

/// The bits of a point's coordinates.
#[derive(PartialEq, Eq)]
struct Place([u64; 3]);

impl Hash for Place {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.0.iter().for_each(|&word| state.write_u64(word));
    }
}

/// Mixes whole words: a scan has millions of corners, and the hash of the standard library takes most of the time there.
/// What it tells decides where a place is looked up, never a result.
#[derive(Default)]
struct PlaceHasher(u64);

impl Hasher for PlaceHasher {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|&b| self.write_u64(u64::from(b)));
    }

    /// The finaliser of splitmix64, word after word.
    fn write_u64(&mut self, word: u64) {
        let mut z = (self.0 ^ word).wrapping_add(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        self.0 = z ^ (z >> 31);
    }
}

fn weld_equal(points: &[Point3]) -> (Vec<Point3>, Vec<u32>) {
    let mut kept = Vec::new();
    let mut row_at: HashMap<Place, u32, BuildHasherDefault<PlaceHasher>> = HashMap::default();
    let mut row_of = Vec::with_capacity(points.len());
    for p in points {
        // Adding zero makes −0 and +0 one.
        let key = Place(<[f64; 3]>::from(p.coords).map(|c| (c + 0.0).to_bits()));
        let row = *row_at.entry(key).or_insert_with(|| {
            kept.push(*p);
            kept.len() as u32 - 1
        });
        row_of.push(row);
    }
    (kept, row_of)
}

/// Looks for each point's representative in the cells of side `eps` around it.
fn weld_close(points: &[Point3], eps: f64) -> (Vec<Point3>, Vec<u32>) {
    let mut kept: Vec<Point3> = Vec::new();
    let mut rows_in: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    let mut row_of = Vec::with_capacity(points.len());
    for p in points {
        let cell = <[f64; 3]>::from(p.coords).map(|c| (c / eps).floor() as i64);
        let is_close = |row: &u32| (kept[*row as usize] - p).norm() <= eps;
        let found = around(cell)
            .filter_map(|cell| rows_in.get(&cell)?.iter().copied().find(is_close))
            .min();
        row_of.push(found.unwrap_or_else(|| {
            let row = kept.len() as u32;
            kept.push(*p);
            rows_in.entry(cell).or_default().push(row);
            row
        }));
    }
    (kept, row_of)
}

fn around([x, y, z]: [i64; 3]) -> impl Iterator<Item = [i64; 3]> {
    (0..27).map(move |k| {
        [(x, k % 3), (y, k / 3 % 3), (z, k / 9)].map(|(c, step)| c.saturating_add(step - 1))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;
    use proptest::prelude::*;

    #[test]
    fn a_soup_of_own_corners_becomes_the_mesh_it_came_from() {
        for mesh in [
            shapes::icosphere(2),
            shapes::prism(5),
            shapes::open_grid(3, 4),
        ] {
            let corners = mesh.faces.concat();
            let split = PolygonSoup {
                positions: corners
                    .iter()
                    .map(|&v| mesh.positions[v as usize])
                    .collect(),
                faces: (0..corners.len() as u32)
                    .collect::<Vec<_>>()
                    .chunk_by(|&a, &b| face_of(&mesh, a) == face_of(&mesh, b))
                    .map(<[u32]>::to_vec)
                    .collect(),
            };
            let weld = split.weld(0.0);
            assert_eq!(weld.soup.positions.len(), mesh.positions.len());
            assert_eq!(weld.spread(&weld.soup.positions), split.positions);
            assert_eq!(weld.gather(&split.positions), weld.soup.positions);
            let shape = |soup: &PolygonSoup| -> Vec<Vec<Point3>> {
                let at = |v: &u32| soup.positions[*v as usize];
                soup.faces
                    .iter()
                    .map(|f| f.iter().map(at).collect())
                    .collect()
            };
            assert_eq!(shape(&weld.soup), shape(&mesh));
        }
    }

    fn face_of(mesh: &PolygonSoup, corner: u32) -> Option<usize> {
        let mut first = 0;
        mesh.faces.iter().position(|face| {
            first += face.len() as u32;
            corner < first
        })
    }

    #[test]
    fn both_zeros_are_one_place() {
        let points = [Point3::new(0.0, -0.0, 1.0), Point3::new(-0.0, 0.0, 1.0)];
        assert_eq!(weld_points(&points, 0.0).1, [0, 0]);
    }

    proptest! {
        #[test]
        fn the_grid_finds_what_a_search_of_all_finds(
            raw in prop::collection::vec(prop::array::uniform3(-3.0..3.0f64), 0..60),
            eps in prop_oneof![Just(0.0), 0.01..2.0f64, Just(1e-320), Just(1e300)],
        ) {
            let points: Vec<Point3> = raw.into_iter().map(Point3::from).collect();
            let mut kept: Vec<Point3> = Vec::new();
            let expected: Vec<u32> = points.iter().map(|p| {
                let row = kept.iter().position(|k| (k - p).norm() <= eps).unwrap_or_else(|| {
                    kept.push(*p);
                    kept.len() - 1
                });
                row as u32
            }).collect();
            prop_assert_eq!(weld_points(&points, eps), (kept, expected));
        }
    }
}
