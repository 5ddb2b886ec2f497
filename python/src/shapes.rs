//! What is draped over what.

use std::path::PathBuf;

use mesh_draping::mesh_core::io::Morphs;
use mesh_draping::parts::PartProblem;
use mesh_draping::Seams;
use numpy::{PyArray2, PyReadonlyArray1};
use pyo3::prelude::*;

use crate::arrays::{self, Polygons, Rows};
use crate::error::{told, waited, Error};

/// The mesh to deform.
#[pyclass(frozen, module = "mesh_draping")]
#[derive(Clone)]
pub(crate) struct Source(pub(crate) mesh_draping::Source);

/// The shape to drape over.
#[pyclass(frozen, module = "mesh_draping")]
#[derive(Clone)]
pub(crate) struct Target(pub(crate) mesh_draping::Target);

fn seams(weld: &str) -> PyResult<Seams> {
    weld.parse()
        .map_err(|error| Error::new_err(format!("weld {weld}: {error}")))
}

fn morphs(name: &str) -> PyResult<Morphs> {
    match name {
        "carry" => Ok(Morphs::Carry),
        "keep" => Ok(Morphs::Keep),
        "drop" => Ok(Morphs::Drop),
        _ => Err(Error::new_err(format!(
            "morphs '{name}': there are carry, keep and drop"
        ))),
    }
}

#[pymethods]
impl Source {
    /// Reads a mesh from a file.
    #[staticmethod]
    #[pyo3(signature = (path, weld = "0", morph_targets = "keep"))]
    fn read(py: Python<'_>, path: PathBuf, weld: &str, morph_targets: &str) -> PyResult<Self> {
        let (seams, morphs) = (seams(weld)?, morphs(morph_targets)?);
        let source = waited(py, move || mesh_draping::Source::read_with(path, seams))?;
        Ok(Self(source.map_err(told)?.with_morphs(morphs)))
    }

    /// A mesh of vertices and polygons.
    #[staticmethod]
    #[pyo3(signature = (vertices, corners, counts, weld = "0"))]
    fn of_polygons(
        py: Python<'_>,
        vertices: Rows<'_>,
        corners: PyReadonlyArray1<'_, i64>,
        counts: PyReadonlyArray1<'_, i64>,
        weld: &str,
    ) -> PyResult<Self> {
        let (soup, seams) = (arrays::soup(&vertices, &corners, &counts)?, seams(weld)?);
        let source = py.detach(|| mesh_draping::Source::of_soup(soup, seams));
        Ok(Self(source.map_err(told)?))
    }

    /// The same mesh with a named part: the vertices of these rows.
    fn with_part(&self, name: &str, rows: PyReadonlyArray1<'_, i64>) -> PyResult<Self> {
        let rows = rows.as_slice()?.iter();
        let rows = rows.map(|&row| usize::try_from(row).unwrap_or(usize::MAX));
        let named = self.0.clone().with_part(name, &rows.collect::<Vec<_>>());
        let told = |problem: PartProblem| Error::new_err(format!("part {name}: {problem}"));
        Ok(Self(named.map_err(told)?))
    }

    /// The vertices at rest: those of the file or array, in its order.
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        arrays::of_points(py, &self.0.spread(self.0.rest()))
    }

    /// How many vertices the file or array has.
    #[getter]
    fn n_vertices(&self) -> usize {
        self.0.n_file_vertices()
    }

    /// The polygons: corners, one face after the other, and how many each has.
    #[getter]
    fn polygons<'py>(&self, py: Python<'py>) -> Polygons<'py> {
        arrays::of_faces(py, &self.0.soup().faces)
    }

    /// Writes the source with its vertices elsewhere.
    fn write(&self, py: Python<'_>, path: PathBuf, vertices: Rows<'_>) -> PyResult<()> {
        let positions = self.gathered(&vertices, "vertices")?;
        py.detach(|| self.0.write(path, &positions)).map_err(told)
    }
}

impl Source {
    /// One position per vertex of the source, from one per vertex of the file.
    pub(crate) fn gathered(
        &self,
        vertices: &Rows<'_>,
        what: &str,
    ) -> PyResult<mesh_draping::mesh_core::Positions> {
        let points = arrays::points(vertices, what)?;
        let (found, expected) = (points.len(), self.0.n_file_vertices());
        if found != expected {
            return Err(Error::new_err(format!(
                "{what} has {found} vertices, but the source has {expected}"
            )));
        }
        Ok(self.0.gather(&points).into())
    }
}

#[pymethods]
impl Target {
    /// Reads a mesh or a cloud from a file.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let target = waited(py, move || mesh_draping::Target::read(path))?;
        Ok(Self(target.map_err(told)?))
    }

    /// A surface of polygons.
    #[staticmethod]
    fn of_polygons(
        py: Python<'_>,
        vertices: Rows<'_>,
        corners: PyReadonlyArray1<'_, i64>,
        counts: PyReadonlyArray1<'_, i64>,
    ) -> PyResult<Self> {
        let soup = arrays::soup(&vertices, &corners, &counts)?;
        let target = waited(py, move || mesh_draping::Target::of_soup(soup))?;
        Ok(Self(target.map_err(told)?))
    }

    /// A cloud of points, with a normal for each or none at all.
    #[staticmethod]
    #[pyo3(signature = (points, normals = None))]
    fn of_points(py: Python<'_>, points: Rows<'_>, normals: Option<Rows<'_>>) -> PyResult<Self> {
        let points = arrays::points(&points, "points")?;
        let normals = normals
            .map(|n| arrays::vectors(&n, "normals"))
            .transpose()?;
        let target = waited(py, move || mesh_draping::Target::of_points(points, normals))?;
        Ok(Self(target.map_err(told)?))
    }

    /// The vertices or points of the file or array.
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        arrays::of_points(py, self.0.vertices())
    }

    /// What was left out as no part of the shape, in words.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.0.notes().iter().map(ToString::to_string).collect()
    }
}
