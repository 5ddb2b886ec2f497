//! What commands print, and places to write to, checked before any work is done.

use std::io::{self, Write as _};
use std::path::Path;

use anyhow::bail;
use mesh_core::io::Format;

/// Prints text; a reader that has had enough (`| head`) is no error.
pub(crate) fn say(text: &str) -> io::Result<()> {
    match io::stdout().write_all(text.as_bytes()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        printed => printed,
    }
}

/// Prints warnings where they do not mix with results.
pub(crate) fn warn(warnings: &[String]) {
    for warning in warnings {
        eprintln!("warning: {warning}");
    }
}

/// Refuses an output whose folder is not there, before any work is done.
pub(crate) fn check_writable(path: &Path) -> anyhow::Result<()> {
    if path.is_dir() {
        bail!("{}: is a folder; name a file", path.display());
    }
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty());
    match folder {
        Some(folder) if !folder.is_dir() => {
            bail!(
                "{}: the folder {} does not exist",
                path.display(),
                folder.display()
            )
        }
        _ => Ok(()),
    }
}

/// Refuses a mesh whose extension names no format; whether a source can be written in it is known once that is read.
pub(crate) fn check_mesh(path: &Path) -> anyhow::Result<()> {
    check_writable(path)?;
    if Format::of_extension(path).is_none() {
        bail!(
            "{}: the extension names no mesh format; use for example .obj or .ply",
            path.display()
        );
    }
    Ok(())
}

/// Refuses an output that would overwrite one of the files it is made from.
pub(crate) fn check_distinct(path: &Path, inputs: &[&Path]) -> anyhow::Result<()> {
    let Ok(real) = path.canonicalize() else {
        return Ok(());
    };
    match inputs
        .iter()
        .find(|input| input.canonicalize().is_ok_and(|i| i == real))
    {
        Some(input) => bail!(
            "{}: is an input ({}); name another file",
            path.display(),
            input.display()
        ),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn bad_places_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("missing").join("a.obj");
        assert!(check_writable(&path)
            .unwrap_err()
            .to_string()
            .contains("missing"));
        assert!(check_writable(folder.path()).is_err());
        assert!(check_mesh(&folder.path().join("a.docx")).is_err());
        assert!(check_mesh(&folder.path().join("a.PLY")).is_ok());
        let input = folder.path().join("in.obj");
        fs::write(&input, b"v").unwrap();
        assert!(check_distinct(&folder.path().join("in.obj"), &[&input]).is_err());
        assert!(check_distinct(&folder.path().join("out.obj"), &[&input]).is_ok());
    }
}
