//! Which vertices of a source move as one, and how its morph targets follow.

use std::path::Path;
use std::str::FromStr;

use mesh_core::io::{MeshFile, Morphs};
use mesh_core::{PolygonSoup, Positions, Weld};

/// Which vertices of the source are one.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(crate) struct WeldArgs {
    /// Vertices of the source no farther apart than this, in its coordinates, move as one: 0 for equal places only,
    /// as glTF splits them along seams; off for none
    #[arg(long, value_name = "EPS", default_value = "0")]
    pub(crate) weld: Seams,
}

/// How morph targets follow.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(crate) struct MorphArgs {
    /// Morph targets of a glTF file: carry takes each to the new shape, keep leaves them, drop removes them
    #[arg(long, value_name = "HOW", default_value = "keep")]
    pub(crate) morphs: Morphing,
}

/// Which vertices are one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Seams {
    /// Those no farther apart than this.
    Closed(f64),
    /// Each is its own, even where several share a place.
    Open,
}

impl Seams {
    /// Equal places, as files are split along seams of texture coordinates.
    pub(crate) const EXACT: Self = Self::Closed(0.0);

    /// The mesh to solve on, and the way back to the vertices of `soup`, which is sound.
    pub(crate) fn weld(self, soup: PolygonSoup) -> Weld {
        match self {
            Self::Closed(eps) => soup.weld(eps),
            Self::Open => Weld {
                row_of: (0..soup.positions.len() as u32).collect(),
                soup,
            },
        }
    }
}

impl FromStr for Seams {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if text == "off" {
            return Ok(Self::Open);
        }
        let eps = text.parse().ok();
        eps.filter(|eps: &f64| eps.is_finite() && *eps >= 0.0)
            .map(Self::Closed)
            .ok_or("must be a distance of 0 or more, or off")
    }
}

impl std::fmt::Display for Seams {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Closed(eps) => write!(f, "{eps}"),
            Self::Open => f.write_str("off"),
        }
    }
}

/// [`Morphs`] by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Morphing {
    /// Through the map's Jacobian
    Carry,
    /// As they are
    Keep,
    /// Without them
    Drop,
}

impl From<Morphing> for Morphs {
    fn from(morphing: Morphing) -> Self {
        match morphing {
            Morphing::Carry => Self::Carry,
            Morphing::Keep => Self::Keep,
            Morphing::Drop => Self::Drop,
        }
    }
}

impl std::fmt::Display for Morphing {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Carry => "carry",
            Self::Keep => "keep",
            Self::Drop => "drop",
        })
    }
}

/// The farthest that two vertices of `file`, one in `weld`, lie apart at `positions`, in units of the coordinates.
pub(crate) fn widest_gap(weld: &Weld, positions: &Positions) -> f64 {
    let mut first = vec![None; weld.soup.positions.len()];
    let gaps = positions.iter().zip(&weld.row_of).map(|(p, &row)| {
        let there: &mut Option<mesh_core::Point3> = &mut first[row as usize];
        (p - *there.get_or_insert(*p)).norm()
    });
    gaps.fold(0.0, f64::max)
}

impl MorphArgs {
    /// That morph targets stay as they were, where they do, in words.
    pub(crate) fn left_behind(&self, file: &MeshFile, output: &Path) -> Option<String> {
        let n = file.contents().n_morph_targets;
        let is_kept = n > 0 && self.morphs == Morphing::Keep && file.keeps_format(output);
        is_kept.then(|| {
            let targets = if n == 1 {
                "1 morph target is"
            } else {
                &format!("{n} morph targets are")
            };
            format!(
                "{targets} kept as made for the source; --morphs carry takes them to the new shape"
            )
        })
    }
}
