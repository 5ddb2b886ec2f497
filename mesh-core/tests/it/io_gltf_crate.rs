//! The crate `gltf` as a second opinion: it reads what is written here. It refuses documents that other programs write and
//! read, which is why the reader here is our own.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use mesh_core::{io, shapes, Point3, PolygonSoup};

use crate::io_gltf_dialects::{buffer, with};
use crate::io_support::{file, glb_file};

/// Points and triangles of a binary file, as the crate reads them.
fn read_by_the_crate(bytes: &[u8]) -> PolygonSoup {
    let read = gltf::Gltf::from_slice(bytes).unwrap();
    let blob = read.blob.as_deref();
    let mesh = read.document.meshes().next().unwrap();
    let primitive = mesh.primitives().next().unwrap();
    let reader = primitive.reader(|_| blob);
    let point = |p: [f32; 3]| Point3::from(p.map(f64::from));
    let indices: Vec<u32> = reader.read_indices().unwrap().into_u32().collect();
    PolygonSoup {
        positions: reader.read_positions().unwrap().map(point).collect(),
        faces: indices.chunks(3).map(<[u32]>::to_vec).collect(),
    }
}

#[test]
fn the_crate_reads_what_is_written() {
    let folder = std::env::temp_dir().join(format!("mesh-core-gltf-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    for soup in [shapes::tetrahedron(), shapes::icosphere(2)] {
        let path = folder.join("a.glb");
        io::write_soup(&path, &soup).unwrap();
        let there = read_by_the_crate(&std::fs::read(&path).unwrap());
        assert_eq!(there.faces, soup.faces);
        for (a, b) in there.positions.iter().zip(&soup.positions) {
            assert!((a - b).norm() < 1e-6, "{a} {b}");
        }
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn documents_that_the_crate_refuses_are_read() {
    let version = r#""version": "2.0""#;
    let changes = [
        (version, r#""version": "2.0", "extras": 5"#),
        (version, r#""version": "2.0", "extras": [1, "a"]"#),
        (
            r#""count": 3, "type": "SCALAR""#,
            r#""count": 3.0, "type": "SCALAR""#,
        ),
    ];
    for (from, to) in changes {
        let bytes = glb_file(&with(&[(from, to)]), &buffer());
        assert!(gltf::Gltf::from_slice(&bytes).is_err(), "{to}");
        assert_eq!(file("a.glb", &bytes).soup().faces, [[0, 1, 2]], "{to}");
    }
}
