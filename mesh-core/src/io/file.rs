//! A file in memory: what it holds, and the way back.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::contents::{unit, Contents, Morphs};
use super::document::{Document, Parsed, Unmovable};
use super::encoding::Encoding;
use super::error::{ReadError, ReadProblem, WriteError};
use super::fault::{check_size, Fault};
use super::finding::Finding;
use super::format::Format;
use super::looks::{read_pictures, Looks};
use super::save::{check_finite, encode, packed_as_named, write_atomic};
use super::{conversion, encoding, gzip, input};
use crate::{Point3, PolygonSoup, Positions, Vector3};

/// A mesh file in memory, with everything needed to write it back with new positions.
#[derive(Clone, Debug)]
pub struct MeshFile {
    path: PathBuf,
    format: Format,
    encoding: Encoding,
    soup: PolygonSoup,
    contents: Contents,
    findings: Vec<Finding>,
    document: Arc<dyn Document>,
    morphs: Morphs,
}

/// The points of a file, without connectivity.
#[derive(Clone, Debug, PartialEq)]
pub struct PointSet {
    /// One point per vertex.
    pub points: Vec<Point3>,
    /// One unit normal per point, if the file has normals; zero where it has none.
    pub normals: Option<Vec<Vector3>>,
}

/// Reads a mesh, and keeps its bytes so that it can be written back.
///
/// A file without a face is read (it may be a cloud); a file without a vertex is not. Of a pipe at most 4 GiB are
/// read; a device is refused.
///
/// ```
/// use mesh_core::{io, Positions};
/// let path = std::env::temp_dir().join("mesh_core_doc_triangle.obj");
/// std::fs::write(&path, "# mine\nv 0 0 0\nv 1 0 0 # tip\nv 0 1 0\nf 1 2 3\n")?;
///
/// let file = io::read_mesh(&path)?;
/// let (mesh, mut x) = file.soup().clone().into_halfedge()?;
/// x.as_mut_slice()[1].x = 2.5;
/// file.write(&path, &x)?;
///
/// let text = std::fs::read_to_string(&path)?;
/// assert_eq!(text, "# mine\nv 0 0 0\nv 2.5 0 0 # tip\nv 0 1 0\nf 1 2 3\n");
/// # std::fs::remove_file(&path)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// The first thing that is wrong with the file, and where.
pub fn read_mesh(path: impl AsRef<Path>) -> Result<MeshFile, ReadError> {
    let path = path.as_ref();
    let bytes = input::read(path).map_err(|fault| fault.of(path))?;
    MeshFile::from_bytes(path, bytes)
}

/// Reads a mesh from what is no file, at most 4 GiB of it. `name` is how messages call it; its extension tells the format
/// where the content does not.
///
/// # Errors
/// As [`read_mesh`].
pub fn read_stream(name: impl AsRef<Path>, from: impl Read) -> Result<MeshFile, ReadError> {
    let name = name.as_ref();
    let bytes = input::read_stream(from).map_err(|fault| fault.of(name))?;
    MeshFile::from_bytes(name, bytes)
}

/// Reads the points and faces of a file, and nothing else.
///
/// # Errors
/// As [`read_mesh`].
pub fn read_soup(path: impl AsRef<Path>) -> Result<PolygonSoup, ReadError> {
    read_mesh(path).map(|file| file.soup)
}

/// Reads the points of a file, and their normals if there are any.
///
/// # Errors
/// As [`read_mesh`].
pub fn read_points(path: impl AsRef<Path>) -> Result<PointSet, ReadError> {
    let file = read_mesh(path)?;
    Ok(PointSet {
        normals: file.vertex_normals(),
        points: file.soup.positions,
    })
}

