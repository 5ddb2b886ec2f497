//! Arrays of numpy as meshes and positions, and back.

use mesh_draping::mesh_core::{Point3, PolygonSoup, Vector3};
use numpy::{PyArray1, PyArray2, PyArrayMethods as _, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::error::Error;

/// Rows of three numbers, as they come from Python: C-contiguous, read where they are.
pub(crate) type Rows<'py> = PyReadonlyArray2<'py, f64>;

/// The rows of an array of shape (n, 3), each made into something.
fn rows<T>(array: &Rows<'_>, what: &str, row: impl Fn(&[f64]) -> T) -> PyResult<Vec<T>> {
    let wrong = || Error::new_err(format!("{what} must be an array of shape (n, 3)"));
    let view = array.as_array();
    // None where the rows do not lie one after the other.
    let numbers = view.as_slice().filter(|_| view.ncols() == 3);
    let rows = numbers.ok_or_else(wrong)?.chunks_exact(3);
    Ok(rows.map(row).collect())
}

/// Points from an array of shape (n, 3).
pub(crate) fn points(array: &Rows<'_>, what: &str) -> PyResult<Vec<Point3>> {
    rows(array, what, |r| Point3::new(r[0], r[1], r[2]))
}

/// Vectors from an array of shape (n, 3).
pub(crate) fn vectors(array: &Rows<'_>, what: &str) -> PyResult<Vec<Vector3>> {
    rows(array, what, |r| Vector3::new(r[0], r[1], r[2]))
}

/// Polygons: the rows of the vertices at their corners, one face after the other, and how many corners each has.
pub(crate) fn soup(
    vertices: &Rows<'_>,
    corners: &PyReadonlyArray1<'_, i64>,
    counts: &PyReadonlyArray1<'_, i64>,
) -> PyResult<PolygonSoup> {
    let positions = points(vertices, "vertices")?;
    let (corners, counts) = (corners.as_slice()?, counts.as_slice()?);
    let mut rest = corners;
    let mut faces = Vec::with_capacity(counts.len());
    for &n in counts {
        let n = usize::try_from(n).ok().filter(|&n| n <= rest.len());
        let n = n.ok_or_else(|| Error::new_err("faces name more corners than there are"))?;
        let (face, others) = rest.split_at(n);
        faces.push(face.iter().map(|&v| vertex(v)).collect::<PyResult<_>>()?);
        rest = others;
    }
    Ok(PolygonSoup { positions, faces })
}

fn vertex(row: i64) -> PyResult<u32> {
    let wrong = || {
        Error::new_err(format!(
            "a face names vertex {row}; vertices count from 0 to 2^32 - 1"
        ))
    };
    u32::try_from(row).map_err(|_| wrong())
}

/// An array of shape (n, 3) that owns its numbers.
pub(crate) fn of_points<'py, 'p>(
    py: Python<'py>,
    points: impl IntoIterator<Item = &'p Point3>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let flat: Vec<f64> = points.into_iter().flat_map(|p| [p.x, p.y, p.z]).collect();
    let n = flat.len() / 3;
    PyArray1::from_vec(py, flat).reshape([n, 3])
}

/// Polygons as two arrays: corners, one face after the other, and how many each has.
pub(crate) type Polygons<'py> = (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i64>>);

/// Faces as polygons.
pub(crate) fn of_faces<'py>(py: Python<'py>, faces: &[Vec<u32>]) -> Polygons<'py> {
    let corners: Vec<i64> = faces.iter().flatten().map(|&v| v.into()).collect();
    let counts: Vec<i64> = faces.iter().map(|face| face.len() as i64).collect();
    (
        PyArray1::from_vec(py, corners),
        PyArray1::from_vec(py, counts),
    )
}
