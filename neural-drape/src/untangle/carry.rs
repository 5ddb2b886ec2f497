//! A patch as it was at rest, carried by what is around it.

use mesh_core::{nearest_rotation, Positions, Triangulation, UnionFind, Vector3, VertexId};
use mesh_operators::nalgebra_sparse::{CooMatrix, CsrMatrix};
use mesh_operators::SpdSolver;
use nalgebra::Matrix3;

use crate::repair::grown;

/// So many rings around a patch say how it is turned and scaled.
const RIM: usize = 2;
/// So many steps the patch takes to its shape.
const STEPS: usize = 20;

/// Puts patches where their surroundings carry them.
pub(super) struct Carrier<'a> {
    triangulation: &'a Triangulation,
    rest: &'a Positions,
}

impl<'a> Carrier<'a> {
    pub(super) fn new(triangulation: &'a Triangulation, rest: &'a Positions) -> Self {
        Self {
            triangulation,
            rest,
        }
    }

    /// Gives the vertices of `free`, ascending, the shape that they have at rest, scaled as their rim is and bent as little as
    /// all others allow: `min Σ |eᵢⱼ − s Rᵢ rᵢⱼ|² / |rᵢⱼ|` over the edges of the patch, with the scale s of the rim, by
    /// alternating steps from the rest shape moved as the rim (Sorkine and Alexa 2007). Whether that is determined;
    /// nothing moves where it is not.
    pub(super) fn carry(&self, x: &mut Positions, free: &[VertexId]) -> bool {
        let pieces = self.pieces(free);
        let Some(parts) = pieces
            .iter()
            .map(|piece| Part::new(self, piece, x))
            .collect::<Option<Vec<Part>>>()
        else {
            return false;
        };
        for part in &parts {
            part.carry(self, x);
        }
        free.iter()
            .all(|&v| x[v].coords.iter().all(|c| c.is_finite()))
    }

    /// The connected pieces of a patch, each ascending.
    fn pieces(&self, free: &[VertexId]) -> Vec<Vec<VertexId>> {
        let mut sets = UnionFind::new(free.len());
        for (row, &v) in free.iter().enumerate() {
            for w in self.triangulation.vertex_neighbours(v) {
                if let Ok(other) = free.binary_search(w) {
                    sets.union(row, other);
                }
            }
        }
        let rows = sets.sets(|_| true).into_iter();
        rows.map(|rows| rows.into_iter().map(|row| free[row]).collect())
            .collect()
    }

    fn edge_at_rest(&self, v: VertexId, w: VertexId) -> Vector3 {
        self.rest[w] - self.rest[v]
    }

    fn weight(&self, v: VertexId, w: VertexId) -> f64 {
        1.0 / self.edge_at_rest(v, w).norm().max(1e-12)
    }

    /// The turn that carries the edges at a vertex best to where they are.
    fn turn(&self, v: VertexId, x: &Positions) -> Matrix3<f64> {
        let mut covariance = Matrix3::zeros();
        for &w in self.triangulation.vertex_neighbours(v) {
            covariance += (x[w] - x[v]) * self.weight(v, w) * self.edge_at_rest(v, w).transpose();
        }
        nearest_rotation(&covariance)
    }
}

/// A connected piece of a patch.
struct Part<'p> {
    free: &'p [VertexId],
    similarity: Similarity,
    solver: SpdSolver,
}

impl<'p> Part<'p> {
    fn new(carrier: &Carrier<'_>, free: &'p [VertexId], x: &Positions) -> Option<Self> {
        let mut rim = grown(carrier.triangulation, free, RIM);
        rim.retain(|v| free.binary_search(v).is_err());
        if rim.len() < 3 {
            return None;
        }
        let mut matrix = CooMatrix::new(free.len(), free.len());
        for (row, &v) in free.iter().enumerate() {
            for &w in carrier.triangulation.vertex_neighbours(v) {
                let weight = carrier.weight(v, w);
                matrix.push(row, row, weight);
                if let Ok(other) = free.binary_search(&w) {
                    matrix.push(row, other, -weight);
                }
            }
        }
        Some(Self {
            similarity: Similarity::of(&rim, carrier.rest, x),
            solver: SpdSolver::new(&CsrMatrix::from(&matrix)).ok()?,
            free,
        })
    }

    fn carry(&self, carrier: &Carrier<'_>, x: &mut Positions) {
        let similarity = &self.similarity;
        for &v in self.free {
            x[v] = similarity.apply(carrier.rest[v]);
        }
        for _ in 0..STEPS {
            let around = grown(carrier.triangulation, self.free, 1);
            let turns: Vec<_> = around.iter().map(|&v| carrier.turn(v, x)).collect();
            let turn = |v: &VertexId| {
                around
                    .binary_search(v)
                    .map_or(similarity.rotation, |row| turns[row])
            };
            let pull = |&v: &VertexId| {
                let mut sum = Vector3::zeros();
                for w in carrier.triangulation.vertex_neighbours(v) {
                    let edge = carrier.edge_at_rest(v, *w) * similarity.scale;
                    let carried = (turn(&v) + turn(w)) * edge * 0.5;
                    let from = if self.free.binary_search(w).is_ok() {
                        Vector3::zeros()
                    } else {
                        x[*w].coords
                    };
                    sum += (from - carried) * carrier.weight(v, *w);
                }
                sum
            };
            let pulls: Vec<Vector3> = self.free.iter().map(pull).collect();
            let places = self.solver.solve(&pulls);
            for (&v, place) in self.free.iter().zip(places) {
                x[v] = place.into();
            }
        }
    }
}

/// Turns, scales and moves.
struct Similarity {
    rotation: Matrix3<f64>,
    scale: f64,
    from: Vector3,
    to: Vector3,
}

impl Similarity {
    /// What brings `rest` nearest to where these vertices are at `x`.
    fn of(vertices: &[VertexId], rest: &Positions, x: &Positions) -> Self {
        let n = vertices.len() as f64;
        let middle = |x: &Positions| vertices.iter().map(|&v| x[v].coords).sum::<Vector3>() / n;
        let (from, to) = (middle(rest), middle(x));
        let (mut covariance, mut spread) = (Matrix3::zeros(), 0.0);
        for &v in vertices {
            let (p, q) = (rest[v].coords - from, x[v].coords - to);
            covariance += q * p.transpose();
            spread += p.norm_squared();
        }
        let rotation = nearest_rotation(&covariance);
        Self {
            scale: rotation.dot(&covariance) / spread.max(f64::MIN_POSITIVE),
            rotation,
            from,
            to,
        }
    }

    fn apply(&self, p: mesh_core::Point3) -> mesh_core::Point3 {
        (self.to + self.rotation * (p.coords - self.from) * self.scale).into()
    }
}
