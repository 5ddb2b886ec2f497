//! What is worth knowing about a baked map.

use std::fmt;

/// What is worth knowing about a baked map, in neutral words as text.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum BakeFinding {
    /// Triangles of the source without texture coordinates, which have no place in the picture.
    WithoutUvs {
        /// How many.
        n_triangles: usize,
    },
    /// Texture coordinates beyond the unit square, which wrap.
    Wrapped,
    /// Texels that several faces cover; the first one's colour counts.
    Overlapping {
        /// Their share, 0..=1 of those that are covered, more where more than two overlap.
        share: f64,
    },
    /// Texels with nothing of the target within reach: they take the closest place.
    Far {
        /// Their share, 0..=1.
        share: f64,
    },
    /// Texels whose place on the target has no colour: they take that of a neighbour.
    Unpainted {
        /// Their share, 0..=1.
        share: f64,
    },
    /// What white and black of the displacement map mean.
    Displacement {
        /// White is this far out along the source's normals, black as far in, the middle (0.5) nothing; in units of the
        /// target.
        scale: f64,
    },
}

impl fmt::Display for BakeFinding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::WithoutUvs { n_triangles } => write!(
                f,
                "{n_triangles} triangles of the source have no texture coordinates and no place in the texture"
            ),
            Self::Wrapped => write!(
                f,
                "texture coordinates reach beyond the unit square and wrap: every square is laid over the same texture"
            ),
            Self::Overlapping { share } => write!(
                f,
                "{:.1} % of the texels belong to several faces (mirrored or stacked texture coordinates); the first one counts",
                100.0 * share
            ),
            Self::Far { share } => write!(
                f,
                "{:.1} % of the texels have nothing of the target near them and take its closest place",
                100.0 * share
            ),
            Self::Unpainted { share } => write!(
                f,
                "{:.1} % of the texels belong to places of the target without a colour and take that of a neighbour",
                100.0 * share
            ),
            Self::Displacement { scale } => write!(
                f,
                "displacement: white is {scale} out, black {scale} in, the middle (0.5) none, in units of the target along the \
                 result's smooth normals (strength {}, midlevel 0.5)",
                2.0 * scale
            ),
        }
    }
}
