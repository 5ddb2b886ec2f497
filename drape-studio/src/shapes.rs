//! What is draped over what, with what is found about the two once.

use std::sync::{Arc, OnceLock};

use anyhow::Result;
use mesh_core::Landmark;
use mesh_draping::parts::HiddenSurfaces;
use mesh_draping::{Pair, Parts, Source, Target};
use neural_drape::Regions;

/// A source and a target. Cloning is cheap: clones share everything.
#[derive(Clone)]
pub(crate) struct Shapes {
    pub(crate) source: Source,
    pub(crate) target: Target,
    hidden: Arc<OnceLock<HiddenSurfaces>>,
}

impl Shapes {
    pub(crate) fn new(source: Source, target: Target) -> Self {
        Self {
            source,
            target,
            hidden: Arc::default(),
        }
    }

    /// The two with landmarks.
    pub(crate) fn pair(&self, landmarks: Vec<Landmark>) -> Pair {
        Pair {
            source: self.source.clone(),
            target: self.target.clone(),
            landmarks,
        }
    }

    /// The inner surfaces of the two.
    pub(crate) fn hidden(&self) -> &HiddenSurfaces {
        let find = || HiddenSurfaces::of(&self.pair(Vec::new()));
        self.hidden.get_or_init(find)
    }

    /// The inner surfaces, if they have been asked for.
    pub(crate) fn known_hidden(&self) -> Option<&HiddenSurfaces> {
        self.hidden.get()
    }

    /// How each vertex is treated where parts are treated so.
    pub(crate) fn regions(&self, parts: &Parts) -> Result<Regions> {
        let resolved = parts.resolve_with(&self.pair(Vec::new()), &self.hidden)?;
        Ok(resolved.regions)
    }

    /// Whether both are of the same files, read at the same time.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        self.source.is_same(&other.source) && self.target.is_same(&other.target)
    }
}
