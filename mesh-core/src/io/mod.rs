//! Mesh files: read, and written back as they were with new positions.
//!
//! | to | call |
//! |---|---|
//! | read a source, with all that is needed to write it back | [`read_mesh`] |
//! | read a target | [`read_soup`], [`read_points`] |
//! | write a source with new positions | [`MeshFile::write`] |
//! | write a shape made in code | [`write_soup`] |
//! | write any file all or nothing | [`write_atomic`] |
//!
//! A [`MeshFile`] keeps the bytes of its file. To write it, those bytes are read once more and copied, with new numbers
//! where positions and normals are: order, arity, texture coordinates, groups, materials, comments, line ends and
//! statements that no reader here knows survive because nothing touches them. Coordinates that did not change keep
//! their very text.

mod contents;
mod error;
mod file;
mod format;
mod gltf;
mod gzip;
mod obj;
mod off;
mod ply;
mod save;
mod stl;
mod text;
mod xyz;

pub use contents::{Contents, NamedFaces};
pub use error::{Place, ReadError, ReadProblem, WriteError};
pub use file::{read_mesh, read_points, read_soup, MeshFile, PointSet};
pub use format::Format;
pub use save::{write_atomic, write_soup};
