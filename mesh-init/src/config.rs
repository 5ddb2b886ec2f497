//! How an initial deformation is found.

use crate::{SimilarConfig, SimilarityPrior};

/// What happens to vertices far from every landmark.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pinning {
    /// They follow.
    None,
    /// Those farther along the surface than this share of the longest side of the box stay where the affine map put
    /// them.
    Beyond(f64),
}

/// How the landmarks spread over the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spread {
    /// A biharmonic displacement field: translations spread.
    Biharmonic,
    /// Starting there, rotations and scales spread too.
    Similar(SimilarConfig),
}

/// How the initial deformation is found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InitConfig {
    /// How near the affine map stays to a similarity.
    pub prior: SimilarityPrior,
    /// What vertices far from every landmark do in the biharmonic field.
    pub pinning: Pinning,
    /// How the landmarks spread.
    pub spread: Spread,
}

impl InitConfig {
    /// The paper's: a free affine map and a biharmonic field, pinned beyond 0.4 of the longest side as the authors'
    /// program does.
    pub fn paper() -> Self {
        Self {
            prior: SimilarityPrior::None,
            pinning: Pinning::Beyond(0.4),
            spread: Spread::Biharmonic,
        }
    }

    /// Less distortion and fewer folds: limbs turn instead of shearing.
    pub fn standard() -> Self {
        Self {
            prior: SimilarityPrior::LeaveOneOut,
            pinning: Pinning::None,
            spread: Spread::Similar(SimilarConfig::standard()),
        }
    }
}
