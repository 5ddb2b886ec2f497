//! What was done to a drape, and when: enough to do it again.

use serde::{Deserialize, Serialize};

use super::mark::Mark;
use mesh_draping::{Parts, Stroke};

/// A drape from its start to where it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RunLog {
    /// The settings that it started with, as TOML.
    pub(crate) settings: String,
    /// The parts of the source that it started to treat in their own way.
    #[serde(default)]
    pub(crate) parts: Parts,
    /// The landmarks that it started with.
    pub(crate) landmarks: Vec<Mark>,
    /// What changed on the way, in order.
    pub(crate) events: Vec<Event>,
    /// How many iterations are done.
    pub(crate) iteration: usize,
}

/// Something that happened before an iteration.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Event {
    /// How many iterations were done.
    pub(crate) iteration: usize,
    pub(crate) change: Change,
}

/// What happened.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Change {
    /// These landmarks hold from here on.
    Landmarks(Vec<Mark>),
    /// Parts of the source are treated in these ways from here on.
    Parts(Parts),
    /// The shape was brushed.
    Brushed(Stroke),
    /// The newest stroke that still held was taken back.
    Unbrushed,
    /// The run got this many iterations more.
    Extended(usize),
    /// The drape was put together again from its saved state.
    Rebuilt,
}

impl RunLog {
    /// The landmarks that hold at the end.
    pub(crate) fn last_landmarks(&self) -> &[Mark] {
        let last = self.changed_landmarks().last();
        last.unwrap_or(&self.landmarks)
    }

    /// The landmarks of every change, in order.
    pub(super) fn changed_landmarks(&self) -> impl Iterator<Item = &Vec<Mark>> {
        self.events.iter().filter_map(|event| match &event.change {
            Change::Landmarks(marks) => Some(marks),
            _ => None,
        })
    }

    /// The strokes that hold at the end.
    pub(crate) fn strokes(&self) -> Vec<&Stroke> {
        let mut strokes = Vec::new();
        for event in &self.events {
            match &event.change {
                Change::Brushed(stroke) => strokes.push(stroke),
                Change::Unbrushed => drop(strokes.pop()),
                _ => {}
            }
        }
        strokes
    }

    /// The ways of treating parts that hold at the end.
    pub(crate) fn last_parts(&self) -> &Parts {
        let mut changes = self.events.iter().rev();
        let last = changes.find_map(|event| match &event.change {
            Change::Parts(parts) => Some(parts),
            _ => None,
        });
        last.unwrap_or(&self.parts)
    }
}