impl MeshFile {
    /// Reads the content of a file called `path`; no file is opened but the buffers that a glTF document names.
    ///
    /// # Errors
    /// As [`read_mesh`].
    pub fn from_bytes(path: impl AsRef<Path>, bytes: Vec<u8>) -> Result<Self, ReadError> {
        let path = path.as_ref();
        let bytes = match gzip::is_packed(&bytes) {
            true => gzip::unpack(&bytes).map_err(|fault| fault.of(path))?,
            false => bytes,
        };
        let (bytes, encoding) = encoding::decode(bytes).map_err(|fault| fault.of(path))?;
        let (format, parsed) = parse(bytes, path).map_err(|fault| fault.of(path))?;
        Ok(Self {
            path: path.to_owned(),
            format,
            encoding,
            soup: parsed.soup,
            contents: parsed.contents,
            findings: parsed.findings,
            document: parsed.document.into(),
            morphs: Morphs::Keep,
        })
    }

    /// What becomes of morph targets when this file is written; [`Morphs::Keep`] unless told.
    pub fn set_morphs(&mut self, morphs: Morphs) {
        self.morphs = morphs;
    }

    /// The path it was read from.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The format it is in.
    pub fn format(&self) -> Format {
        self.format
    }

    /// Its points and faces, in the order of the file.
    pub fn soup(&self) -> &PolygonSoup {
        &self.soup
    }

    /// Its points and faces, and nothing else.
    pub fn into_soup(self) -> PolygonSoup {
        self.soup
    }

    /// What else is in it.
    pub fn contents(&self) -> &Contents {
        &self.contents
    }

    /// What was not read, or not as the file says of itself; whoever shows the mesh should show these, too.
    pub fn findings(&self) -> &[Finding] {
        &self.findings
    }

    /// One unit normal per vertex, if the file has normals; zero where a vertex has none.
    pub fn vertex_normals(&self) -> Option<Vec<Vector3>> {
        let mut normals = self.document.vertex_normals(&self.soup)?;
        for n in &mut normals {
            *n = unit(*n).unwrap_or_default();
        }
        Some(normals)
    }

    /// The values of a scalar that a PLY file has at each vertex; none in other formats, or where it has no such one.
    ///
    /// ```
    /// use mesh_core::io::MeshFile;
    /// let text = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n\
    ///             property uchar mouth\nend_header\n0 0 0 1\n1 0 0 0\n";
    /// let file = MeshFile::from_bytes("a.ply", text.into())?;
    /// assert_eq!(file.vertex_scalars("mouth"), Some(vec![1.0, 0.0]));
    /// assert_eq!(file.vertex_scalars("nose"), None);
    /// # Ok::<(), mesh_core::io::ReadError>(())
    /// ```
    pub fn vertex_scalars(&self, name: &str) -> Option<Vec<f64>> {
        self.document.vertex_scalars(name)
    }

    /// What the file says of the looks of its surface. The libraries and pictures that it names are read from its folder
    /// and what is below, each time this is asked; those that are not there are left out.
    pub fn looks(&self) -> Looks {
        let folder = self.path.parent().unwrap_or(Path::new(""));
        let uvs = self.document.shown_uvs(&self.soup);
        let corner_uvs = uvs.map(|uvs| {
            let faces = self.soup.faces.iter().enumerate();
            let corners = faces.map(|(f, corners)| (0..corners.len()).map(move |c| (f, c)));
            corners
                .map(|corners| corners.map(|(f, c)| uvs.at(f, c)).collect())
                .collect()
        });
        let n_faces = self.soup.faces.len();
        let pictures = self.document.pictures(&self.contents, n_faces, folder);
        Looks {
            vertex_colors: self.document.vertex_colors(self.soup.positions.len()),
            corner_uvs,
            pictures: read_pictures(pictures, folder),
        }
    }

    /// Writes this file with the vertices at `x`, all or nothing.
    ///
    /// In the format of the source, everything but positions and normals is kept as it was. If the extension of `path`
    /// names another format, points and faces are converted ([`Self::lost_in`] tells what is not).
    ///
    /// # Errors
    /// Not one finite position per vertex, an extension whose format is not written, or a file that cannot be written.
    pub fn write(&self, path: impl AsRef<Path>, x: &Positions) -> Result<(), WriteError> {
        let path = path.as_ref();
        write_atomic(path, &self.to_bytes(path, x)?)
    }

