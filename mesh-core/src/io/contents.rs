//! What a file holds beside points and polygons.

use std::collections::HashMap;
use std::ops::Range;

use crate::{Point3, PolygonSoup, Vector3};

/// What a file holds beside points and polygons: for people to look at, and kept when the file is written back.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Contents {
    /// How many texture coordinates there are.
    pub n_uvs: usize,
    /// How many normals there are.
    pub n_normals: usize,
    /// How many vertices carry a colour.
    pub n_colors: usize,
    /// How many whole-line comments there are.
    pub n_comments: usize,
    /// How many line and point elements there are.
    pub n_lines_and_points: usize,
    /// How many morph targets (blend shapes) there are, those of all meshes together.
    pub n_morph_targets: usize,
    /// How many skins there are.
    pub n_skins: usize,
    /// How many animations there are.
    pub n_animations: usize,
    /// The named objects (glTF: meshes; STL: solids), in order of first appearance.
    pub objects: Vec<NamedFaces>,
    /// The named groups of faces, in order of first appearance; a face may be in several.
    pub groups: Vec<NamedFaces>,
    /// The materials in use, in order of first appearance.
    pub materials: Vec<NamedFaces>,
    /// How many different smoothing groups there are, "off" not counted.
    pub n_smoothing_groups: usize,
    /// The material libraries and pictures that this file names; none of them is opened.
    pub references: Vec<String>,
}

impl Contents {
    /// Whether there are texture coordinates.
    pub fn has_uvs(&self) -> bool {
        self.n_uvs > 0
    }
}

/// What becomes of the morph targets (blend shapes) of a glTF file when it is written with new positions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Morphs {
    /// Each displacement goes through the gradient of the map at its vertex, so that an expression made for the source
    /// becomes one of the new shape.
    Carry,
    /// Byte for byte as they were.
    #[default]
    Keep,
    /// Removed, with their weights and what animates these.
    Drop,
}

/// Faces under one name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NamedFaces {
    /// The name.
    pub name: String,
    /// Rows of the faces, in ascending runs.
    pub faces: Vec<Range<usize>>,
}

impl NamedFaces {
    /// How many faces there are.
    pub fn n_faces(&self) -> usize {
        self.faces.iter().map(ExactSizeIterator::len).sum()
    }
}

/// Collects the runs of faces that follow a line like `g arm hand`.
#[derive(Default)]
pub(super) struct NameRuns {
    named: Vec<NamedFaces>,
    row_of: HashMap<String, usize>,
    current: Vec<usize>,
    is_current: Vec<bool>,
    since: usize,
}

impl NameRuns {
    /// From face `n_faces` on, faces belong to `names`.
    pub(super) fn start<'n>(&mut self, names: impl Iterator<Item = &'n [u8]>, n_faces: usize) {
        self.close(n_faces);
        for name in names {
            let name = String::from_utf8_lossy(name).into_owned();
            let row = *self.row_of.entry(name).or_insert_with_key(|name| {
                self.named.push(NamedFaces {
                    name: name.clone(),
                    faces: Vec::new(),
                });
                self.is_current.push(false);
                self.named.len() - 1
            });
            if !std::mem::replace(&mut self.is_current[row], true) {
                self.current.push(row);
            }
        }
    }

    fn close(&mut self, n_faces: usize) {
        for row in self.current.drain(..) {
            self.is_current[row] = false;
            if self.since < n_faces {
                self.named[row].faces.push(self.since..n_faces);
            }
        }
        self.since = n_faces;
    }

    /// The names and their faces, of `n_faces` in all.
    pub(super) fn finish(mut self, n_faces: usize) -> Vec<NamedFaces> {
        self.close(n_faces);
        self.named
    }
}

/// The normals of a file, one value per row, carried to a new shape.
///
/// Row n becomes `Σ ± A_f / |Σ ± A_f|` over the corners that name it, A_f the area vector of the corner's face on the
/// new shape. The sign is that of `A_f · n` on the shape as read, so that normals keep the side they were on whatever
/// way their faces turn.
pub(super) struct CarriedNormals {
    read: Vec<Vector3>,
    sums: Vec<[Vector3; 2]>,
}

