//! Maps that are baked from the target into the source's texture coordinates.

use std::path::{Path, PathBuf};

use anyhow::bail;
use mesh_core::Positions;
use mesh_draping::{Source, Target};
use mesh_render::bake::{BakeFinding, Depth, Maps};

use super::is_pipe;
use crate::output::{check_distinct, check_writable};

/// How maps look, whichever they are.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(crate) struct MapArgs {
    /// Texels along the side of a baked map
    #[arg(long, value_name = "N", default_value_t = 2048)]
    bake_size: usize,
    /// Bits of a sample in baked colours and normals
    #[arg(long, value_name = "BITS", value_enum, default_value = "8")]
    bake_depth: DepthArg,
}

/// [`Depth`] by its number of bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum DepthArg {
    #[value(name = "8")]
    Eight,
    #[value(name = "16")]
    Sixteen,
}

/// The maps to bake, each where a path is given.
#[derive(Debug, clap::Args)]
pub(crate) struct BakeArgs {
    /// Bake the target's picture and colours into the source's texture coordinates, as a PNG file
    #[arg(long, value_name = "PNG")]
    pub(crate) bake: Option<PathBuf>,
    /// Bake the target's normals likewise, in the coordinates of the result (object space)
    #[arg(long, value_name = "PNG")]
    pub(crate) bake_normal: Option<PathBuf>,
    /// Bake how far the target lies out of the result, with 16 bits: the middle is nothing
    #[arg(long, value_name = "PNG")]
    pub(crate) bake_displacement: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) maps: MapArgs,
}

impl MapArgs {
    /// The maps that go to these files.
    pub(crate) fn maps<'a>(
        self,
        colors: Option<&'a Path>,
        normals: Option<&'a Path>,
        displacement: Option<&'a Path>,
    ) -> Maps<'a> {
        Maps {
            colors,
            normals,
            displacement,
            size: self.bake_size,
            depth: match self.bake_depth {
                DepthArg::Eight => Depth::Eight,
                DepthArg::Sixteen => Depth::Sixteen,
            },
        }
    }
}

impl BakeArgs {
    /// No map at all.
    pub(crate) const fn none() -> Self {
        Self {
            bake: None,
            bake_normal: None,
            bake_displacement: None,
            maps: MapArgs {
                bake_size: 2048,
                bake_depth: DepthArg::Eight,
            },
        }
    }

    /// The maps that are asked for.
    pub(crate) fn maps(&self) -> Maps<'_> {
        self.maps.maps(
            self.bake.as_deref(),
            self.bake_normal.as_deref(),
            self.bake_displacement.as_deref(),
        )
    }
}

/// Refuses maps that cannot be written, before any work is done.
pub(crate) fn check_maps(maps: &Maps<'_>, target: &Path, inputs: &[&Path]) -> anyhow::Result<()> {
    if maps.colors.is_some() && is_pipe(target) {
        bail!("colours are baked from the target's file; standard input is read once only");
    }
    for path in maps.paths() {
        check_writable(path)?;
        check_distinct(path, inputs)?;
    }
    Ok(())
}

/// Refuses maps that cannot be baked, before any work is done.
pub(crate) fn check_bakeable(
    maps: &Maps<'_>,
    source: &Source,
    painted: &Path,
) -> anyhow::Result<()> {
    match maps.paths().next() {
        Some(_) => Ok(maps.check(source, painted)?),
        None => Ok(()),
    }
}

/// Bakes the maps; what is worth knowing about them, in words.
pub(crate) fn bake(
    maps: &Maps<'_>,
    draped: (&Source, &Positions),
    target: &Target,
    painted: &Path,
) -> anyhow::Result<Vec<String>> {
    if maps.paths().next().is_none() {
        return Ok(Vec::new());
    }
    let findings = maps.write(draped, target, painted)?;
    Ok(findings.iter().map(BakeFinding::to_string).collect())
}
