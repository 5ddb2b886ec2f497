//! Maps as files: which of them, how large, how deep.

use std::path::Path;

use mesh_core::Positions;
use mesh_draping::{Source, Target};

use super::{check_size, Bake, BakeError, BakeFinding, Depth, Paint};

/// The maps to bake, each where a path is given.
#[derive(Clone, Copy, Debug)]
pub struct Maps<'a> {
    /// Where the colours go.
    pub colors: Option<&'a Path>,
    /// Where the normals go, in object space.
    pub normals: Option<&'a Path>,
    /// Where the displacement goes, always with 16 bits.
    pub displacement: Option<&'a Path>,
    /// Texels along a side.
    pub size: usize,
    /// Of colours and normals.
    pub depth: Depth,
}

impl Maps<'_> {
    /// The paths that are written.
    pub fn paths(&self) -> impl Iterator<Item = &Path> {
        let all = [self.colors, self.normals, self.displacement];
        all.into_iter().flatten()
    }

    /// Whether these maps can be baked, to know before a long run.
    ///
    /// # Errors
    /// What [`Self::write`] would say whatever the positions.
    pub fn check(&self, source: &Source, painted: &Path) -> Result<(), BakeError> {
        check_size(self.size)?;
        let has_uvs = source.file().is_some_and(|file| file.contents().has_uvs());
        if !has_uvs {
            return Err(BakeError::NoUvs);
        }
        self.colors.map(|_| Paint::read(painted)).transpose()?;
        Ok(())
    }

    /// Bakes and writes the maps of a source that lies at `draped`; `painted` is the file of the target with its colours.
    ///
    /// # Errors
    /// As [`Bake::new`], [`Paint::read`] where colours are asked for, or a file that cannot be written.
    pub fn write(
        &self,
        (source, draped): (&Source, &Positions),
        target: &Target,
        painted: &Path,
    ) -> Result<Vec<BakeFinding>, BakeError> {
        let paint = self.colors.map(|_| Paint::read(painted)).transpose()?;
        let bake = Bake::new(source, draped, target, self.size)?;
        let mut findings = bake.findings().to_vec();
        if let (Some(path), Some(paint)) = (self.colors, &paint) {
            let (texture, share) = bake.colors(paint)?;
            texture.save(path, self.depth)?;
            if share > 0.0 {
                findings.push(BakeFinding::Unpainted { share });
            }
        }
        if let Some(path) = self.normals {
            bake.normals().save(path, self.depth)?;
        }
        if let Some(path) = self.displacement {
            let (texture, scale) = bake.displacement();
            texture.save(path, Depth::Sixteen)?;
            findings.push(BakeFinding::Displacement { scale });
        }
        Ok(findings)
    }
}
