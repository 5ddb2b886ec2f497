//! Where rays meet a surface: for pictures of it, and back from a picture to the surface.

use mesh_draping::mesh_core::{Point3, TriangleBvh, Vector3};
use numpy::PyArray1;
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::arrays::{self, Rows};
use crate::error::{waited, Error};
use crate::shapes::{Source, Target};

/// A surface that rays are sent to.
#[pyclass(frozen, module = "mesh_draping")]
pub(crate) struct Surface(Of);

/// Whose surface it is: a source has its hierarchy already.
enum Of {
    Source(mesh_draping::Source),
    Target(TriangleBvh),
}

#[pymethods]
impl Surface {
    /// The surface of a source at rest.
    #[staticmethod]
    fn of_source(source: &Source) -> Self {
        Self(Of::Source(source.0.clone()))
    }

    /// The surface of a target; none where it is a cloud.
    #[staticmethod]
    fn of_target(target: &Target) -> Option<Self> {
        let triangles = target.0.triangles();
        (!triangles.is_empty()).then(|| Self(Of::Target(TriangleBvh::new(triangles))))
    }

    /// How far each ray goes before it meets the surface, in lengths of its direction: infinity where it does not.
    fn cast<'py>(
        slf: Bound<'py, Self>,
        py: Python<'py>,
        origins: Rows<'py>,
        directions: Rows<'py>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let origins = arrays::points(&origins, "origins")?;
        let directions = arrays::vectors(&directions, "directions")?;
        if origins.len() != directions.len() {
            return Err(Error::new_err("there is not one direction for each origin"));
        }
        let surface = slf.unbind();
        let distances = waited(py, move || surface.get().distances(&origins, &directions))?;
        Ok(PyArray1::from_vec(py, distances))
    }
}

impl Surface {
    fn distances(&self, origins: &[Point3], directions: &[Vector3]) -> Vec<f64> {
        let bvh = match &self.0 {
            Of::Source(source) => source.bvh(),
            Of::Target(bvh) => bvh,
        };
        let rays = origins.par_iter().zip(directions).with_min_len(256);
        let distance = |(origin, direction): (&Point3, &Vector3)| {
            let hit = bvh.first_hit(origin, direction);
            hit.map_or(f64::INFINITY, |hit| hit.distance)
        };
        rays.map(distance).collect()
    }
}
