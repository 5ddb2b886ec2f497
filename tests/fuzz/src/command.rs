//! The whole command on files that anyone may hand to it. What it prints is not looked at; that it comes back is.

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

/// Extensions that results are written with.
const OUTPUTS: [&str; 8] = ["obj", "ply", "off", "stl", "gltf", "glb", "xyz", "obj.gz"];
/// Extensions that the file bears; the content tells the format, or contradicts it.
const INPUTS: [&str; 8] = ["obj", "ply", "off", "stl", "gltf", "glb", "xyz", "bin"];
const BALL: &str = "ball.obj";
/// Ten iterations over few samples.
const TEN: &str =
    "[sampling]\nn_samples = 300\nmax_samples = 300\nn_hard = 30\n[[stages]]\nn_iterations = 10\n";

/// A folder with a ball, landmarks on it, and settings of ten iterations.
pub struct Place {
    folder: PathBuf,
}

impl Place {
    /// Makes the folder.
    ///
    /// # Panics
    /// If it cannot be written.
    pub fn new(folder: &Path) -> Self {
        fs::create_dir_all(folder).expect("a folder");
        let place = Self {
            folder: folder.to_owned(),
        };
        place.write(BALL, octahedron().as_bytes());
        place.write(
            "ten.toml",
            format!("initial = \"standard\"\n{TEN}").as_bytes(),
        );
        place.write("tried.toml", TEN.as_bytes());
        place.write("lm.txt", b"0 1 0 0\n1 -1 0 0\n2 0 1 0\n3 0 -1 0\n4 0 0 1\n");
        place
    }

