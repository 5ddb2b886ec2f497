//! The paper's studies as presets: one thing changed at a time.
//!
//! Distance, landmarks, angles, areas and skinny triangles as in the paper and no term beyond it; the network of
//! [`DrapeConfig::network`], whose residual output needs no pre-training; 400 + 200 iterations.

use crate::network::{Encoding, Frequencies, NetworkConfig};
use crate::{
    AngleReference, Descent, DrapeConfig, OverlapMode, ParametrizationConfig, Stage, Weights,
};

/// What a study changes.
type Change = fn(&mut DrapeConfig);

/// Name, and what is different from the first.
const STUDIES: [(&str, Change); 8] = [
    ("study", |_| ()),
    ("study-no-encoding", |c| set_encoding(c, |_| Encoding::None)),
    ("study-static-encoding", |c| {
        set_encoding(c, Encoding::Static);
    }),
    ("study-angles-only", |c| {
        change_weights(c, |w| w.area_kl = 0.0);
    }),
    ("study-areas-only", |c| {
        change_weights(c, |w| w.corner_angle = 0.0);
    }),
    ("study-affine-start", |_| ()),
    ("study-lambda-1", |c| {
        change_weights(c, |w| (w.corner_angle, w.area_kl) = (1.0, 1.0));
    }),
    ("study-lambda-0.2", |c| {
        change_weights(c, |w| (w.corner_angle, w.area_kl) = (0.2, 0.2));
    }),
];

impl DrapeConfig {
    /// Names of the studies, all known to [`Self::named`].
    pub fn studies() -> impl Iterator<Item = &'static str> {
        STUDIES.iter().map(|(name, _)| *name)
    }

    /// The study of this name.
    pub(crate) fn study(name: &str) -> Option<Self> {
        let (_, change) = STUDIES.iter().find(|(known, _)| *known == name)?;
        let mut config = base();
        change(&mut config);
        Some(config)
    }
}

/// The paper's terms and λ schedule on the residual network.
fn base() -> DrapeConfig {
    let mut config = DrapeConfig::network();
    config.descent = Descent::Combined;
    config.angle_reference = AngleReference::Rest;
    config.sampling.normal_bias = None;
    config.sampling.n_hard = 0;
    config.overlap = OverlapMode::Full;
    config.skinny_threshold = 0.1;
    config.repair = false;
    config.stages = DrapeConfig::paper().stages;
    for (stage, n) in config.stages.iter_mut().zip([400, 200]) {
        stage.n_iterations = n;
    }
    config
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
        let first = DrapeConfig::named("study").unwrap();
        for name in DrapeConfig::studies() {
            let config = DrapeConfig::named(name).unwrap();
            config.check().unwrap();
            // The start of `study-affine-start` is chosen outside of these settings.
            let is_same = config == first;
            assert_eq!(
                is_same,
                ["study", "study-affine-start"].contains(&name),
                "{name}"
            );
        }
    }
}
