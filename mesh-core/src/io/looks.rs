//! What a file says of the looks of its surface: colours of vertices, texture coordinates, pictures.

use std::collections::HashMap;
use std::ops::Range;
use std::path::{Component, Path, PathBuf};

use super::contents::Contents;
use super::input;

/// Red, green and blue, each from 0 to 1, as the file gives them.
pub type Rgb = [f32; 3];

/// What a file says of the looks of its surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Looks {
    /// One colour per vertex; none where the file has none.
    pub vertex_colors: Option<Vec<Rgb>>,
    /// For each corner of each face its texture coordinate, (0, 0) at the lower left of the picture; none where the
    /// corner has none. None at all where the file has no coordinates.
    pub corner_uvs: Option<Vec<Vec<Option<[f64; 2]>>>>,
    /// The pictures, each with the faces that show it.
    pub pictures: Vec<Picture>,
}

/// A picture on some faces.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Rows of the faces that show it, in runs.
    pub faces: Vec<Range<usize>>,
    /// Its file, as bytes: PNG, JPEG or whatever the mesh names.
    pub bytes: Vec<u8>,
}

/// Where the bytes of a picture are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum PictureAt {
    /// A file beside the mesh, by the name that the mesh gives it.
    File(String),
    /// In the mesh's own file.
    Bytes(Vec<u8>),
}

/// A picture and the faces that show it.
pub(super) type NamedPicture = (Vec<Range<usize>>, PictureAt);

/// The pictures that can be read; `folder` is that of the mesh.
pub(super) fn read_pictures(named: Vec<NamedPicture>, folder: &Path) -> Vec<Picture> {
    let read = |(faces, at): NamedPicture| {
        let bytes = match at {
            PictureAt::Bytes(bytes) => bytes,
            PictureAt::File(name) => input::read(&beside(folder, &name)?).ok()?,
        };
        Some(Picture { faces, bytes })
    };
    named.into_iter().filter_map(read).collect()
}

/// The pictures of the materials of an OBJ file: `map_Kd` of its libraries.
pub(super) fn of_libraries(contents: &Contents, folder: &Path) -> Vec<NamedPicture> {
    let libraries = contents.references.iter();
    let texts = libraries.filter_map(|name| input::read(&beside(folder, name)?).ok());
    let mut picture_of = HashMap::new();
    for text in texts {
        read_library(&String::from_utf8_lossy(&text), &mut picture_of);
    }
    let materials = contents.materials.iter();
    let shown = materials.filter_map(|material| {
        let name = picture_of.get(material.name.trim())?;
        Some((material.faces.clone(), PictureAt::File(name.clone())))
    });
    shown.collect()
}

/// The file of the picture of each material.
fn read_library(text: &str, picture_of: &mut HashMap<String, String>) {
    let mut material = String::new();
    for line in text.lines() {
        let line = line.trim();
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        match keyword.to_ascii_lowercase().as_str() {
            "newmtl" => rest.trim().clone_into(&mut material),
            "map_kd" => {
                let name = without_options(rest);
                picture_of.insert(material.clone(), name.to_owned());
            }
            _ => {}
        }
    }
}

/// The name of a picture without the options before it: `-bm 1 -o 0 0 0 skin.png`.
fn without_options(mut rest: &str) -> &str {
    rest = rest.trim();
    while rest.starts_with('-') {
        // Every option takes words that are numbers or on and off.
        let mut words = rest.split_inclusive(char::is_whitespace);
        let option = words.next().unwrap_or_default().len();
        let is_argument = |word: &&str| {
            let word = word.trim();
            word.parse::<f64>().is_ok() || matches!(word, "on" | "off")
        };
        let arguments: usize = words.take_while(is_argument).map(str::len).sum();
        rest = rest[option + arguments..].trim_start();
    }
    rest
}

/// The path of a file that a mesh names: in the folder of the mesh or below it. A path of another computer is taken as
/// the name at its end.
fn beside(folder: &Path, name: &str) -> Option<PathBuf> {
    let name = name.trim().trim_matches('"').replace('\\', "/");
    let path = Path::new(&name);
    let is_below = path
        .components()
        .all(|c| matches!(c, Component::Normal(_) | Component::CurDir));
    let inner = folder.join(path);
    if is_below && inner.is_file() {
        return Some(inner);
    }
    let alone = folder.join(path.file_name()?);
    alone.is_file().then_some(alone)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::read_mesh;

    #[test]
    fn a_library_names_pictures_with_options_and_blanks() {
        let mut pictures = HashMap::new();
        let text = "newmtl skin\nKd 1 1 1\nmap_Kd -bm 0.5 -clamp on my skin.png\nnewmtl eye\n map_kd eye.jpg \nnewmtl no";
        read_library(text, &mut pictures);
        assert_eq!(
            pictures.get("skin").map(String::as_str),
            Some("my skin.png")
        );
        assert_eq!(pictures.get("eye").map(String::as_str), Some("eye.jpg"));
        assert_eq!(pictures.get("no"), None);
    }

    #[test]
    fn an_obj_file_comes_with_its_picture_and_nothing_from_elsewhere() {
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path().join("in");
        std::fs::create_dir(&place).unwrap();
        std::fs::write(folder.path().join("secret.png"), b"secret").unwrap();
        std::fs::write(place.join("skin.png"), b"picture").unwrap();
        std::fs::write(
            place.join("a.mtl"),
            "newmtl a\nmap_Kd C:\\work\\skin.png\nnewmtl b\nmap_Kd ../secret.png\n",
        )
        .unwrap();
        let text =
            "mtllib a.mtl\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nvt 0 0\nvt 1 0\nvt 0.5 1\n\
                    usemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 1/1 3 2/2\n";
        std::fs::write(place.join("a.obj"), text).unwrap();
        let looks = read_mesh(place.join("a.obj")).unwrap().looks();
        let picture = Picture {
            faces: std::iter::once(0..1).collect(),
            bytes: b"picture".to_vec(),
        };
        assert_eq!(looks.pictures, [picture]);
        let colors = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert_eq!(looks.vertex_colors.as_deref(), Some(&colors[..]));
        let uvs = looks.corner_uvs.unwrap();
        assert_eq!(uvs[0], [[0.0, 0.0], [1.0, 0.0], [0.5, 1.0]].map(Some));
        assert_eq!(uvs[1], [Some([0.0, 0.0]), None, Some([1.0, 0.0])]);
    }

    #[test]
    fn a_ply_file_has_colours_coordinates_and_a_picture() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("scan.jpg"), b"picture").unwrap();
        let text = "ply\nformat ascii 1.0\ncomment TextureFile scan.jpg\nelement vertex 3\nproperty float x\n\
                    property float y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n\
                    element face 1\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\n\
                    end_header\n0 0 0 255 0 51\n1 0 0 0 0 0\n0 1 0 255 255 255\n3 0 1 2 6 0 0 1 0 0.5 1\n";
        let path = folder.path().join("a.ply");
        std::fs::write(&path, text).unwrap();
        let looks = read_mesh(&path).unwrap().looks();
        let colors = [[1.0, 0.0, 0.2], [0.0; 3], [1.0; 3]];
        assert_eq!(looks.vertex_colors.as_deref(), Some(&colors[..]));
        let uvs = [[0.0, 0.0], [1.0, 0.0], [0.5, 1.0]].map(Some).to_vec();
        assert_eq!(looks.corner_uvs, Some(vec![uvs]));
        assert_eq!(looks.pictures[0].bytes, b"picture");
        assert_eq!(
            looks.pictures[0].faces.as_slice(),
            std::slice::from_ref(&(0..1))
        );
    }
}
