//! Steps that do not drive the surface through itself.

use serde::{Deserialize, Serialize};

use mesh_core::{Positions, Triangulation, Vector3, VertexData, VertexId};

use crate::untangle::{Detector, Ground};
use crate::{DrapeError, StateReader, StateWriter};

/// So many iterations the triangles that are near others are looked at before they are sought again.
pub(crate) const PERIOD: usize = 10;
/// Triangles nearer than this are looked at, in longest sides: no two come farther towards each other in a period.
const REACH: f64 = 0.008;
/// So often vertices of triangles that would cross stay behind, before what is left is left to the last stage.
const STAYS: usize = 8;

/// How parts of the surface that are near in space and far along it are kept apart.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContactConfig {
    /// The share of the run after which the coarse fit stands, 0..=1: what crosses then is taken out.
    pub part_at: f64,
    /// The share of the run, 0..=1, from which no step drives the surface through itself; what crosses then is taken out
    /// first. Before, steps are long beside the triangles, and vertices that are held back would stay behind for good.
    pub guard_from: f64,
}

impl ContactConfig {
    /// When landmarks and structure have led; no step is held back, which costs more of the fit than it keeps from crossing.
    pub const fn standard() -> Self {
        Self {
            part_at: 0.35,
            guard_from: 1.0,
        }
    }
}

/// Keeps steps from driving a surface through itself, where it did not at rest.
///
/// After a step, the vertices of triangles that cross and did not before it go back to where they were before it, until
/// nothing crosses that did not. Source: the filtered steps of Li et al. 2020, "Incremental Potential Contact". Departures:
/// vertices are held back one by one instead of the step as a whole; crossings are looked for where a step ends, not on
/// the way, as steps are short beside triangles.
#[derive(Clone, Debug)]
pub(crate) struct Guard {
    detector: Detector,
    /// What crosses already and is let be.
    known: Vec<[u32; 2]>,
}

impl Guard {
    /// Looks at what is near others at `x`.
    pub(crate) fn new(ground: Ground<'_>, x: &Positions) -> Self {
        let all = Detector::new(ground, x);
        Self::of(ground, x, all.close(ground, x, REACH))
    }

    /// Looks at these triangles, ascending.
    fn of(ground: Ground<'_>, x: &Positions, rows: Vec<u32>) -> Self {
        let mut detector = Detector::of(ground, x, rows);
        Self {
            known: detector.all_crossings(ground, x),
            detector,
        }
    }

    /// Writes what is looked at.
    pub(crate) fn save(&self, state: &mut StateWriter) {
        let rows: Vec<usize> = self.detector.rows().iter().map(|&t| t as usize).collect();
        let known = self.known.as_flattened().iter();
        let known: Vec<usize> = known.map(|&t| t as usize).collect();
        state.counts(&rows);
        state.counts(&known);
    }

    /// What [`Self::save`] wrote; `x` is where the vertices are.
    pub(crate) fn restore(
        ground: Ground<'_>,
        x: &Positions,
        state: &mut StateReader<'_>,
    ) -> Result<Self, DrapeError> {
        let (rows, known) = (state.counts()?, state.counts()?);
        let n = ground.triangulation.len();
        if rows.iter().chain(&known).any(|&row| row >= n) || known.len() % 2 != 0 {
            return Err(DrapeError::ForeignState);
        }
        let rows = rows.into_iter().map(|row| row as u32).collect();
        let pairs = known.chunks_exact(2);
        Ok(Self {
            detector: Detector::of(ground, x, rows),
            known: pairs.map(|p| [p[0] as u32, p[1] as u32]).collect(),
        })
    }

    /// By what vertices must move after a step from `before` to `after`, so that nothing crosses that did not; none where
    /// nothing must.
    pub(crate) fn held_back(
        &mut self,
        ground: Ground<'_>,
        before: &Positions,
        after: &Positions,
    ) -> Option<VertexData<Vector3>> {
        let mut x = after.clone();
        let mut is_any = false;
        for _ in 0..STAYS {
            let crossing = self.detector.all_crossings(ground, &x);
            let new = crossing
                .iter()
                .filter(|p| self.known.binary_search(p).is_err());
            let stay: Vec<VertexId> = new
                .flatten()
                .flat_map(|&t| ground.triangulation.triangles()[t as usize])
                .filter(|&v| x[v] != before[v])
                .collect();
            if stay.is_empty() {
                break;
            }
            is_any = true;
            stay.into_iter().for_each(|v| x[v] = before[v]);
        }
        is_any.then(|| x.iter().zip(after).map(|(a, b)| a - b).collect())
    }
}

/// A surface and its shape at rest.
pub(crate) fn ground<'a>(triangulation: &'a Triangulation, rest: &'a Positions) -> Ground<'a> {
    Ground {
        triangulation,
        rest,
    }
}
