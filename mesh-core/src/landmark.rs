//! Landmark pairs {vᵢ, uᵢ}: a place on the source and where it belongs on the target.

use crate::{Point3, Positions, VertexId};

/// A place on a mesh: a weighted mean of three vertices. It moves with them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshPoint {
    /// The three vertices; a vertex that counts nothing may be repeated.
    pub vertices: [VertexId; 3],
    /// Their weights, summing to 1.
    pub weights: [f64; 3],
}

impl MeshPoint {
    /// The place of a vertex.
    pub fn vertex(v: VertexId) -> Self {
        Self {
            vertices: [v; 3],
            weights: [1.0, 0.0, 0.0],
        }
    }

    /// The place with these barycentric coordinates in a triangle.
    pub fn barycentric(vertices: [VertexId; 3], weights: [f64; 3]) -> Self {
        Self { vertices, weights }
    }

    /// Where the place is when the vertices are at `x`.
    pub fn position(&self, x: &Positions) -> Point3 {
        let terms = self.vertices.iter().zip(self.weights);
        Point3::from(terms.map(|(&v, w)| x[v].coords * w).sum::<crate::Vector3>())
    }

    /// The vertex that counts most.
    pub fn main_vertex(&self) -> VertexId {
        let [a, b, c] = self.weights;
        self.vertices[if a >= b && a >= c {
            0
        } else if b >= c {
            1
        } else {
            2
        }]
    }
}

/// Whether the surroundings of a landmark stretch with it or turn with it as one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum LandmarkKind {
    /// Moves by the biharmonic field.
    #[default]
    Soft,
    /// Handled by the as-rigid-as-possible solve.
    Rigid,
}

/// One landmark pair.
#[derive(Clone, Debug, PartialEq)]
pub struct Landmark {
    /// What the user calls it.
    pub name: Option<String>,
    /// The place on the source.
    pub source: MeshPoint,
    /// Where it belongs, in the target's coordinates.
    pub target: Point3,
    /// Soft or rigid.
    pub kind: LandmarkKind,
}

impl Landmark {
    /// A soft landmark without a name on a vertex.
    pub fn new(vertex: VertexId, target: Point3) -> Self {
        Self {
            name: None,
            source: MeshPoint::vertex(vertex),
            target,
            kind: LandmarkKind::Soft,
        }
    }
}
