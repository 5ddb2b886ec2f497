//! Polygons as triangles, for the formats that have no others.

use std::collections::HashMap;

use crate::{measure, HalfedgeMesh, PolygonSoup, Positions, TopologyError, Triangulation, Vector3};

/// A soup cut into triangles.
pub(super) struct Triangles {
    /// Each triangle as corners of its face, counted along the face.
    pub(super) corners: Vec<[usize; 3]>,
    /// The face of each.
    pub(super) faces: Vec<usize>,
    /// The unit normal of each vertex; zero where no triangle has it.
    pub(super) normals: Vec<Vector3>,
}

impl Triangles {
    /// The triangles of `soup`, cut as [`Triangulation`] does; degenerate faces give none.
    ///
    /// # Errors
    /// A face that names a vertex that is not there.
    pub(super) fn of(soup: &PolygonSoup) -> Result<Self, TopologyError> {
        let mesh = HalfedgeMesh::from_faces(soup.positions.len(), &soup.faces)?;
        let x = Positions::from(soup.positions.clone());
        let triangulation = Triangulation::new(&mesh, &x);
        let mut triangles = Self {
            corners: Vec::with_capacity(triangulation.len()),
            faces: Vec::with_capacity(triangulation.len()),
            normals: measure::vertex_normals(&triangulation, &x).into_vec(),
        };
        let mut corner_of: HashMap<u32, usize> = HashMap::new();
        for (t, vertices) in triangulation.triangles().iter().enumerate() {
            let face = triangulation.parent(t).index();
            if triangles.faces.last() != Some(&face) {
                corner_of.clear();
                let corners = soup.faces[face].iter().enumerate().rev();
                corner_of.extend(corners.map(|(corner, &v)| (v, corner)));
            }
            triangles
                .corners
                .push(vertices.map(|v| corner_of[&(v.index() as u32)]));
            triangles.faces.push(face);
        }
        Ok(triangles)
    }
}
