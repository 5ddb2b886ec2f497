//! Pairs of a place on the mesh and a point of the target: what the distance terms look at, and how they are drawn.

use mesh_core::{Point3, Positions, Vector3, VertexData, VertexId};

/// A place on the moving mesh and the fixed point it is matched with.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceMatch {
    /// Corners of the triangle that holds the place.
    pub triangle: [VertexId; 3],
    /// Weights of the corners, summing to 1.
    pub barycentric: [f64; 3],
    /// The matched point of the target.
    pub point: Point3,
    /// Unit normal of the target there, turned to the mesh's side where its sign means nothing; none where the place is
    /// the one closest to a target point and on an edge of the mesh, where no triangle is to be turned more than others.
    pub normal: Option<Vector3>,
    /// How much the pair counts, 0..=1.
    pub weight: f64,
    /// Whether the sample's closest point lies on an open boundary of the other surface.
    pub is_on_boundary: bool,
}

impl SurfaceMatch {
    /// From the matched target point to the place on the mesh at `x`.
    pub fn offset(&self, x: &Positions) -> Vector3 {
        let [a, b, c] = self.triangle.map(|v| x[v].coords);
        let [wa, wb, wc] = self.barycentric;
        a * wa + b * wb + c * wc - self.point.coords
    }

    /// Adds `g`, a gradient with respect to the place, to the three corners.
    pub(crate) fn scatter(&self, g: &Vector3, grad: &mut VertexData<Vector3>) {
        for (&v, w) in self.triangle.iter().zip(self.barycentric) {
            grad[v] += g * w;
        }
    }
}

/// Matches in both directions.
#[derive(Clone, Debug, Default)]
pub struct Matches {
    /// Samples of the mesh, each with its closest point on the target.
    pub to_target: Vec<SurfaceMatch>,
    /// Samples of the target, each with its closest place on the mesh.
    pub to_mesh: Vec<SurfaceMatch>,
    /// Corners of the mesh that are far off, with their closest points; for [`crate::WorstDistance`] alone.
    pub hard_to_target: Vec<SurfaceMatch>,
    /// Corners of the target that are far off, with their closest places; for [`crate::WorstDistance`] alone.
    pub hard_to_mesh: Vec<SurfaceMatch>,
}

/// How samples are drawn and pairs weighted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SamplingConfig {
    /// Samples on each side.
    pub n_samples: usize,
    /// Share of the mesh's samples drawn by face instead of by area, 0..=1.
    pub face_uniform: f64,
    /// Pairs count by clamp(n·n′ + `normal_bias`, 0.05, 1); none: all pairs count 1.
    pub normal_bias: Option<f64>,
    /// How many corners of each shape are kept in mind as far off; as many others are looked at anew each time.
    pub n_hard: usize,
    /// Which pairs at open boundaries are left out.
    pub overlap: Overlap,
    /// With a target that is only a part, a sample of the mesh counts if the way to its closest point and from there back
    /// to the mesh ends no farther from it than this share of the way there, ≥ 0. The less, the stricter.
    pub mutual: f64,
}

/// Which surface reaches beyond the other. A place beyond has its closest point on the other's open boundary, and
/// must not be pulled there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Overlap {
    /// The target reaches beyond the mesh: its samples whose closest place is on the mesh's boundary are left out.
    pub target_exceeds: bool,
    /// The mesh reaches beyond the target: its samples whose closest point is on the target's boundary are left out, and
    /// so are pairs that oppose each other, and samples whose closest point belongs to another place of the mesh.
    pub mesh_exceeds: bool,
}

/// How much of each surface lies beyond the other, from [`SurfaceMatcher::beyond`](crate::SurfaceMatcher::beyond); shares in 0..=1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beyond {
    /// Share of the target's area beyond the mesh.
    pub of_target: f64,
    /// Share of the mesh's area beyond the target.
    pub of_mesh: f64,
}
