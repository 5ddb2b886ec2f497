//! The creatures of a study: coarse ones, so that it ends.

use std::path::Path;

use mesh_creatures::{CreaturePair, Dial, Individual, PairConfig, Plan};

use super::Study;
use crate::creatures;
use crate::suite::{Manifest, Pair};

/// Vertices of a target.
const N_TARGET_VERTICES: usize = 3000;
/// Largest ratio of lengths.
const RATIO: f64 = 1.75;

/// A pair of a study.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Setting {
    pub(super) plan: Plan,
    /// The largest turn of a joint, in degrees.
    pub(super) angle: f64,
    pub(super) n_landmarks: usize,
    /// Which individual.
    pub(super) individual: u64,
}

impl Setting {
    pub(super) fn name(&self) -> String {
        let Self {
            plan,
            angle,
            n_landmarks,
            individual,
        } = self;
        format!("{plan}-{angle}-{n_landmarks}-coarse-{individual}")
    }

    /// The template of the plan, coarse, and an individual of the dial.
    fn pair(&self) -> CreaturePair {
        let dial = Dial {
            angle: self.angle,
            ratio: RATIO,
        };
        let target = Individual::drawn(self.plan, self.individual, dial);
        let config = PairConfig {
            n_splits: 0,
            n_target_vertices: N_TARGET_VERTICES,
            n_landmarks: self.n_landmarks,
            seed: self.individual,
            ..PairConfig::standard()
        };
        CreaturePair::new(&Individual::template(self.plan), &target, &config)
    }
}

/// The pairs that a study is made on where none are given.
pub(super) fn settings(study: Study) -> Vec<Setting> {
    let setting = |plan, angle, n_landmarks, individual| Setting {
        plan,
        angle,
        n_landmarks,
        individual,
    };
    match study {
        Study::Paper => vec![
            setting(Plan::Quadruped, 60.0, 12, 0),
            setting(Plan::Bird, 60.0, 12, 0),
        ],
        Study::Encoding => [5, 16]
            .into_iter()
            .flat_map(|n| {
                [30.0, 60.0, 90.0, 120.0].map(|angle| setting(Plan::Quadruped, angle, n, 0))
            })
            .collect(),
    }
}

/// The creatures of a study, their files in `folder`.
pub(super) fn creatures(study: Study, folder: &Path) -> anyhow::Result<Manifest> {
    let pair = |setting: &Setting| -> anyhow::Result<Pair> {
        let name = setting.name();
        let files = creatures::write(&folder.join(&name), &setting.pair())?;
        Ok(Pair {
            name,
            source: files.source,
            target: files.target,
            landmarks: files.landmarks,
            truth: Some(files.truth),
            judge: files.surface,
        })
    };
    let pairs = settings(study).iter().map(pair).collect::<Result<_, _>>()?;
    Manifest::of_pairs(&[], "Creatures", pairs)
}
