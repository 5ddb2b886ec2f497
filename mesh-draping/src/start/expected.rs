//! What is known of a result before it is come to.

use mesh_core::Positions;
use neural_drape::{Drape, DrapeError};

use crate::{Motion, Pair, Population};

/// What is known of the shape that a drape comes to.
pub(crate) enum Expected {
    Nothing,
    /// It is nearly this one: the end of a run begins there.
    Nearly(Positions),
    /// It is the next frame of a motion.
    Next(Motion),
    /// It is much like one of these: that which fits best is one more start to try.
    OneOf(Population),
}

impl Expected {
    /// Holds the surface to the first frame of a motion.
    pub(crate) fn hold(&self, drape: &mut Drape) -> Result<(), DrapeError> {
        match self {
            Self::Next(motion) => drape.hold_to(&motion.first),
            Self::Nothing | Self::Nearly(_) | Self::OneOf(_) => Ok(()),
        }
    }

    /// The population, where that is what is known.
    pub(crate) fn into_population(self) -> Option<Population> {
        match self {
            Self::OneOf(population) => Some(population),
            Self::Nothing | Self::Nearly(_) | Self::Next(_) => None,
        }
    }

    /// Whether there is a position for each vertex of the source.
    pub(crate) fn check(&self, pair: &Pair) -> Result<(), DrapeError> {
        match self {
            Self::Nothing => Ok(()),
            Self::Nearly(shape) => pair.check_each([("the shape to start from", shape.len())]),
            Self::Next(motion) => pair.check_each([
                ("the first frame", motion.first.len()),
                ("the frame before", motion.before.len()),
            ]),
            Self::OneOf(population) => {
                pair.check_each([("a shape of the population", population.n_vertices())])
            }
        }
    }
}
