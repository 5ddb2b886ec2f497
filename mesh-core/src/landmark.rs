//! Landmark pairs {vᵢ, uᵢ}: a place on the source and where it belongs on the target.

use std::sync::Arc;

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
    /// What it counts beside the others; 1 is what each counts unless said otherwise, 0 or less is as if it were not there.
    pub weight: f64,
    /// What it was cut from, if that is a curve.
    pub curve: Option<CurveShare>,
}

/// What a landmark that was cut from a curve is of it.
#[derive(Clone, Debug, PartialEq)]
pub struct CurveShare {
    /// The curve.
    pub curve: Arc<Curve>,
    /// What it counts in sums over landmarks, in landmarks: those cut from one curve count as few.
    pub share: f64,
}

/// A line on the source and the line of the target where it belongs, matched by arc length between their ends.
///
/// It is closed where its last place is its first, on either shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// What the user calls it.
    pub name: Option<String>,
    /// Places along the line on the source, joined by the shortest ways along the surface.
    pub source: Vec<MeshPoint>,
    /// Points along the line on the target, joined by segments, in its coordinates.
    pub target: Vec<Point3>,
    /// What it counts, as the weight of a landmark does.
    pub weight: f64,
}

impl Landmark {
    /// A soft landmark of weight 1 without a name on a vertex.
    pub fn new(vertex: VertexId, target: Point3) -> Self {
        Self {
            name: None,
            source: MeshPoint::vertex(vertex),
            target,
            kind: LandmarkKind::Soft,
            weight: 1.0,
            curve: None,
        }
    }

    /// Whether it counts at all.
    pub fn is_followed(&self) -> bool {
        self.weight > 0.0
    }

    /// What it counts in a sum over landmarks: its weight, of a curve's landmark its share of that.
    pub fn pull(&self) -> f64 {
        let share = self.curve.as_ref().map(|of| of.share);
        share.map_or(self.weight, |share| self.weight * share)
    }

    /// The landmarks that were marked one by one, not cut from a curve, in order: by their place among these they are numbered.
    pub fn marked(landmarks: &[Self]) -> impl Iterator<Item = &Self> + Clone {
        landmarks.iter().filter(|l| l.curve.is_none())
    }

    /// The landmarks that count, in order.
    pub fn followed(landmarks: &[Self]) -> Vec<Self> {
        let followed = landmarks.iter().filter(|l| l.is_followed());
        followed.cloned().collect()
    }
}

impl Curve {
    /// The curves that landmarks were cut from, each with its landmarks, in order: by their place among these they are
    /// numbered.
    pub fn runs(landmarks: &[Landmark]) -> impl Iterator<Item = (&Arc<Self>, &[Landmark])> {
        let curve = |l: &'_ Landmark| l.curve.as_ref().map(|of| Arc::as_ptr(&of.curve));
        let runs = landmarks.chunk_by(move |a, b| curve(a) == curve(b));
        runs.filter_map(|run| Some((&run.first()?.curve.as_ref()?.curve, run)))
    }
}