impl CarriedNormals {
    /// Starts from the normals as read.
    pub(super) fn new(read: Vec<Vector3>) -> Self {
        let sums = vec![[Vector3::zeros(); 2]; read.len()];
        Self { read, sums }
    }

    /// Those of a file with one normal per vertex.
    pub(super) fn of_vertices(read: Vec<Vector3>, rest: &PolygonSoup, moved: &[Point3]) -> Self {
        let mut carried = Self::new(read);
        for corners in &rest.faces {
            let areas = [&rest.positions[..], moved].map(|x| polygon_area_vector(x, corners));
            for &v in corners {
                carried.add_corner(v as usize, areas);
            }
        }
        carried
    }

    /// Adds the corner of a face with the area vectors `rest` (as read) and `moved`, whose normal is `row`.
    pub(super) fn add_corner(&mut self, row: usize, [rest, moved]: [Vector3; 2]) {
        let (Some(read), Some(sums)) = (self.read.get(row), self.sums.get_mut(row)) else {
            return;
        };
        let side = if read.dot(&rest) < 0.0 { -1.0 } else { 1.0 };
        sums[0] += side * rest;
        sums[1] += side * moved;
    }

    /// The new value of a row; none where nothing moved, or where no face with area names it.
    pub(super) fn changed(&self, row: usize) -> Option<Vector3> {
        let [rest, moved] = self.sums[row];
        if rest == moved {
            return None;
        }
        unit(moved)
    }
}

/// `v / |v|`; none where v is zero or its length is more than a number can hold.
pub(crate) fn unit(v: Vector3) -> Option<Vector3> {
    v.try_normalize(f64::MIN_POSITIVE)
        .filter(|n| n.iter().all(|c| c.is_finite()))
}

/// Twice the area of a polygon times its normal: `Σ (pᵢ − p₀) × (pᵢ₊₁ − p₀)`.
pub(super) fn polygon_area_vector(positions: &[Point3], corners: &[u32]) -> Vector3 {
    let Some((&first, rest)) = corners.split_first() else {
        return Vector3::zeros();
    };
    let p = |v: u32| positions[v as usize] - positions[first as usize];
    rest.windows(2)
        .map(|side| p(side[0]).cross(&p(side[1])))
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_one_name_are_collected() {
        let mut runs = NameRuns::default();
        runs.start([b"a".as_slice(), b"b"].into_iter(), 2);
        runs.start([b"a".as_slice(), b"a"].into_iter(), 5);
        let named = runs.finish(6);
        assert_eq!(
            (named[0].faces.as_slice(), named[0].n_faces()),
            ([2..5, 5..6].as_slice(), 4)
        );
        assert_eq!((named[1].name.as_str(), named[1].n_faces()), ("b", 3));
    }

    #[test]
    fn a_normal_keeps_its_side_and_its_text_where_nothing_moved() {
        let up = Vector3::z();
        let mut carried = CarriedNormals::new(vec![up, -up, up, up]);
        for row in [0, 1] {
            carried.add_corner(row, [2.0 * up, 3.0 * Vector3::x()]);
        }
        carried.add_corner(2, [up, up]);
        carried.add_corner(99, [up, up]);
        // Areas of coordinates near the largest number: NaN is not equal to itself, yet nothing moved.
        let huge = Vector3::new(f64::NAN, f64::INFINITY, 0.0);
        carried.add_corner(3, [huge, huge]);
        assert_eq!(carried.changed(3), None);
        assert_eq!(carried.changed(0), Some(Vector3::x()));
        assert_eq!(carried.changed(1), Some(-Vector3::x()));
        assert_eq!(carried.changed(2), None);
    }

    #[test]
    fn area_vector_of_a_square_and_of_less_than_a_triangle() {
        let square = [[0., 0.], [1., 0.], [1., 1.], [0., 1.]].map(|[x, y]| Point3::new(x, y, 3.0));
        assert_eq!(
            polygon_area_vector(&square, &[0, 1, 2, 3]),
            2.0 * Vector3::z()
        );
        for corners in [&[][..], &[1], &[1, 2]] {
            assert_eq!(polygon_area_vector(&square, corners), Vector3::zeros());
        }
    }
}