    /// Whether this file can be written to `path` in the format of its extension: to know before a long run.
    ///
    /// # Errors
    /// What [`Self::write`] would say whatever the positions.
    pub fn check_writable(&self, path: impl AsRef<Path>) -> Result<(), WriteError> {
        if !self.keeps_format(path) {
            return Ok(());
        }
        let found = self.document.find_unmovable(self.morphs);
        match found.map_err(|fault| fault.of(&self.path))? {
            None => Ok(()),
            Some(Unmovable { feature, advice }) => Err(WriteError::Unsupported {
                path: self.path.clone(),
                feature,
                advice,
            }),
        }
    }

    /// What [`Self::write`] would write to `path`.
    ///
    /// # Errors
    /// As [`Self::write`], but for those of the file system.
    pub fn to_bytes(&self, path: impl AsRef<Path>, x: &Positions) -> Result<Vec<u8>, WriteError> {
        let path = path.as_ref();
        let (expected, found) = (self.soup.positions.len(), x.len());
        if found != expected {
            let path = path.to_owned();
            return Err(WriteError::WrongCount {
                path,
                expected,
                found,
            });
        }
        check_finite(path, x.as_slice())?;

        let bytes = match self.output_format(path) {
            format if format == self.format => self.rewrite(path, x.as_slice())?,
            format => encode(
                path,
                format,
                &PolygonSoup {
                    positions: x.as_slice().to_vec(),
                    faces: self.soup.faces.clone(),
                },
                self.document.corner_uvs(&self.soup).as_ref(),
            )?,
        };
        Ok(packed_as_named(path, bytes))
    }

    /// Whether this file is written to `path` in the format it was read in.
    pub fn keeps_format(&self, path: impl AsRef<Path>) -> bool {
        self.output_format(path.as_ref()) == self.format
    }

    /// The format in which this file would be written to `path`: the source's unless the extension names another.
    fn output_format(&self, path: &Path) -> Format {
        Format::of_extension(path).unwrap_or(self.format)
    }

    fn rewrite(&self, path: &Path, moved: &[Point3]) -> Result<Vec<u8>, WriteError> {
        if moved != self.soup.positions {
            self.check_writable(path)?;
        }
        let rewritten = self.document.rewrite(&self.soup, moved, self.morphs);
        let rewritten = rewritten.map_err(|fault| fault.of(&self.path))?;
        Ok(self.encoding.encode(rewritten))
    }

    /// What would be lost if this file were written to `path`, in words; none if all is kept.
    pub fn lost_in(&self, path: impl AsRef<Path>) -> Option<String> {
        let format = self.output_format(path.as_ref());
        if format == self.format {
            return None;
        }
        conversion::lost(self.format, format, &self.soup, &self.contents)
    }
}

fn parse(bytes: Vec<u8>, path: &Path) -> Result<(Format, Parsed), Fault> {
    if bytes.is_empty() {
        return Err(Fault::whole(ReadProblem::Empty));
    }
    let format =
        Format::detect(&bytes, path).ok_or_else(|| Fault::whole(ReadProblem::UnknownFormat))?;
    let codec = format.codec();
    let name = codec.name;
    // Zeros at the end are padding.
    let n_zeros = bytes.iter().rev().take_while(|&&b| b == 0).count();
    if codec.is_text && bytes[..bytes.len() - n_zeros].contains(&0) {
        return Err(Fault::whole(ReadProblem::Binary { format: name }));
    }
    let parsed = (codec.read)(bytes, path)?;
    if parsed.soup.positions.is_empty() {
        return Err(Fault::whole(ReadProblem::NoVertices { format: name }));
    }
    check_size(&parsed.soup.positions)?;
    let most = u32::MAX as usize;
    if parsed.soup.positions.len() >= most || parsed.soup.faces.len() >= most {
        return Err(Fault::whole(ReadProblem::TooMany));
    }
    Ok((format, parsed))
}
