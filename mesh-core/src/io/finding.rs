//! What a reader passes over, or reads although the file contradicts itself.

use std::fmt;

use super::printable::printable;

/// Something that whoever reads a file should know: it was read, but not all of it, or not as it says of itself.
///
/// Displayed, it is one line without the file's name.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Finding {
    /// The header of a binary STL file states another number of triangles than the file holds. All there are were read.
    WrongCount {
        /// What the header states.
        stated: u64,
        /// How many there are.
        found: u64,
    },
    /// Bytes behind the last triangle that the header of a binary STL file promises; they were not read.
    BytesBehind {
        /// How many bytes.
        n_bytes: usize,
    },
    /// A text STL file that ends without `endsolid`: it may have been cut short.
    NoEnd,
    /// A mesh of a glTF file is bound to a skin that cannot be followed: its vertices were read where the mesh has them,
    /// not where its joints put them.
    SkinNotApplied {
        /// The name of the mesh.
        mesh: String,
    },
    /// Morph targets of a glTF file are in effect at rest, which viewers show; they were not applied.
    MorphsNotApplied {
        /// The name of the mesh.
        mesh: String,
    },
    /// A glTF file uses an extension that changes where or how often meshes are shown; it was passed over.
    ExtensionPassedOver {
        /// The name of the extension.
        name: String,
    },
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::WrongCount { stated, found } => {
                write!(f, "its header states {stated} triangles, but there are {found}; these were read")
            }
            Self::BytesBehind { n_bytes } => write!(
                f,
                "{n_bytes} bytes behind its last triangle were not read; is its header's count right"
            ),
            Self::NoEnd => write!(f, "it ends without `endsolid`; is it complete"),
            Self::SkinNotApplied { mesh } => write!(
                f,
                "the skin of {} cannot be followed; the mesh was read as it is without its joints",
                printable(mesh)
            ),
            Self::MorphsNotApplied { mesh } => write!(
                f,
                "the morph targets of {} have weights at rest, which were not applied",
                printable(mesh)
            ),
            Self::ExtensionPassedOver { name } => write!(
                f,
                "it uses {}, which was passed over: other programs may show other shapes",
                printable(name)
            ),
        }
    }
}
