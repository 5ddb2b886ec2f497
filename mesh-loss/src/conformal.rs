//! Angle distortion as the Dirichlet energy sees it, with a barrier against collapsing faces.

use std::sync::Arc;

use mesh_core::{Point3, Positions, Triangulation, Vector3, VertexData};

use crate::gradient::area_gradient;
use crate::Loss;

/// Mean angle distortion of the faces, weighted by their area at rest (MIPS).
///
/// `Σ_f a_f (½ ‖dφ_f‖² / det dφ_f − 1) / Σ_f a_f = Σ_f a_f (½ (σ₁/σ₂ + σ₂/σ₁) − 1) / Σ_f a_f`
///
/// Units: none; ≥ 0, and 0 exactly where every face is a scaled copy of itself at rest. It grows without bound as a
/// face collapses, up to a collapse of 10⁻⁶ where the gradient stops. Faces degenerate at rest add nothing.
/// Source: beyond the paper (Hormann and Greiner 2000), the integrand of Eq. 6 over the face's own area. Off in
/// `paper`.
pub struct Conformal {
    triangulation: Arc<Triangulation>,
    faces: Vec<RestFace>,
}

/// What the energy needs of a face at rest.
struct RestFace {
    /// Cotangents of the corner angles.
    cotangents: [f64; 3],
    /// Its share in the area of the mesh; 0 when degenerate.
    share: f64,
}

/// Faces that shrink by more than this against the length of their sides count as this thin.
const THINNEST: f64 = 1e-6;

impl Conformal {
    /// The energy against the shape `rest`.
    pub fn new(triangulation: &Arc<Triangulation>, rest: &Positions) -> Self {
        let total: f64 = mesh_core::measure::triangle_areas(triangulation, rest)
            .iter()
            .sum();
        Self {
            triangulation: Arc::clone(triangulation),
            faces: triangulation
                .corners(rest)
                .map(|corners| rest_face(corners, total))
                .collect(),
        }
    }
}

fn rest_face([a, b, c]: [Point3; 3], total: f64) -> RestFace {
    let sides = [c - b, a - c, b - a];
    let doubled = sides[0].cross(&sides[1]).norm();
    let longest = sides.iter().map(Vector3::norm_squared).fold(0.0, f64::max);
    if doubled <= THINNEST * longest || total <= 0.0 {
        return RestFace {
            cotangents: [0.0; 3],
            share: 0.0,
        };
    }
    let cotangent = |k: usize| -sides[(k + 1) % 3].dot(&sides[(k + 2) % 3]) / doubled;
    RestFace {
        cotangents: [cotangent(0), cotangent(1), cotangent(2)],
        share: 0.5 * doubled / total,
    }
}

impl Loss for Conformal {
    fn accumulate(&self, x: &Positions, weight: f64, grad: &mut VertexData<Vector3>) -> f64 {
        let mut sum = 0.0;
        for (t, face) in self.triangulation.triangles().iter().zip(&self.faces) {
            if face.share == 0.0 {
                continue;
            }
            let [a, b, c] = t.map(|v| x[v]);
            let sides = [c - b, a - c, b - a];
            let pull = [0, 1, 2].map(|k| sides[k] * (0.5 * face.cotangents[k]));
            // Dirichlet energy of the face: ¼ Σ cot αₖ |eₖ|².
            let energy: f64 = (0..3).map(|k| 0.5 * pull[k].dot(&sides[k])).sum();
            let Some(area) = area_gradient([a, b, c]).filter(|g| g.area > THINNEST * energy) else {
                sum += face.share / THINNEST;
                continue;
            };
            let ratio = energy / area.area;
            sum += face.share * (ratio - 1.0);

            let scale = weight * face.share / area.area;
            // ∂E/∂a = ½ (cot β (a − c) + cot γ (a − b)), and cyclically.
            let by_energy = [pull[1] - pull[2], pull[2] - pull[0], pull[0] - pull[1]];
            for k in 0..3 {
                grad[t[k]] += (by_energy[k] - area.corners[k] * ratio) * scale;
            }
        }
        sum
    }
}
