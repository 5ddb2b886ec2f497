//! A patch as it was at rest, carried by what is around it.

use mesh_core::{nearest_rotation, Positions, Triangulation, Vector3, VertexId};
use mesh_operators::{
    bilaplacian, cotan_laplacian, voronoi_mass, CsrMatrix, FixedSolve, FixedSolveScratch,
};
use nalgebra::Matrix3;

use crate::repair::grown;

/// So many rings around a patch say how it is turned and scaled.
const RIM: usize = 2;

/// Puts patches where their surroundings carry them.
pub(super) struct Carrier<'a> {
    triangulation: &'a Triangulation,
    rest: &'a Positions,
    energy: CsrMatrix<f64>,
}

impl<'a> Carrier<'a> {
    pub(super) fn new(triangulation: &'a Triangulation, rest: &'a Positions) -> Self {
        let mass = voronoi_mass(triangulation, rest);
        Self {
            energy: bilaplacian(&cotan_laplacian(triangulation, rest), &mass),
            triangulation,
            rest,
        }
    }

    /// Gives the vertices of `free`, ascending, the shape that they have at rest, turned, scaled and moved as their rim is, and
    /// displaced as smoothly as all others allow: `min Σ |Δ(x − S rest)|²` with the similarity S of the rim. Whether that is
    /// determined; nothing moves where it is not.
    pub(super) fn carry(&self, x: &mut Positions, free: &[VertexId]) -> bool {
        let is_free = |v: &VertexId| free.binary_search(v).is_ok();
        let mut rim = grown(self.triangulation, free, RIM);
        rim.retain(|v| !is_free(v));
        if rim.len() < 3 {
            return false;
        }
        let held: Vec<VertexId> = x.ids().filter(|v| !is_free(v)).collect();
        let Ok(solve) = FixedSolve::new(&self.energy, &held) else {
            return false;
        };
        let carried = similar(&rim, self.rest, x);
        let mut moves: Vec<Vector3> = x.iter().zip(&carried).map(|(a, b)| a - b).collect();
        solve.solve_in_place(&mut moves, &mut FixedSolveScratch::default());
        for &v in free {
            x[v] = carried[v] + moves[v.index()];
        }
        free.iter()
            .all(|&v| x[v].coords.iter().all(|c| c.is_finite()))
    }
}

/// `rest` turned, scaled and moved so that these vertices come nearest to where they are at `x`.
fn similar(vertices: &[VertexId], rest: &Positions, x: &Positions) -> Positions {
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
    let scale = rotation.dot(&covariance) / spread.max(f64::MIN_POSITIVE);
    rest.map(|p| (to + rotation * (p.coords - from) * scale).into())
}
