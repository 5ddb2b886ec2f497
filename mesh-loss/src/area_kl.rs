//! Eq. 3, second term: the areas around each vertex keep their proportions.

use std::sync::Arc;

use mesh_core::measure::triangle_areas;
use mesh_core::{Positions, Triangulation, Vector3, VertexData};

use crate::gradient::area_gradient;
use crate::Loss;

/// Areas below this share of the mean area count as this share: keeps the logarithm finite.
const SMALLEST_AREA: f64 = 1e-9;

/// Kullback–Leibler divergence of the local area distributions, mean over vertices.
///
/// `1/N Σᵢ Σ over faces f at i of p log(p / q)`, with `p = a_f / Σ a` at rest and `q = â_f / Σ â` now
///
/// Units: none; ≥ 0; 0 where every one-ring keeps its proportions. A triangle without area counts as 1e-9 of the
/// mean area and has no gradient.
/// Source: Mesh Draping, Eq. 3. Departures: the faces are the triangles of the fixed triangulation.
pub struct AreaKl {
    triangulation: Arc<Triangulation>,
    /// p of each corner of each triangle, around the vertex at that corner.
    shares: Vec<[f64; 3]>,
    /// Σᵢ Σ p log p.
    entropy: f64,
}

impl AreaKl {
    /// The term that keeps the proportions of `rest`.
    pub fn new(triangulation: &Arc<Triangulation>, rest: &Positions) -> Self {
        let areas = floored(triangle_areas(triangulation, rest));
        let around = areas_around(triangulation, &areas, rest.len());
        let shares: Vec<[f64; 3]> = triangulation
            .triangles()
            .iter()
            .zip(&areas)
            .map(|(t, a)| t.map(|v| a / around[v]))
            .collect();
        let entropy = shares.iter().flatten().map(|p| p * p.ln()).sum();
        Self {
            triangulation: Arc::clone(triangulation),
            shares,
            entropy,
        }
    }
}

impl Loss for AreaKl {
    fn accumulate(&self, x: &Positions, weight: f64, grad: &mut VertexData<Vector3>) -> f64 {
        let share = 1.0 / x.len().max(1) as f64;
        let areas = floored(triangle_areas(&self.triangulation, x));
        let around = areas_around(&self.triangulation, &areas, x.len());
        let inverse = around.map(|a| 1.0 / a);
        let logarithm = around.map(|a| a.ln());

        let mut sum = self.entropy;
        for ((t, p), &area) in self
            .triangulation
            .triangles()
            .iter()
            .zip(&self.shares)
            .zip(&areas)
        {
            let total: f64 = p.iter().sum();
            sum -= total * area.ln();
            // ∂/∂â_f of −p log â_f + p log Σ â, summed over the three one-rings that hold f.
            let mut by_area = -total / area;
            for (&v, p) in t.iter().zip(p) {
                sum += p * logarithm[v];
                by_area += inverse[v];
            }
            if let Some(a) = area_gradient(t.map(|v| x[v])).filter(|a| a.area >= area) {
                for (&v, g) in t.iter().zip(a.corners) {
                    grad[v] += g * (weight * share * by_area);
                }
            }
        }
        sum * share
    }
}

fn floored(mut areas: Vec<f64>) -> Vec<f64> {
    let mean = areas.iter().sum::<f64>() / areas.len().max(1) as f64;
    let floor = (mean * SMALLEST_AREA).max(f64::MIN_POSITIVE);
    areas.iter_mut().for_each(|a| *a = a.max(floor));
    areas
}

fn areas_around(triangulation: &Triangulation, areas: &[f64], n: usize) -> VertexData<f64> {
    let mut around = VertexData::new(n, 0.0);
    for (t, a) in triangulation.triangles().iter().zip(areas) {
        for &v in t {
            around[v] += a;
        }
    }
    around
}
