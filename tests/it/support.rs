//! Runs the command on small files built in code.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use mesh_core::{io, shapes, Point3, PolygonSoup};
use tempfile::TempDir;

/// A folder with a source, a target, landmarks and short settings.
pub(crate) struct Workplace {
    folder: TempDir,
}

/// How a command ended.
pub(crate) struct Ended {
    pub(crate) code: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Ended {
    /// The result of a command that must have succeeded.
    pub(crate) fn well(self) -> Self {
        assert_eq!(self.code, Some(0), "{}", self.stderr);
        self
    }

    pub(crate) fn json(&self) -> serde_json::Value {
        serde_json::from_str(&self.stdout).expect("the command prints JSON")
    }
}

impl Workplace {
    pub(crate) fn new() -> Self {
        let place = Self {
            folder: tempfile::tempdir().expect("a temporary folder"),
        };
        place.write("source.obj", &source_obj());
        place.write("landmarks.json", LANDMARKS);
        place.write("short.toml", "[[stages]]\nn_iterations = 12\n");
        io::write_soup(place.path("target.ply"), &target()).expect("the target is written");
        place
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).expect("a file is written");
    }

    pub(crate) fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).expect("the file is there")
    }

    pub(crate) fn exists(&self, name: &str) -> bool {
        self.path(name).exists()
    }

    /// Runs `drape` with a line of arguments, in the folder.
    pub(crate) fn drape(&self, line: &str) -> Ended {
        run(self.folder.path(), line.split_whitespace())
    }

    /// A short drape of the standard files, with more arguments.
    pub(crate) fn transfer(&self, more: &str) -> Ended {
        self.drape(&format!(
            "transfer source.obj target.ply --landmarks landmarks.json --config short.toml -o out.obj {more}"
        ))
    }
}

/// Runs `drape` in a folder.
pub(crate) fn run<'a>(folder: &Path, arguments: impl IntoIterator<Item = &'a str>) -> Ended {
    let Output {
        status,
        stdout,
        stderr,
    } = Command::new(env!("CARGO_BIN_EXE_drape-under-test"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .expect("the command starts");
    Ended {
        code: status.code(),
        stdout: String::from_utf8(stdout).expect("text"),
        stderr: String::from_utf8(stderr).expect("text"),
    }
}

/// A sphere of quads and one triangle fan, with everything an OBJ file may carry.
fn source_obj() -> String {
    let PolygonSoup { positions, faces } = shapes::quad_sphere(6);
    let mut text = String::from("# my mesh\r\nmtllib not_there.mtl\no ball\n");
    for p in &positions {
        text += &format!("v  {:.7} {:.7}\t{:.7}  # kept\n", p.x, p.y, p.z);
    }
    text += "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n";
    for (row, face) in faces.iter().enumerate() {
        if row % 36 == 0 {
            text += &format!("g side{}\nusemtl skin\ns {}\n", row / 36, row / 36 + 1);
        }
        let corners = face
            .iter()
            .enumerate()
            .map(|(k, v)| format!(" {}/{}/1", v + 1, k + 1));
        text += &format!("f{}\n", corners.collect::<String>());
    }
    text + "# the end\n"
}

/// A longer, larger and moved ball of triangles.
fn target() -> PolygonSoup {
    let mut soup = shapes::icosphere(3);
    for p in &mut soup.positions {
        *p = Point3::new(4.0 * p.x + 10.0, 3.0 * p.y, 2.5 * p.z - 5.0);
    }
    soup
}

/// One place on each side, by all the ways a landmark can be given.
const LANDMARKS: &str = r#"{"landmarks": [
  {"name": "right", "source": {"point": [1, 0, 0]}, "target": {"point": [14, 0, -5]}},
  {"name": "left", "source": {"point": [-1, 0, 0]}, "target": {"point": [6, 0, -5]}},
  {"name": "top", "source": {"point": [0, 1, 0]}, "target": {"point": [10, 3, -5]}},
  {"name": "bottom", "source": {"point": [0, -1, 0]}, "target": {"point": [10, -3, -5]}},
  {"name": "front", "source": {"point": [0, 0, 1]}, "target": {"point": [10, 0, -2.5]}},
  {"name": "back", "source": {"point": [0, 0, -1]}, "target": {"point": [10, 0, -7.5]}}]}"#;
