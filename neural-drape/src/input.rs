//! What goes into a drape, and whether it belongs together.

use std::sync::Arc;

use mesh_core::{Landmark, Positions, TargetSurface, Triangulation, Vector3};

use crate::DrapeError;

/// What is draped over what. A drape keeps what it needs of it: it borrows nothing.
#[derive(Clone, Copy)]
pub struct DrapeInput<'a> {
    /// The source's polygons as triangles.
    pub triangulation: &'a Arc<Triangulation>,
    /// The source as given: its shape is kept.
    pub rest: &'a Arc<Positions>,
    /// Where the drape starts, in the target's coordinates.
    pub initial: &'a Positions,
    /// The shape to drape over.
    pub target: &'a Arc<dyn TargetSurface>,
    /// Places that belong together.
    pub landmarks: &'a [Landmark],
}

impl DrapeInput<'_> {
    /// All belongs together, is finite, and has an area.
    pub(crate) fn check(&self) -> Result<(), DrapeError> {
        let expected = self.rest.len();
        check_length("the initial shape", self.initial.len(), expected)?;
        if self.triangulation.n_vertices() != expected {
            return Err(DrapeError::ForeignTriangulation {
                n_triangulated: self.triangulation.n_vertices(),
                n_vertices: expected,
            });
        }
        check_finite("the rest shape", self.rest.iter().map(|p| &p.coords))?;
        check_finite("the initial shape", self.initial.iter().map(|p| &p.coords))?;
        let areas = mesh_core::measure::triangle_areas(self.triangulation, self.rest);
        if areas.iter().sum::<f64>() > 0.0 {
            Ok(())
        } else {
            Err(DrapeError::NoArea)
        }
    }
}

/// There is one entry for each of the `expected` vertices.
pub(crate) fn check_length(
    what: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), DrapeError> {
    if found == expected {
        Ok(())
    } else {
        Err(DrapeError::LengthMismatch {
            what,
            found,
            expected,
        })
    }
}

/// Every entry is finite.
pub(crate) fn check_finite<'v>(
    what: &'static str,
    mut entries: impl Iterator<Item = &'v Vector3>,
) -> Result<(), DrapeError> {
    match entries.position(|v| !v.iter().all(|c| c.is_finite())) {
        Some(vertex) => Err(DrapeError::VertexNotFinite { what, vertex }),
        None => Ok(()),
    }
}

/// Every landmark is on a vertex of `n_vertices`, at a place and with a target that are finite.
pub(crate) fn check_landmarks(landmarks: &[Landmark], n_vertices: usize) -> Result<(), DrapeError> {
    for (row, landmark) in landmarks.iter().enumerate() {
        if let Some(v) = landmark
            .source
            .vertices
            .iter()
            .find(|v| v.index() >= n_vertices)
        {
            return Err(DrapeError::LandmarkOutOfRange {
                landmark: row,
                vertex: v.index(),
                n_vertices,
            });
        }
        let numbers = landmark
            .source
            .weights
            .iter()
            .chain(&landmark.target.coords)
            .chain([&landmark.weight]);
        if numbers.into_iter().any(|x| !x.is_finite()) {
            return Err(DrapeError::LandmarkNotFinite { landmark: row });
        }
    }
    Ok(())
}
