//! What a drape came to.

use std::path::Path;

use mesh_core::{Positions, UnitFrame, VertexData};
use mesh_metrics::{Counterparts, Report};
use neural_drape::network::NetworkMap;
use neural_drape::Warp;

use crate::explain::explain;
use crate::{Error, Explanation, History, Note, Pair, Preset, Stages};

/// A draped source with its report.
pub struct Outcome {
    /// Source, target and landmarks.
    pub pair: Pair,
    /// The settings.
    pub preset: Preset,
    /// The source brought to its landmarks, in the target's coordinates; one position per vertex of the source.
    pub by_landmarks: Positions,
    /// Where the drape started, likewise: there, or in the best of several starts.
    pub initial: Positions,
    /// The result, likewise.
    pub draped: Positions,
    /// Every measure of the result.
    pub report: Report,
    /// Where it is worst and why, and how near it is part by part.
    pub explanation: Explanation,
    /// The terms of the loss over the run.
    pub history: History,
    /// What was assumed, left out and repaired.
    pub notes: Vec<Note>,
    /// What each stage took, as far as it was measured.
    pub stages: Stages,
    /// The network behind the result; none where there is none, or where it alone did not come to the result.
    pub network: Option<NetworkMap>,
}

impl Outcome {
    /// A result that came about elsewhere, judged.
    ///
    /// # Errors
    /// Positions of another mesh, or a coordinate that is not finite.
    pub fn of_shapes(
        pair: Pair,
        preset: Preset,
        initial: Positions,
        draped: Positions,
    ) -> Result<Self, Error> {
        let report = pair.judge(&draped, None)?;
        let counterparts = Counterparts::all(draped.len());
        Ok(Self {
            explanation: explain(&pair, &draped, &report, &counterparts),
            pair,
            preset,
            by_landmarks: initial.clone(),
            initial,
            draped,
            report,
            history: History::default(),
            notes: Vec::new(),
            stages: Stages::off(),
            network: None,
        })
    }

    /// The share of a shape's area that lies beyond the other and was left out, 0..=1: the larger of both shapes'.
    pub fn left_out(&self) -> f64 {
        let shares = self.notes.iter().filter_map(|note| match note {
            Note::LeftOut { share, .. } => Some(*share),
            _ => None,
        });
        shares.fold(0.0, f64::max)
    }

    /// Writes the source's file with its vertices at the result: in its own format nothing else changes.
    ///
    /// # Errors
    /// An extension whose format is not written, or a file that cannot be written.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        Ok(self.pair.source.write(path, &self.draped)?)
    }

    /// What the drape did to space, to do it to other points.
    ///
    /// # Errors
    /// The map cannot be made of these shapes.
    pub fn warp(&self) -> Result<Warp, Error> {
        let network = self.network.clone();
        self.pair.warp(&self.initial, &self.draped, network)
    }

    /// Distance of each vertex from another place, in longest sides of the target's box.
    pub fn distances_from(&self, truth: &Positions) -> VertexData<f64> {
        let scale = UnitFrame::of(self.pair.target.judged().bounds()).scale;
        let pairs = self.draped.iter().zip(truth.iter());
        pairs.map(|(a, b)| (a - b).norm() / scale).collect()
    }
}
