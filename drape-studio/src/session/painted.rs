//! What is painted rigid is a file among the rigid parts, known by its folder.

use std::path::Path;

use mesh_draping::Parts;

/// The folder of what is painted rigid, among the files of a session.
pub(crate) const RIGID_FOLDER: &str = "painted-rigid";

/// The file of what is painted rigid, if anything is. A session that moved names a folder of where it was.
pub(crate) fn painted_rigid(parts: &Parts) -> Option<&String> {
    parts.rigid.iter().find(|name| {
        let folder = Path::new(name.as_str()).parent();
        folder.is_some_and(|folder| folder.ends_with(RIGID_FOLDER))
    })
}
