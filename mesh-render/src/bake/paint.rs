//! The colours of a target, as a function on its surface.

use std::path::{Path, PathBuf};

use mesh_core::io::{self, Looks, MeshFile, Rgb};

use super::error::BakeError;
use super::picture::DecodedPicture;
use super::sheet::{FacePlace, Place};

/// A face that shows no picture.
const NO_PICTURE: u32 = u32::MAX;

/// The colours of a shape: its pictures where faces show one, else the colours of its vertices.
///
/// Pictures are PNG or JPEG, looked at between their pixels, and repeat beyond the unit square. Colours of vertices are
/// mixed by barycentric coordinates; of a cloud, the closest point has its own. All are taken as the file has them, on the
/// curve of screens.
pub struct Paint {
    path: PathBuf,
    looks: Looks,
    pictures: Vec<DecodedPicture>,
    /// For each face the row of its picture.
    picture_of: Vec<u32>,
    n_vertices: usize,
}

impl Paint {
    /// Reads the colours of a mesh file, and the pictures that it names, from its folder and below.
    ///
    /// # Errors
    /// A file that cannot be read, has no colours, or has a picture that is not understood.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, BakeError> {
        Self::of_file(&io::read_mesh(path)?)
    }

    /// The colours of a file that is in memory.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn of_file(file: &MeshFile) -> Result<Self, BakeError> {
        let path = file.path().to_owned();
        let mut looks = file.looks();
        let mut picture_of = vec![NO_PICTURE; file.soup().faces.len()];
        let mut pictures = Vec::new();
        if looks.corner_uvs.is_some() {
            for picture in std::mem::take(&mut looks.pictures) {
                let decoded = DecodedPicture::decode(&picture.bytes);
                let row = pictures.len() as u32;
                pictures.push(decoded.map_err(|problem| BakeError::Picture {
                    path: path.clone(),
                    problem,
                })?);
                for face in picture.faces.into_iter().flatten() {
                    if let Some(shown) = picture_of.get_mut(face) {
                        *shown = row;
                    }
                }
            }
        }
        if looks.vertex_colors.is_none() && pictures.is_empty() {
            return Err(BakeError::NoColors { path });
        }
        Ok(Self {
            path,
            looks,
            pictures,
            picture_of,
            n_vertices: file.soup().positions.len(),
        })
    }

    /// Refuses a target that is not the shape of this file.
    pub(super) fn check(&self, n_vertices: usize) -> Result<(), BakeError> {
        match self.n_vertices == n_vertices {
            true => Ok(()),
            false => Err(BakeError::AnotherShape {
                path: self.path.clone(),
                found: self.n_vertices,
                expected: n_vertices,
            }),
        }
    }

    /// That the shape has no colour where it is looked at.
    pub(super) fn no_colors(&self) -> BakeError {
        BakeError::NoColors {
            path: self.path.clone(),
        }
    }

    /// The colour of a place; none where the shape has none there.
    pub(super) fn at(&self, place: &Place) -> Option<Rgb> {
        match place {
            Place::Point { row } => Some(*self.looks.vertex_colors.as_ref()?.get(*row)?),
            Place::Face(place) => self.of_picture(place).or_else(|| self.of_vertices(place)),
        }
    }

    fn of_picture(&self, place: &FacePlace) -> Option<Rgb> {
        let picture = *self.picture_of.get(place.face)?;
        let picture = self.pictures.get(picture as usize)?;
        let uvs = self.looks.corner_uvs.as_ref()?.get(place.face)?;
        let mut uv = [0.0; 2];
        for (&corner, weight) in place.corners.iter().zip(place.weights) {
            let at = (*uvs.get(corner as usize)?)?;
            uv = [uv[0] + weight * at[0], uv[1] + weight * at[1]];
        }
        Some(picture.at(uv))
    }

    fn of_vertices(&self, place: &FacePlace) -> Option<Rgb> {
        let colors = self.looks.vertex_colors.as_ref()?;
        let mut mixed = [0.0; 3];
        for (&v, weight) in place.vertices.iter().zip(place.weights) {
            let color = colors.get(v as usize)?;
            mixed = std::array::from_fn(|k| mixed[k] + weight as f32 * color[k]);
        }
        Some(mixed)
    }
}
