//! The creatures of a study: coarse ones where much is compared.

use std::path::Path;

use mesh_creatures::{CreaturePair, Dial, Individual, PairConfig, Plan, Variant};

use super::Study;
use crate::creatures::{self, Case, Grid};
use crate::suite::{Manifest, Pair};

/// Vertices of a target.
const N_TARGET_VERTICES: usize = 3000;
/// Largest ratio of lengths.
const RATIO: f64 = 1.75;
/// Where the dial stands, one thing turned at a time from its middle: largest turn of a joint in degrees, largest ratio of
/// lengths, landmarks.
const DIAL: [(f64, f64, usize); 8] = [
    (30.0, RATIO, 16),
    (60.0, RATIO, 16),
    (90.0, RATIO, 16),
    (120.0, RATIO, 16),
    (60.0, 1.0, 16),
    (60.0, 3.0, 16),
    (60.0, RATIO, 5),
    (60.0, RATIO, 0),
];

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

/// The coarse pairs that a study is made on where none are given; none of those on creatures in full.
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
        Study::Network | Study::Dial => Vec::new(),
    }
}

/// Creatures in full, by where the dial stands: each row with its pairs, one of every kind.
pub(super) fn rows_of_cases(study: Study) -> Vec<Vec<Case>> {
    let row = |(angle, ratio, n_landmarks): (f64, f64, usize)| {
        let grid = Grid {
            plans: Plan::ALL.to_vec(),
            angles: vec![angle],
            ratios: vec![ratio],
            n_landmarks: vec![n_landmarks],
            variants: vec![Variant::Mesh],
            seeds: vec![0],
            without: Vec::new(),
        };
        grid.cases()
    };
    match study {
        Study::Paper | Study::Encoding => Vec::new(),
        Study::Network => vec![row((120.0, RATIO, 8))],
        Study::Dial => DIAL.map(row).to_vec(),
    }
}

/// The creatures of a study, their files in `folder`.
pub(super) fn creatures(study: Study, folder: &Path) -> anyhow::Result<Manifest> {
    let coarse = settings(study).into_iter();
    let coarse = coarse.map(|setting| written(setting.name(), &setting.pair(), folder));
    let cases = rows_of_cases(study).into_iter().flatten();
    let cases = cases.map(|case| written(case.name(), &case.pair(&[]), folder));
    let pairs = coarse.chain(cases).collect::<Result<_, _>>()?;
    Manifest::of_pairs(&[], "Creatures", pairs)
}

fn written(name: String, pair: &CreaturePair, folder: &Path) -> anyhow::Result<Pair> {
    let files = creatures::write(&folder.join(&name), pair)?;
    Ok(Pair {
        name,
        source: files.source,
        target: files.target,
        landmarks: files.landmarks,
        truth: Some(files.truth),
        judge: files.surface,
    })
}
