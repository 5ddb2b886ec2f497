//! Texture coordinates as values: for files in other formats, where their own text cannot be kept.

use crate::PolygonSoup;

/// One texture coordinate per corner, (0, 0) at the lower left of the image.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct CornerUvs {
    /// The different coordinates.
    pub(super) rows: Vec<[f64; 2]>,
    /// For each corner of each face its row, if it has one.
    pub(super) faces: Vec<Vec<Option<u32>>>,
}

impl CornerUvs {
    /// Those of a file with one coordinate per vertex.
    pub(super) fn of_vertices(rows: Vec<[f64; 2]>, soup: &PolygonSoup) -> Self {
        let faces = soup
            .faces
            .iter()
            .map(|f| f.iter().map(|&v| Some(v)).collect())
            .collect();
        Self { rows, faces }
    }

    /// The row that corner `corner` of face `face` names, if it is there.
    pub(super) fn row(&self, face: usize, corner: usize) -> Option<u32> {
        let row = self.faces.get(face)?.get(corner).copied().flatten()?;
        ((row as usize) < self.rows.len()).then_some(row)
    }

    /// The coordinate of corner `corner` of face `face`.
    pub(super) fn at(&self, face: usize, corner: usize) -> Option<[f64; 2]> {
        Some(self.rows[self.row(face, corner)? as usize])
    }
}
