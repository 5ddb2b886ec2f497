//! Which place of the target each place of the source belongs to, and how sure that is.

use mesh_core::measure::vertex_normals;
use mesh_core::{Point3, Positions, Triangulation, Vector3, VertexData};
use rayon::prelude::*;

use super::graph::SampleGraph;
use super::signature::Misfits;

/// Pairs whose way back ends this far from where it began, in longest sides, count 1/e.
const MUTUAL: f64 = 0.05;
/// Pairs that count less than this are none.
const LEAST_CONFIDENCE: f64 = 1e-6;
/// Vertices whose pairs are looked for together: a fixed number, so that the result is the same on any machine.
const CHUNK: usize = 64;

/// What the parts of the cost of a pair count for: squared distance in space and along the surfaces, in squared longest
/// sides, and `1 − n·n′`.
#[derive(Clone, Copy, Debug)]
pub(super) struct PairCost {
    pub(super) space: f32,
    pub(super) signature: f32,
    pub(super) normal: f32,
}

/// The best pair seen so far: row and cost.
type Best = (usize, f32);

const NONE_YET: Best = (0, f32::INFINITY);

/// Both shapes as they are now.
pub(super) struct Shapes<'a> {
    pub(super) triangulation: &'a Triangulation,
    /// The source before it deforms: how far a way back misses is measured on it.
    pub(super) rest: &'a Positions,
    pub(super) x: &'a Positions,
    pub(super) graph: &'a SampleGraph,
    pub(super) misfits: &'a Misfits,
    pub(super) size: f64,
}

impl Shapes<'_> {
    /// Of each vertex the sample it belongs to and a confidence in 0..=1: how near the sample's own best vertex is to it.
    /// None where that is as good as nothing.
    pub(super) fn counterparts(&self, cost: PairCost) -> Vec<Option<(Point3, f64)>> {
        let (there, back) = self.best(cost);
        let rest = self.rest.as_slice();
        let counterpart = |(v, &(t, _)): (usize, &Best)| {
            let gap = (rest[back.get(t)?.0] - rest[v]).norm() / self.size;
            let confidence = (-(gap / MUTUAL).powi(2)).exp();
            (confidence > LEAST_CONFIDENCE).then(|| (self.graph.points[t], confidence))
        };
        there.iter().enumerate().map(counterpart).collect()
    }

    /// The best sample for each vertex and the best vertex for each sample.
    fn best(&self, cost: PairCost) -> (Vec<Best>, Vec<Best>) {
        let flat = |p: &Vector3| [p.x as f32, p.y as f32, p.z as f32];
        let unit = |p: &Point3| flat(&(p.coords / self.size));
        let normals: VertexData<Vector3> = vertex_normals(self.triangulation, self.x);
        let vertices: Vec<Place> = self
            .x
            .iter()
            .zip(&normals)
            .map(|(p, n)| (unit(p), flat(n)))
            .collect();
        let samples = self.graph.points.iter().zip(&self.graph.normals);
        let samples: Vec<Place> = samples.map(|(p, n)| (unit(p), flat(n))).collect();
        let is_used: Vec<bool> = self
            .x
            .ids()
            .map(|v| self.triangulation.is_used(v))
            .collect();
        let is_oriented = self.graph.is_oriented;
        let search = |first: usize| {
            let mut there = Vec::with_capacity(CHUNK);
            let mut back = vec![NONE_YET; samples.len()];
            for v in first..(first + CHUNK).min(vertices.len()) {
                let mut best = NONE_YET;
                let misfits = self.misfits.of(v).iter();
                for (t, ((sample, misfit), back)) in
                    samples.iter().zip(misfits).zip(&mut back).enumerate()
                {
                    let total = cost.of(&vertices[v], sample, *misfit, is_oriented);
                    if total < best.1 {
                        best = (t, total);
                    }
                    if total < back.1 && is_used[v] {
                        *back = (v, total);
                    }
                }
                there.push(best);
            }
            (there, back)
        };
        let firsts: Vec<usize> = (0..vertices.len()).step_by(CHUNK).collect();
        let parts: Vec<_> = firsts.into_par_iter().map(search).collect();
        let mut back = vec![NONE_YET; samples.len()];
        for (_, part) in &parts {
            for (best, other) in back.iter_mut().zip(part) {
                if other.1 < best.1 {
                    *best = *other;
                }
            }
        }
        (
            parts.into_iter().flat_map(|(there, _)| there).collect(),
            back,
        )
    }
}

/// Position in longest sides, and normal.
type Place = ([f32; 3], [f32; 3]);

impl PairCost {
    fn of(self, (p, n): &Place, (q, m): &Place, misfit: f32, is_oriented: bool) -> f32 {
        let d = [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
        let dot = |a: &[f32; 3], b: &[f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let cosine = dot(n, m);
        let cosine = if is_oriented { cosine } else { cosine.abs() };
        self.space * dot(&d, &d) + self.normal * (1.0 - cosine) + self.signature * misfit
    }
}
