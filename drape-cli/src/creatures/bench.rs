//! Which creatures the bench drapes over which.

use mesh_creatures::{CreaturePair, Dial, Individual, PairConfig, Plan, Variant};

/// Every combination of what is listed.
#[derive(Clone, Debug)]
pub(crate) struct Grid {
    pub(crate) plans: Vec<Plan>,
    pub(crate) angles: Vec<f64>,
    pub(crate) ratios: Vec<f64>,
    pub(crate) n_landmarks: Vec<usize>,
    pub(crate) variants: Vec<Variant>,
    pub(crate) seeds: Vec<u64>,
    /// Parts whose places are no landmarks.
    pub(crate) without: Vec<String>,
}

/// One pair of the bench.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Case {
    pub(crate) plan: Plan,
    pub(crate) dial: Dial,
    pub(crate) n_landmarks: usize,
    pub(crate) variant: Variant,
    pub(crate) seed: u64,
}

impl Grid {
    /// The pairs, the last list running fastest.
    pub(crate) fn cases(&self) -> Vec<Case> {
        let mut cases = Vec::new();
        for &plan in &self.plans {
            for &angle in &self.angles {
                for &ratio in &self.ratios {
                    let dial = Dial { angle, ratio };
                    for &n_landmarks in &self.n_landmarks {
                        for &variant in &self.variants {
                            let case = |&seed: &u64| Case {
                                plan,
                                dial,
                                n_landmarks,
                                variant,
                                seed,
                            };
                            cases.extend(self.seeds.iter().map(case));
                        }
                    }
                }
            }
        }
        cases
    }
}

impl Case {
    /// A name for tables and folders.
    pub(crate) fn name(&self) -> String {
        let Self {
            plan,
            dial,
            n_landmarks,
            variant,
            seed,
        } = self;
        let Dial { angle, ratio } = dial;
        format!("{plan}-{angle}-{ratio}-{n_landmarks}-{variant}-{seed}")
    }

    /// The template of the plan and the individual of the seed.
    pub(crate) fn pair(&self, without: &[String]) -> CreaturePair {
        let source = Individual::template(self.plan);
        let target = Individual::drawn(self.plan, self.seed, self.dial);
        let config = PairConfig {
            variant: self.variant,
            n_landmarks: self.n_landmarks,
            without: without.to_vec(),
            seed: self.seed,
            ..PairConfig::standard()
        };
        CreaturePair::new(&source, &target, &config)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_combination_has_a_name_of_its_own() {
        let grid = Grid {
            plans: Plan::ALL.to_vec(),
            angles: vec![30.0, 60.0],
            ratios: vec![1.0, 1.75],
            n_landmarks: vec![5],
            variants: vec![Variant::Mesh, Variant::HalfScan],
            seeds: vec![0, 1, 2],
            without: Vec::new(),
        };
        let names: std::collections::BTreeSet<String> =
            grid.cases().iter().map(Case::name).collect();
        assert_eq!(names.len(), 5 * 2 * 2 * 2 * 3);
        assert!(names.contains("bird-60-1.75-5-half-scan-2"));
    }
}