    /// A mesh file in every role: looked at, draped over a ball with the result in some format, or draped over. The first
    /// two bytes choose, the others are the file.
    pub fn mesh_file(&self, bytes: &[u8]) {
        let [role, kind, content @ ..] = bytes else {
            return;
        };
        let pick = |list: [&'static str; 8], by: u8| list[usize::from(by % 8)];
        let name = format!("in.{}", pick(INPUTS, *kind));
        let output = format!("out.{}", pick(OUTPUTS, kind / 8));
        let config = if kind / 64 == 0 {
            "tried.toml"
        } else {
            "ten.toml"
        };
        self.write(&name, content);
        match role % 4 {
            0 => self.drape(&["inspect", &name, "--json", "--hidden"]),
            1 => self.drape(&["transfer", BALL, &name, "--config", config, "-o", &output]),
            2 => self.drape(&["transfer", &name, BALL, "--config", config, "-o", &output]),
            _ => self.drape(&["init", &name, &name, "-l", "lm.txt", "-o", &output]),
        }
        self.remove(&[&name, &output]);
    }

    /// Landmarks, settings, a session or a warp through the command line. The first byte chooses, the others are the file.
    pub fn papers(&self, bytes: &[u8]) {
        let [role, content @ ..] = bytes else {
            return;
        };
        let drape = |name: &str, more: &[&str]| {
            self.write(name, content);
            let short = ["transfer", BALL, BALL, "-o", "out.obj"];
            self.drape(&[&short[..], more].concat());
            self.remove(&[name, "out.obj"]);
        };
        match role % 5 {
            0 => drape("in.json", &["-l", "in.json", "--config", "ten.toml"]),
            // Settings may ask for hours of work: those are read, and then there are no landmarks.
            1 if is_short(content) => drape("in.toml", &["-l", "lm.txt", "--config", "in.toml"]),
            1 => drape("in.toml", &["-l", "none.txt", "--config", "in.toml"]),
            2 => {
                self.write("in.json", content);
                self.drape(&["landmarks", "check", BALL, BALL, "in.json"]);
                self.remove(&["in.json"]);
            }
            3 if is_short(content) => {
                self.write("in.session", &self.session(content));
                self.drape(&["replay", "in.session", "-o", "out.obj"]);
                self.remove(&["in.session", "out.obj"]);
            }
            3 => (),
            _ => {
                self.write("in.drape", &summed(content));
                self.drape(&["apply", "in.drape", BALL, "-o", "out.obj"]);
                self.remove(&["in.drape", "out.obj"]);
            }
        }
    }

    /// A session whose inputs are the ball and whose check sum is right, which chance would not meet.
    fn session(&self, text: &[u8]) -> Vec<u8> {
        let Ok(mut session) = serde_json::from_slice::<serde_json::Value>(text) else {
            return text.to_vec();
        };
        let ball = fs::read(self.folder.join(BALL)).unwrap_or_default();
        let record = serde_json::json!({
            "path": self.folder.join(BALL), "fnv1a": format!("{:016x}", fnv1a(&ball)),
        });
        let Some(all) = session.as_object_mut() else {
            return text.to_vec();
        };
        for input in ["source", "target"] {
            if let Some(there) = all.get_mut(input) {
                *there = record.clone();
            }
        }
        all.remove("check_sum");
        let sum = fnv1a(session.to_string().as_bytes());
        session["check_sum"] = format!("{sum:016x}").into();
        session.to_string().into_bytes()
    }

    fn write(&self, name: &str, bytes: &[u8]) {
        fs::write(self.folder.join(name), bytes).expect("a file is written");
    }

    fn remove(&self, names: &[&str]) {
        for name in names {
            // A result that was refused is not there.
            let _ = fs::remove_file(self.folder.join(name));
        }
    }

    /// Runs the command; words that name a file are taken as files of the folder.
    fn drape(&self, words: &[&str]) {
        let is_file = |word: &str| word.contains('.') && !word.starts_with('-');
        let argument = |word: &&str| -> OsString {
            match is_file(word) {
                true => self.folder.join(word).into(),
                false => word.into(),
            }
        };
        let arguments = words.iter().map(argument);
        let _ = drape_cli::run(std::iter::once("drape".into()).chain(arguments));
    }
}

/// Whether a file names its iterations, and no number of anything that is work is large.
fn is_short(content: &[u8]) -> bool {
    const WORK: [&str; 9] = [
        "n_iterations",
        "n_samples",
        "max_samples",
        "n_hard",
        "width",
        "n_hidden_layers",
        "count",
        "extended\"",
        "iteration\"",
    ];
    const MOST: f64 = 300.0;
    let text = String::from_utf8_lossy(content);
    let is_small = |after: &str| {
        let number = after.trim_start_matches([' ', '=', ':']);
        let end = number.find(|c: char| !c.is_ascii_alphanumeric() && !".+-_".contains(c));
        let number = &number[..end.unwrap_or(number.len())];
        number.parse::<f64>().is_ok_and(|n| n <= MOST)
    };
    let is_bounded = |key: &&str| text.split(key).skip(1).all(is_small);
    text.contains("[[stages]]") && text.contains("n_iterations") && WORK.iter().all(is_bounded)
}

/// `content` with its last eight bytes replaced by the check sum of what stands before.
fn summed(content: &[u8]) -> Vec<u8> {
    let content = &content[..content.len().saturating_sub(8)];
    [content, &fnv1a(content).to_le_bytes()].concat()
}

fn fnv1a(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

/// A ball of 66 vertices as OBJ: an octahedron whose faces are cut into sixteen.
fn octahedron() -> String {
    const N: i32 = 4;
    let mut text = String::new();
    let mut rows = std::collections::BTreeMap::new();
    let mut faces = String::new();
    for signs in 0..8 {
        let sign = |axis: i32| if signs >> axis & 1 == 0 { 1 } else { -1 };
        let turns = sign(0) * sign(1) * sign(2);
        let mut row = |i: i32, j: i32| {
            let p = [sign(0) * i, sign(1) * j, sign(2) * (N - i - j)];
            let next = rows.len() + 1;
            *rows.entry(p).or_insert_with(|| {
                let length = f64::from(p.iter().map(|c| c * c).sum::<i32>()).sqrt();
                let [x, y, z] = p.map(|c| f64::from(c) / length);
                text += &format!("v {x} {y} {z}\n");
                next
            })
        };
        for i in 0..N {
            for j in 0..N - i {
                let mut triangle = |corners: [(i32, i32); 3]| {
                    let [a, b, c] = corners.map(|(i, j)| row(i, j));
                    let (b, c) = if turns > 0 { (b, c) } else { (c, b) };
                    faces += &format!("f {a} {b} {c}\n");
                };
                triangle([(i, j), (i + 1, j), (i, j + 1)]);
                if i + j + 1 < N {
                    triangle([(i + 1, j), (i + 1, j + 1), (i, j + 1)]);
                }
            }
        }
    }
    text + &faces
}
