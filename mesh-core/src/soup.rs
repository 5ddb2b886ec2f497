//! Polygon soup: plain data, any arity, no invariant. What files hold.

use crate::{HalfedgeMesh, Point3, Positions, TopologyError};

/// Points and polygons over them; nothing is promised about either.
///
/// ```
/// use mesh_core::{Point3, PolygonSoup};
/// let soup = PolygonSoup {
///     positions: vec![Point3::origin(), Point3::new(1., 0., 0.), Point3::new(1., 1., 0.), Point3::new(0., 1., 0.)],
///     faces: vec![vec![0, 1, 2, 3]],
/// };
/// let (mesh, rest) = soup.into_halfedge()?;
/// assert_eq!((mesh.n_faces(), mesh.n_edges(), rest.len()), (1, 4, 4));
/// # Ok::<(), mesh_core::TopologyError>(())
/// ```
#[derive(Clone, PartialEq, Debug, Default)]
pub struct PolygonSoup {
    /// One point per vertex.
    pub positions: Vec<Point3>,
    /// One list of rows of `positions` per face, in loop order.
    pub faces: Vec<Vec<u32>>,
}

impl PolygonSoup {
    /// The validated connectivity and the positions beside it (see [`HalfedgeMesh::from_faces`]).
    ///
    /// # Errors
    /// A face that names a vertex that is not there, a coordinate that is not finite, or no face at all.
    pub fn into_halfedge(self) -> Result<(HalfedgeMesh, Positions), TopologyError> {
        self.check()?;
        if self.faces.is_empty() {
            return Err(TopologyError::NoFaces);
        }
        let mesh = HalfedgeMesh::from_faces(self.positions.len(), &self.faces)?;
        Ok((mesh, Positions::from(self.positions)))
    }

    /// Adds another shape as pieces of its own: its vertices and faces come after those that are there.
    pub fn append(&mut self, other: Self) {
        let n = self.positions.len() as u32;
        self.positions.extend(other.positions);
        let moved = |face: Vec<u32>| face.into_iter().map(|v| v + n).collect();
        self.faces.extend(other.faces.into_iter().map(moved));
    }

    /// Every coordinate is finite and every face names vertices that exist.
    ///
    /// # Errors
    /// The first offending vertex or face.
    pub fn check(&self) -> Result<(), TopologyError> {
        if let Some(vertex) = self
            .positions
            .iter()
            .position(|p| !p.coords.iter().all(|c| c.is_finite()))
        {
            return Err(TopologyError::NonFiniteCoordinate { vertex });
        }
        let n_vertices = self.positions.len();
        for (face, corners) in self.faces.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= n_vertices) {
                return Err(TopologyError::VertexOutOfRange {
                    face,
                    vertex,
                    n_vertices,
                });
            }
        }
        Ok(())
    }
}
