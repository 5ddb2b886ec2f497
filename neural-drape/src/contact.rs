//! The surface is kept from running through itself while it is draped.

use std::sync::Arc;

use mesh_core::{Positions, Triangulation, VertexId};
use mesh_loss::{Contact, ContactPair, ContactSearch};
use serde::{Deserialize, Serialize};

use crate::{DrapeError, StateReader, StateWriter};

/// So many iterations pairs are held before they are sought again.
const PERIOD: usize = 20;
/// Pairs nearer than this are looked at, in longest sides: no two come farther towards each other in a period.
const REACH: f64 = 0.015;

/// How parts of the surface that are near in space and far along it are kept apart ([`Contact`]).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContactConfig {
    /// The share of the run after which the coarse fit stands, 0..=1: from then on it counts.
    pub from: f64,
    /// Its weight, ≥ 0.
    pub weight: f64,
    /// How far apart, in longest sides of the target, ≥ 0.
    pub gap: f64,
}

impl ContactConfig {
    /// When landmarks and structure have led: stronger than the pull of the target on either side, over a gap that fits
    /// into its crevices.
    pub const fn standard() -> Self {
        Self {
            from: 0.33,
            weight: 400.0,
            gap: 0.002,
        }
    }
}

/// The pairs of a drape.
pub(crate) struct Apart {
    config: ContactConfig,
    search: ContactSearch,
    contact: Contact,
}

impl Apart {
    pub(crate) fn new(
        config: ContactConfig,
        triangulation: &Arc<Triangulation>,
        rest: &Arc<Positions>,
    ) -> Self {
        Self {
            config,
            search: ContactSearch::new(triangulation, rest),
            contact: Contact::default(),
        }
    }

    /// Seeks the pairs at `x` anew, where it is time for it.
    pub(crate) fn update(&mut self, iteration: usize, n_iterations: usize, x: &Positions) {
        let first = (self.config.from * n_iterations as f64) as usize;
        if iteration >= first && (iteration - first).is_multiple_of(PERIOD) {
            self.contact = self.search.near(x, self.config.gap, REACH);
        }
    }

    /// The term, with its weight.
    pub(crate) fn term(&self) -> (&'static str, f64, &dyn mesh_loss::Loss) {
        ("contact", self.config.weight, &self.contact)
    }

    /// Writes the pairs.
    pub(crate) fn save(&self, state: &mut StateWriter) {
        let pairs = &self.contact.pairs;
        let rows = |pair: &ContactPair| {
            let [a, b, c] = pair.triangle;
            [pair.vertex, a, b, c].map(VertexId::index)
        };
        state.counts(&pairs.iter().flat_map(rows).collect::<Vec<_>>());
        for pair in pairs {
            state.real(pair.side);
            state.real(pair.gap);
            state.real(pair.share);
        }
    }

    /// Takes what [`Self::save`] wrote, of a surface of so many vertices.
    pub(crate) fn restore(
        &mut self,
        n_vertices: usize,
        state: &mut StateReader<'_>,
    ) -> Result<(), DrapeError> {
        let rows = state.counts()?;
        if rows.iter().any(|&row| row >= n_vertices) || rows.len() % 4 != 0 {
            return Err(DrapeError::ForeignState);
        }
        let of_rows = |rows: &[usize]| -> Result<ContactPair, DrapeError> {
            Ok(ContactPair {
                vertex: VertexId::new(rows[0]),
                triangle: [1, 2, 3].map(|k| VertexId::new(rows[k])),
                side: state.real()?,
                gap: state.real()?,
                share: state.real()?,
            })
        };
        let pairs = rows.chunks_exact(4).map(of_rows);
        self.contact = Contact {
            pairs: pairs.collect::<Result<_, _>>()?,
        };
        Ok(())
    }
}
