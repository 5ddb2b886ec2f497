//! `-`, standard input and output in the place of files.

use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use anyhow::bail;
use mesh_core::io::{read_mesh, read_stream, Format, MeshFile};
use mesh_core::Positions;
use mesh_draping::Source;

use crate::output::{check_distinct, check_mesh, say};

/// What stands for standard input or output.
const PIPE: &str = "-";

/// The format of what goes through a pipe.
#[derive(Clone, Copy, Debug, Default, clap::Args)]
pub(crate) struct PipeArgs {
    /// Format of a mesh that goes to standard output (-o -), the source's where not given; else that of one from standard
    /// input (- in the place of a file), where its content does not tell
    #[arg(long, value_name = "FORMAT")]
    format: Option<FormatArg>,
}

/// [`Format`] by the extension of its files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum FormatArg {
    Obj,
    Ply,
    Off,
    Stl,
    Gltf,
    Glb,
    Xyz,
}

impl From<FormatArg> for Format {
    fn from(arg: FormatArg) -> Self {
        match arg {
            FormatArg::Obj => Self::Obj,
            FormatArg::Ply => Self::Ply,
            FormatArg::Off => Self::Off,
            FormatArg::Stl => Self::Stl,
            FormatArg::Gltf => Self::Gltf,
            FormatArg::Glb => Self::Glb,
            FormatArg::Xyz => Self::Xyz,
        }
    }
}

/// Whether this stands for standard input or output.
pub(crate) fn is_pipe(path: &Path) -> bool {
    path.as_os_str() == PIPE
}

/// Prints what a command has to tell: beside the mesh where that goes to standard output.
pub(crate) fn say_beside(output: &Path, text: &str) -> io::Result<()> {
    if is_pipe(output) {
        return io::stderr().write_all(text.as_bytes());
    }
    say(text)
}

/// That a file was written; nothing where it went to standard output.
pub(crate) fn wrote(output: &Path) -> String {
    match is_pipe(output) {
        true => String::new(),
        false => format!("wrote {}\n", output.display()),
    }
}

impl PipeArgs {
    /// Refuses a format without a pipe, and more than one mesh from standard input.
    pub(crate) fn check(self, inputs: &[&Path], output: Option<&Path>) -> anyhow::Result<()> {
        let n_piped = inputs.iter().filter(|path| is_pipe(path)).count();
        if n_piped > 1 {
            bail!("standard input holds one mesh; give a file for the other");
        }
        let is_used = n_piped > 0 || output.is_some_and(is_pipe);
        if self.format.is_some() && !is_used {
            bail!("--format goes with - in the place of a file; the extension tells the format of a file");
        }
        Ok(())
    }

    /// Refuses a mesh that cannot be written, as far as its name tells, or that would replace an input.
    pub(crate) fn check_output(self, output: &Path, inputs: &[&Path]) -> anyhow::Result<()> {
        if is_pipe(output) {
            return Ok(());
        }
        check_mesh(output)?;
        check_distinct(output, inputs)
    }

    /// Reads a mesh, from standard input where `-` is given. `output` is where the command writes, if it does.
    pub(crate) fn read(self, path: &Path, output: Option<&Path>) -> anyhow::Result<MeshFile> {
        if !is_pipe(path) {
            return Ok(read_mesh(path)?);
        }
        let format = self.format.filter(|_| !output.is_some_and(is_pipe));
        let name = named("stdin", format.map(Format::from));
        Ok(read_stream(name, io::stdin().lock())?)
    }

    /// What the output is called: a name whose extension tells the format, where it is a pipe.
    pub(crate) fn name(self, file: &MeshFile, output: &Path) -> PathBuf {
        if !is_pipe(output) {
            return output.to_owned();
        }
        let format = self.format.map_or(file.format(), Format::from);
        named("stdout", Some(format))
    }

    /// Writes a source with its vertices at `positions`, to standard output where `-` is given.
    pub(crate) fn write_source(
        self,
        source: &Source,
        positions: &Positions,
        output: &Path,
    ) -> anyhow::Result<()> {
        match source.file() {
            Some(file) => self.write(file, &source.spread(positions), output),
            None => Ok(source.write(output, positions)?),
        }
    }

    /// Writes a file with its vertices at `moved`, to standard output where `-` is given.
    pub(crate) fn write(
        self,
        file: &MeshFile,
        moved: &Positions,
        output: &Path,
    ) -> anyhow::Result<()> {
        if !is_pipe(output) {
            return Ok(file.write(output, moved)?);
        }
        let bytes = file.to_bytes(self.name(file, output), moved)?;
        let mut out = io::stdout().lock();
        out.write_all(&bytes)?;
        Ok(out.flush()?)
    }
}

/// `stem` with the usual extension of a format.
fn named(stem: &str, format: Option<Format>) -> PathBuf {
    match format {
        Some(format) => format!("{stem}.{}", format.extension()).into(),
        None => stem.into(),
    }
}
