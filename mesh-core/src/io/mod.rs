//! Mesh files: read, and written back as they were with new positions.
//!
//! | to | call |
//! |---|---|
//! | read a source, with all that is needed to write it back | [`read_mesh`] |
//! | read a target | [`read_soup`], [`read_points`] |
//! | write a source with new positions | [`MeshFile::write`] |
//! | see its colours, texture coordinates and pictures | [`MeshFile::looks`] |
//! | carry, keep or drop its morph targets | [`MeshFile::set_morphs`] |
//! | write a shape made in code | [`write_soup`] |
//! | write any file all or nothing; know before whether that will do | [`write_atomic`], [`check_writable`] |
//! | read a mesh from a pipe | [`read_stream`] |
//!
//! A [`MeshFile`] keeps the bytes of its file. To write it, those bytes are read once more and copied, with new numbers
//! where positions and normals are: order, arity, texture coordinates, groups, materials, comments, line ends and
//! statements that no reader here knows survive because nothing touches them. Coordinates that did not change keep
//! their very text.
//!
//! | format | read | changed when written back |
//! |---|---|---|
//! | OBJ | polygons of any arity, negative indices, continued lines; UTF-8 or UTF-16 | `v`, `vn` |
//! | PLY | ascii and binary in both orders, any elements and properties, strips | `x y z`, `nx ny nz` of the vertices |
//! | OFF | OFF, COFF, NOFF, STOFF and their combinations, as text | coordinates, normals |
//! | STL | text and binary; equal corners become one vertex | corners and normals of the triangles that moved |
//! | glTF, GLB | the scene's meshes where their nodes and joints put them; packed, interleaved, normalised and sparse data | POSITION, NORMAL, TANGENT, and the bounds of POSITION |
//! | XYZ | points and perhaps normals, between blanks, commas or semicolons, with points or decimal commas | the first three columns |
//!
//! The format is told by content first, by extension second, and any file may be packed with gzip. Every format can be
//! written from any other; [`MeshFile::lost_in`] tells what such a conversion does not keep. What a file contradicts
//! itself in, and what of it is not read, [`MeshFile::findings`] tells; what would be read wrong is refused.

mod contents;
mod conversion;
mod document;
mod encoding;
mod error;
mod fault;
mod file;
mod finding;
mod format;
mod gltf;
mod gzip;
mod input;
mod looks;
mod obj;
mod off;
mod ply;
mod printable;
mod save;
mod stl;
mod text;
mod triangles;
mod uvs;
mod xyz;

pub(crate) use contents::unit;
pub use contents::{Contents, Morphs, NamedFaces};
pub use error::{Place, ReadError, ReadProblem, WriteError};
pub use file::{read_mesh, read_points, read_soup, read_stream, MeshFile, PointSet};
pub use finding::Finding;
pub use format::Format;
pub use looks::{Looks, Picture, Rgb};
pub use printable::printable;
pub use save::{check_writable, write_atomic, write_soup};
