//! What can be wrong with landmarks, as values.

use std::fmt;

use super::Label;

/// Something suspicious about landmarks. `Display` says it in neutral words.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Finding {
    /// Too few to find how the source is stretched.
    TooFew {
        /// How many there are.
        n: usize,
        /// How many it takes.
        least: usize,
    },
    /// Enough for the affine map, but parts have no guidance.
    Few {
        /// How many there are.
        n: usize,
    },
    /// The place on the target is off its surface; of a curve, the farthest of its line.
    OffSurface {
        /// Which landmark or curve.
        landmark: Label,
        /// How far, in longest sides of the target's box.
        distance: f64,
    },
    /// More landmarks are off the target's surface than are told one by one.
    MoreOffSurface {
        /// How many more.
        n: usize,
    },
    /// Two landmarks share a place.
    SamePlace {
        /// The earlier one.
        a: Label,
        /// The later one.
        b: Label,
        /// On which shapes.
        on: Shared,
    },
    /// More pairs of landmarks share places than are told one by one.
    MoreSamePlaces {
        /// How many more.
        n: usize,
    },
    /// A mirror image fits better: left and right are probably exchanged throughout.
    Mirrored,
    /// Two landmarks are probably exchanged.
    Exchanged {
        /// The one.
        a: Label,
        /// The other.
        b: Label,
    },
    /// Two landmarks fit better in space if exchanged; no ways along the shapes join them, to be surer.
    PerhapsExchanged {
        /// The one.
        a: Label,
        /// The other.
        b: Label,
    },
    /// The line of a curve on the target probably runs the other way.
    CurveReversed {
        /// Which curve.
        curve: Label,
    },
    /// A landmark is far from where the others expect it.
    Unexpected {
        /// Which landmark.
        landmark: Label,
        /// How far, in longest sides of the target's box.
        distance: f64,
    },
}

/// On which shapes two landmarks share a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shared {
    /// On both: they are the same.
    Both,
    /// On the source alone.
    SourceOnly,
    /// On the target alone.
    TargetOnly,
}

impl Finding {
    /// The landmarks it is about; an application that numbers from 1 changes their labels.
    pub fn labels_mut(&mut self) -> impl Iterator<Item = &mut Label> {
        let (first, second) = match self {
            Self::TooFew { .. }
            | Self::Few { .. }
            | Self::MoreOffSurface { .. }
            | Self::MoreSamePlaces { .. }
            | Self::Mirrored => (None, None),
            Self::OffSurface { landmark, .. }
            | Self::Unexpected { landmark, .. }
            | Self::CurveReversed { curve: landmark } => (Some(landmark), None),
            Self::SamePlace { a, b, .. }
            | Self::Exchanged { a, b }
            | Self::PerhapsExchanged { a, b } => (Some(a), Some(b)),
        };
        first.into_iter().chain(second)
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooFew { n, least } => write!(
                f,
                "{}: too few to find how the source is stretched; mark at least {least} places that do not lie in one \
                 plane",
                counted(*n)
            ),
            Self::Few { n } => write!(
                f,
                "{}: few; mark the ends of limbs, ears and other parts that stick out",
                counted(*n)
            ),
            Self::OffSurface { landmark, distance } => write!(
                f,
                "{landmark} is off the target's surface by {}",
                percent(*distance)
            ),
            Self::MoreOffSurface { n } => {
                write!(f, "{n} more landmarks are off the target's surface, likewise")
            }
            Self::SamePlace { a, b, on } => write!(f, "{a} and {b} {on}"),
            Self::MoreSamePlaces { n } => {
                write!(f, "{n} more pairs of landmarks share places, likewise")
            }
            Self::Mirrored => f.write_str(
                "the landmarks fit a mirror image better: left and right are probably exchanged throughout",
            ),
            Self::CurveReversed { curve } => write!(
                f,
                "{curve} probably runs the other way on the target: its ends are exchanged"
            ),
            Self::Exchanged { a, b } => write!(f, "{a} and {b} are probably exchanged"),
            Self::PerhapsExchanged { a, b } => {
                write!(f, "are {a} and {b} exchanged? in space they fit better so")
            }
            Self::Unexpected { landmark, distance } => write!(
                f,
                "{landmark} is {} from where the other landmarks expect it",
                percent(*distance)
            ),
        }
    }
}

impl fmt::Display for Shared {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Both => "are the same",
            Self::SourceOnly => {
                "start from one place of the source but belong to two of the target"
            }
            Self::TargetOnly => {
                "belong to one place of the target but start from two of the source"
            }
        })
    }
}

fn counted(n: usize) -> String {
    match n {
        1 => "1 landmark".to_owned(),
        n => format!("{n} landmarks"),
    }
}

fn percent(distance: f64) -> String {
    format!("{:.1} % of the target's longest side", 100.0 * distance)
}
