//! Damaged files are read or refused; nothing panics, hangs or fills the memory.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::sync::LazyLock;

use mesh_core::io::{Format, MeshFile};
use mesh_core::Positions;
use proptest::prelude::*;

use crate::io_gltf;

/// A change to the bytes of a file.
#[derive(Clone, Debug)]
enum Damage {
    Set(prop::sample::Index, u8),
    Cut(prop::sample::Index),
    Remove(prop::sample::Index, usize),
    Repeat(prop::sample::Index, usize),
    Insert(prop::sample::Index, &'static str),
}

const WORDS: [&str; 22] = [
    " ",
    "\n",
    "\\\n",
    "#",
    "-1",
    "0",
    "99999999999999999999",
    "4294967295",
    "1e308",
    "nan",
    "-",
    "/",
    "//",
    "f",
    "v",
    "vn",
    "list",
    "element",
    "property",
    "OFF",
    "ply\n",
    "\0",
];

fn damage() -> impl Strategy<Value = Damage> {
    let at = || any::<prop::sample::Index>();
    prop_oneof![
        (at(), any::<u8>()).prop_map(|(at, byte)| Damage::Set(at, byte)),
        at().prop_map(Damage::Cut),
        (at(), 1..9usize).prop_map(|(at, n)| Damage::Remove(at, n)),
        (at(), 1..40usize).prop_map(|(at, n)| Damage::Repeat(at, n)),
        (at(), prop::sample::select(WORDS.to_vec()))
            .prop_map(|(at, word)| Damage::Insert(at, word)),
    ]
}

fn apply(bytes: &mut Vec<u8>, damage: &Damage) {
    if bytes.is_empty() {
        return;
    }
    let n = bytes.len();
    match damage {
        Damage::Set(at, byte) => bytes[at.index(n)] = *byte,
        Damage::Cut(at) => bytes.truncate(at.index(n)),
        Damage::Remove(at, k) => drop(bytes.drain(at.index(n)..n.min(at.index(n) + k))),
        Damage::Repeat(at, k) => {
            let from = at.index(n);
            bytes.extend_from_within(from..n.min(from + k));
        }
        Damage::Insert(at, word) => drop(bytes.splice(at.index(n)..at.index(n), word.bytes())),
    }
}

/// Reads `bytes`, and where that works, writes them back unchanged and changed.
fn survive(name: &str, bytes: Vec<u8>) -> Result<(), TestCaseError> {
    let Ok(file) = MeshFile::from_bytes(name, bytes.clone()) else {
        return Ok(());
    };
    prop_assert!(file.soup().check().is_ok());
    let x = Positions::from(file.soup().positions.clone());
    let unchanged = file.to_bytes(name, &x);
    prop_assert_eq!(unchanged.ok(), Some(bytes));

    let n = x.len();
    let moved: Positions = (0..n)
        .map(|row| [1.5, -0.25, row as f64 + 0.5].into())
        .collect();
    if matches!(file.format(), Format::Gltf | Format::Glb) {
        // Wild transforms may have no way back: it is enough that nothing breaks.
        let _ = (file.to_bytes(name, &moved), file.vertex_normals());
        return Ok(());
    }
    let bytes = file
        .to_bytes(name, &moved)
        .map_err(|e| TestCaseError::fail(e.to_string()))?;
    let again =
        MeshFile::from_bytes(name, bytes).map_err(|e| TestCaseError::fail(e.to_string()))?;
    prop_assert_eq!(&again.soup().positions, moved.as_slice());
    prop_assert_eq!(&again.soup().faces, &file.soup().faces);
    let _ = file.vertex_normals();
    Ok(())
}

const OBJ: &str = "# c\nmtllib a.mtl\no a\nv 0 0 0 1\nv 1 0 0\nv 0 1 \\\n0\nv 0 0 1\nvt 0 0\nvn 0 0 1\ng a b\ns 1\n\
                   usemtl m\nf 1/1/1 2/1/1 3/1/1\nf -4//1 2//-1 4\nl 1 2\n";
const OFF: &str = "NOFF\n# c\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2 255 0 0\n";
const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                   property float nx\nproperty float ny\nproperty float nz\nelement face 1\n\
                   property list uchar int vertex_indices\nend_header\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n";

const STL: &str = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n\
                   endsolid a\n";
const XYZ: &str = "x,y,z,nx,ny,nz\n0,0,0,0,0,1\n1,0,0,0,0,1\n";

fn binary_stl() -> Vec<u8> {
    let mut bytes = vec![0; 84 + 2 * 50];
    bytes[80] = 2;
    bytes[84 + 24..84 + 28].copy_from_slice(&1f32.to_le_bytes());
    bytes[84 + 66..84 + 70].copy_from_slice(&1f32.to_le_bytes());
    bytes
}

/// Whole files to damage.
static SEEDS: LazyLock<Vec<(&str, Vec<u8>)>> = LazyLock::new(|| {
    let faces = MeshFile::from_bytes("a.obj", OBJ.into()).unwrap();
    let x = Positions::from(faces.soup().positions.clone());
    vec![
        ("a.obj", OBJ.into()),
        ("a.off", OFF.into()),
        ("a.ply", PLY.into()),
        ("a.stl", STL.into()),
        ("a.stl", binary_stl()),
        ("a.xyz", XYZ.into()),
        ("a.glb", io_gltf::glb()),
        ("a.gltf", io_gltf::document(&io_gltf::data_uri()).into()),
        ("a.ply", faces.to_bytes("a.ply", &x).unwrap()),
    ]
});

/// Enough cases for every run of the tests; `PROPTEST_CASES` asks for more.
fn config() -> ProptestConfig {
    let mut config = ProptestConfig::default();
    if std::env::var_os("PROPTEST_CASES").is_none() {
        config.cases = 4000;
    }
    config.failure_persistence = None;
    config
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn damaged_files(seed in 0..SEEDS.len(), damages in prop::collection::vec(damage(), 1..6)) {
        let (name, mut bytes) = SEEDS[seed].clone();
        for damage in &damages {
            apply(&mut bytes, damage);
        }
        survive(name, bytes)?;
    }

    #[test]
    fn junk(bytes in prop::collection::vec(any::<u8>(), 0..200), name in prop::sample::select(vec!["a.obj", "a.off", "a.ply", "a.stl", "a.xyz", "a.gltf", "a.glb", "a"])) {
        survive(name, bytes)?;
    }
}
