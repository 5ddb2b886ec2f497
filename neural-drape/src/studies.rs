//! The paper's studies as presets: one thing changed at a time.
//!
//! Distance, landmarks, angles, areas and skinny triangles as in the paper and no term beyond it; the network of
//! [`DrapeConfig::network`], whose residual output needs no pre-training; 400 + 200 iterations.

use crate::network::{Encoding, Frequencies, NetworkConfig};
use crate::{
    AngleReference, Descent, DrapeConfig, OverlapMode, ParametrizationConfig, Stage, Weights,
};

/// A preset that differs from [`DrapeConfig::study`] in one thing.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// What [`DrapeConfig::named`] knows it by.
    pub name: &'static str,
    /// Its settings.
    pub config: DrapeConfig,
}

impl DrapeConfig {
    /// The settings that every study changes one thing of: the paper's terms and λ schedule on the residual network.
    pub fn study() -> Self {
        let mut config = Self::network();
        config.descent = Descent::Combined;
        config.angle_reference = AngleReference::Rest;
        config.sampling.normal_bias = None;
        config.sampling.n_hard = 0;
        config.overlap = OverlapMode::Full;
        config.skinny_threshold = 0.1;
        config.repair = false;
        config.stages = Self::paper().stages;
        for (stage, n) in config.stages.iter_mut().zip([400, 200]) {
            stage.n_iterations = n;
        }
        config
    }

    /// The studies: [`Self::study`] itself, then one thing changed at a time. All names are known to [`Self::named`].
    ///
    /// A study of another start than the standard one has the settings of [`Self::study`]: where a drape starts is part
    /// of its input.
    pub fn studies() -> Vec<Study> {
        let encoding = |encode: fn(Frequencies) -> Encoding| {
            let mut config = Self::study();
            set_encoding(&mut config, encode);
            config
        };
        let weights = |change: fn(&mut Weights)| {
            let mut config = Self::study();
            change_weights(&mut config, change);
            config
        };
        let lambda = |lambda: f64| {
            let mut config = Self::study();
            change_weights(&mut config, |w| *w = w.with_lambda(lambda));
            config
        };
        [
            ("study", Self::study()),
            ("study-no-encoding", encoding(|_| Encoding::None)),
            ("study-static-encoding", encoding(Encoding::Static)),
            ("study-angles-only", weights(|w| w.area_kl = 0.0)),
            ("study-areas-only", weights(|w| w.corner_angle = 0.0)),
            ("study-lambda-1", lambda(1.0)),
            ("study-lambda-0.2", lambda(0.2)),
        ]
        .map(|(name, config)| Study { name, config })
        .into()
    }
}

fn change_weights(config: &mut DrapeConfig, change: impl Fn(&mut Weights)) {
    for Stage { from, to, .. } in &mut config.stages {
        change(from);
        change(to);
    }
}

/// Replaces the progressive encoding by another of the same waves.
fn set_encoding(config: &mut DrapeConfig, encoding: impl Fn(Frequencies) -> Encoding) {
    if let ParametrizationConfig::Network(NetworkConfig {
        encoding: at @ Encoding::Progressive { .. },
        ..
    }) = &mut config.parametrization
    {
        if let Encoding::Progressive { frequencies, .. } = *at {
            *at = encoding(frequencies);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_study_is_a_preset_and_differs_from_the_first() {
        let studies = DrapeConfig::studies();
        for (row, study) in studies.iter().enumerate() {
            study.config.check().unwrap();
            assert_eq!(DrapeConfig::named(study.name).unwrap(), study.config);
            let first = studies.iter().position(|s| s.config == study.config);
            assert_eq!(first, Some(row), "{}", study.name);
        }
    }
}
