//! Which vertices of a source move as one.

use std::fmt;
use std::str::FromStr;

use mesh_core::{PolygonSoup, Weld};

/// Which vertices of a source move as one. Files are split along seams of texture coordinates or normals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Seams {
    /// Those no farther apart than this, in units of the coordinates.
    Closed(f64),
    /// Each is its own, even where several share a place.
    Open,
}

impl Seams {
    /// Equal places, as files are split along seams of texture coordinates.
    pub const EXACT: Self = Self::Closed(0.0);

    /// The mesh to solve on, and the way back to the vertices of `soup`.
    ///
    /// # Panics
    /// If a face names a vertex that is not there (see [`PolygonSoup::check`]).
    pub fn weld(self, soup: PolygonSoup) -> Weld {
        match self {
            Self::Closed(eps) => soup.weld(eps),
            Self::Open => Weld {
                row_of: (0..soup.positions.len() as u32).collect(),
                soup,
            },
        }
    }
}

/// A text that names no way to close seams.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("must be a distance of 0 or more, or off")]
pub struct SeamsError;

/// A distance of 0 or more, or `off`.
impl FromStr for Seams {
    type Err = SeamsError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if text == "off" {
            return Ok(Self::Open);
        }
        let eps = text.parse().ok();
        eps.filter(|eps: &f64| eps.is_finite() && *eps >= 0.0)
            .map(Self::Closed)
            .ok_or(SeamsError)
    }
}

impl fmt::Display for Seams {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Closed(eps) => write!(f, "{eps}"),
            Self::Open => f.write_str("off"),
        }
    }
}
