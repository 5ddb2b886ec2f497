//! What can be drawn: polygons as triangles that know their outlines, or points.

use mesh_core::{
    HalfedgeMesh, Point3, PolygonSoup, Positions, TopologyError, Triangulation, Vector3, VertexId,
};
use mesh_draping::{Source, Target};

/// A triangle to fill, and which of its sides are sides of the polygon it is part of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facet {
    /// Rows of its corners.
    pub corners: [usize; 3],
    /// Whether the side from corner `k` to corner `k + 1` is a side of the polygon, not a diagonal.
    pub is_outline: [bool; 3],
}

/// A shape ready to be drawn. Without facets it is a cloud.
#[derive(Clone, Debug)]
pub struct Model {
    /// Its vertices, or the points of a cloud.
    pub positions: Vec<Point3>,
    /// Unit normals of the vertices; zero where unknown.
    pub normals: Vec<Vector3>,
    /// Its triangles.
    pub facets: Vec<Facet>,
}

impl Model {
    /// The mesh at `positions`, its polygons split as `triangulation` says.
    pub fn mesh(mesh: &HalfedgeMesh, triangulation: &Triangulation, positions: &Positions) -> Self {
        let facets = triangulation
            .triangles()
            .iter()
            .enumerate()
            .map(|(t, &corners)| Facet {
                corners: corners.map(VertexId::index),
                is_outline: outline(corners, mesh.face_vertices(triangulation.parent(t))),
            })
            .collect();
        Self {
            normals: mesh_core::measure::vertex_normals(triangulation, positions).into_vec(),
            positions: positions.as_slice().to_vec(),
            facets,
        }
    }

    /// Points, with unit normals where there are some.
    pub fn cloud(points: &[Point3], normals: Option<&[Vector3]>) -> Self {
        Self {
            positions: points.to_vec(),
            normals: normals.map_or_else(|| vec![Vector3::zeros(); points.len()], <[_]>::to_vec),
            facets: Vec::new(),
        }
    }

    /// The source with its vertices at `positions`.
    pub fn of_source(source: &Source, positions: &Positions) -> Self {
        Self::mesh(source.mesh(), source.triangulation(), positions)
    }

    /// The target: all that is in its file, or the points of its cloud that were kept.
    ///
    /// # Errors
    /// As [`Self::of_soup`].
    pub fn of_target(target: &Target) -> Result<Self, TopologyError> {
        if !target.is_cloud() {
            return Self::of_soup(target.soup());
        }
        let (points, normals): (Vec<Point3>, Vec<Vector3>) =
            target.kept_points().into_iter().unzip();
        Ok(Self::cloud(&points, Some(&normals)))
    }

    /// Whatever is in a file: a mesh where there are faces, else a cloud.
    ///
    /// # Errors
    /// A face that names a vertex that is not there, or a coordinate that is not finite.
    pub fn of_soup(soup: &PolygonSoup) -> Result<Self, TopologyError> {
        if soup.faces.is_empty() {
            return Ok(Self::cloud(&soup.positions, None));
        }
        let (mesh, positions) = soup.clone().into_halfedge()?;
        let triangulation = Triangulation::new(&mesh, &positions);
        Ok(Self::mesh(&mesh, &triangulation, &positions))
    }

    /// The same shape seen through `point` and `direction`, a map of space and what it does to directions.
    #[must_use]
    pub fn mapped(
        &self,
        point: impl Fn(&Point3) -> Point3,
        direction: impl Fn(&Vector3) -> Vector3,
    ) -> Self {
        Self {
            positions: self.positions.iter().map(point).collect(),
            normals: self.normals.iter().map(direction).collect(),
            facets: self.facets.clone(),
        }
    }

    /// The points that are seen: corners of facets, or all points of a cloud.
    pub fn seen_points(&self) -> Vec<Point3> {
        if self.facets.is_empty() {
            return self.positions.clone();
        }
        let mut is_seen = vec![false; self.positions.len()];
        for corner in self.facets.iter().flat_map(|f| f.corners) {
            is_seen[corner] = true;
        }
        let seen = self
            .positions
            .iter()
            .zip(is_seen)
            .filter(|(_, is_seen)| *is_seen);
        seen.map(|(p, _)| *p).collect()
    }
}

fn outline(corners: [VertexId; 3], polygon: &[VertexId]) -> [bool; 3] {
    let is_side = |a, b| {
        (0..polygon.len()).any(|k| {
            let (p, q) = (polygon[k], polygon[(k + 1) % polygon.len()]);
            (p, q) == (a, b) || (q, p) == (a, b)
        })
    };
    let [a, b, c] = corners;
    [is_side(a, b), is_side(b, c), is_side(c, a)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quad_shows_four_sides_and_hides_its_diagonal() {
        let model = Model::of_soup(&mesh_core::shapes::open_grid(1, 1)).unwrap();
        assert_eq!(model.facets.len(), 2);
        let n_outlines = model
            .facets
            .iter()
            .flat_map(|f| f.is_outline)
            .filter(|&o| o)
            .count();
        assert_eq!(n_outlines, 4);
    }

    #[test]
    fn unused_points_are_not_seen() {
        let mut soup = mesh_core::shapes::open_grid(2, 1);
        soup.positions.push(Point3::new(1e6, 0.0, 0.0));
        assert_eq!(Model::of_soup(&soup).unwrap().seen_points().len(), 6);
    }

    #[test]
    fn a_soup_without_faces_is_a_cloud() {
        let mut soup = mesh_core::shapes::tetrahedron();
        soup.faces.clear();
        assert_eq!(Model::of_soup(&soup).unwrap().seen_points().len(), 4);
    }
}
