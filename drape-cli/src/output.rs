//! What commands print, and places to write to, checked before any work is done.

use std::io::{self, Write as _};
use std::path::Path;

use anyhow::bail;
use mesh_core::io::{printable, Format, MeshFile};

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
        eprintln!("warning: {}", printable(warning));
    }
}

/// What was found in a file that was read, with its name.
pub(crate) fn findings(file: &MeshFile) -> Vec<String> {
    let name = file.path().to_string_lossy();
    let found = file.findings().iter();
    found
        .map(|finding| format!("{}: {finding}", printable(&name)))
        .collect()
}

/// Refuses an output that cannot be written, before any work is done.
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
        _ => Ok(mesh_core::io::check_writable(path)?),
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

/// That an output in another folder names files that stay beside the source (materials, pictures), in words.
pub(crate) fn left_beside(file: &MeshFile, output: &Path) -> Option<String> {
    let folder_of = |path: &Path| {
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty());
        folder.unwrap_or(Path::new(".")).canonicalize().ok()
    };
    let (from, to) = (folder_of(file.path())?, folder_of(output)?);
    let is_left = |name: &&String| from.join(name).is_file() && !to.join(name).exists();
    let names: Vec<&str> = file
        .contents()
        .references
        .iter()
        .filter(is_left)
        .map(String::as_str)
        .collect();
    let is_written = file.keeps_format(output) && !names.is_empty();
    is_written.then(|| {
        format!(
            "{} names files that stay in {}: copy {} beside it",
            output.display(),
            from.display(),
            names.join(", ")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn files_that_stay_beside_the_source_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let (source, other) = (folder.path().join("in"), folder.path().join("out"));
        fs::create_dir(&source).unwrap();
        fs::create_dir(&other).unwrap();
        fs::write(source.join("skin.mtl"), b"newmtl a").unwrap();
        let text = "mtllib skin.mtl\nmtllib missing.mtl\nv 0 0 0\nf 1 1 1\n";
        let file = MeshFile::from_bytes(source.join("a.obj"), text.into()).unwrap();
        let told = left_beside(&file, &other.join("b.obj")).unwrap();
        assert!(told.contains("copy skin.mtl beside it"), "{told}");
        assert_eq!(left_beside(&file, &source.join("b.obj")), None);
        assert_eq!(left_beside(&file, &other.join("b.ply")), None);
        fs::write(other.join("skin.mtl"), b"").unwrap();
        assert_eq!(left_beside(&file, &other.join("b.obj")), None);
    }

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
