//! Files written in another format than they were read in.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use mesh_core::io::{self, Format, MeshFile, WriteError};
use mesh_core::{shapes, Point3, PolygonSoup, Positions};

use crate::io_support::{file, rest};

const EXTENSIONS: [&str; 7] = ["obj", "off", "ply", "stl", "gltf", "glb", "xyz"];

/// `soup` written in the format of this extension and read again.
fn through(soup: &PolygonSoup, extension: &str) -> MeshFile {
    let path = std::env::temp_dir().join(format!(
        "mesh_core_convert_{}_{}.{extension}",
        std::process::id(),
        soup.faces.len()
    ));
    io::write_soup(&path, soup).unwrap();
    let read = io::read_mesh(&path).unwrap();
    std::fs::remove_file(&path).unwrap();
    read
}

fn triangles(soup: &PolygonSoup) -> usize {
    soup.faces.iter().map(|f| f.len() - 2).sum()
}

#[test]
fn every_format_is_written_and_read() {
    for soup in [
        shapes::icosphere(1),
        shapes::prism(5),
        shapes::open_grid(3, 2),
    ] {
        for extension in EXTENSIONS {
            let read = through(&soup, extension);
            let named = Format::of_extension(read.path());
            assert_eq!(Some(read.format()), named, "{extension}");
            let (found, expected) = (read.soup(), &soup);
            assert_eq!(
                found.positions.len(),
                expected.positions.len(),
                "{extension}"
            );
            match extension {
                "xyz" => assert!(found.faces.is_empty()),
                "stl" | "gltf" | "glb" => assert_eq!(found.faces.len(), triangles(expected)),
                _ => assert_eq!(found, expected),
            }
            if extension != "stl" {
                for (p, q) in found.positions.iter().zip(&expected.positions) {
                    assert!((p - q).norm() < 1e-7, "{extension}: {p} is not {q}");
                }
            }
            let area = |soup: &PolygonSoup| -> f64 {
                let target = mesh_core::TriangleSoup::new(soup.clone());
                target.map_or(0.0, |t| t.area())
            };
            if extension != "xyz" {
                assert!((area(found) - area(expected)).abs() < 1e-6, "{extension}");
            }
        }
    }
}

/// A square of two quads that share an edge in space but not in the texture, and a triangle without one.
const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\nv 0 2 0\nvt 0 0\nvt .25 0\nvt .25 1\nvt 0 1\n\
                   vt .75 0.5\nvt 1 0.5\nvt 1 1\nvt .75 1\ng left\nf 1/1 2/2 5/3 4/4\ng right\nusemtl skin\nf 2/5 3/6 6/7 5/8\nf 4 5 7\n";

#[test]
fn texture_coordinates_go_from_obj_to_glb_and_back() {
    let obj = file("a.obj", OBJ);
    for extension in ["glb", "gltf"] {
        let name = format!("a.{extension}");
        let read = file(&name, obj.to_bytes(&name, &rest(&obj)).unwrap());
        // Vertices 2, 4 and 5 are used with two coordinates each, 5 with three.
        assert_eq!(read.soup().positions.len(), 7 + 4);
        assert_eq!(read.soup().positions[..7], obj.soup().positions);
        assert_eq!(read.soup().weld(0.0).soup.positions.len(), 7);
        assert_eq!(read.contents().n_uvs, 11);
        let normals = read.vertex_normals().unwrap();
        assert!(normals
            .iter()
            .all(|n| (n - mesh_core::Vector3::z()).norm() < 1e-6));

        let back = read.to_bytes("b.obj", &rest(&read)).unwrap();
        let text = String::from_utf8(back.clone()).unwrap();
        for uv in ["vt 0.25 1\n", "vt 0.75 0.5\n", "vt 1 1\n"] {
            assert!(text.contains(uv), "{uv} in {text}");
        }
        let back = file("b.obj", back);
        assert_eq!(back.soup(), read.soup());
        assert!(text.contains("f 1/1 2/2 5/5\n"), "{text}");
    }
}

#[test]
fn one_line_tells_what_is_not_kept() {
    let obj = file("a.obj", OBJ);
    let told = |name: &str| obj.lost_in(name).unwrap();
    assert_eq!(
        told("a.glb"),
        "from OBJ to GLB, these are not kept: 2 groups, 1 material; 2 polygons become triangles; vertices are split \
         where texture coordinates differ; coordinates are rounded to single precision"
    );
    assert!(told("a.ply").contains("8 texture coordinates"));
    assert!(told("a.stl").contains("each triangle gets corners of its own"));
    assert!(told("a.xyz").contains("3 faces"));
    for name in EXTENSIONS.map(|e| format!("a.{e}")) {
        let told = obj.lost_in(&name).unwrap_or_default();
        assert_eq!(told.lines().count(), usize::from(name != "a.obj"), "{told}");
    }
    let plain = file("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    assert_eq!(plain.lost_in("a.off"), None);
}

#[test]
fn what_single_precision_cannot_hold_is_refused() {
    let obj = file("a.obj", "v 0 0 0\nv 1e60 0 0\nv 0 1 0\nf 1 2 3\n");
    for extension in ["stl", "glb", "gltf"] {
        match obj.to_bytes(format!("a.{extension}"), &rest(&obj)) {
            Err(WriteError::NotFinite { vertex: 1, .. }) => {}
            other => panic!("{extension}: {other:?}"),
        }
    }
    assert!(obj.to_bytes("a.ply", &rest(&obj)).is_ok());
    let mut wrong = shapes::tetrahedron();
    wrong.faces[2][1] = 9;
    let path = std::env::temp_dir().join("mesh_core_wrong_face.glb");
    assert!(matches!(
        io::write_soup(&path, &wrong),
        Err(WriteError::Faces { .. })
    ));
    assert!(!path.exists());
}

#[test]
fn loose_vertices_and_clouds_are_written() {
    let cloud = PolygonSoup {
        positions: vec![Point3::new(1.0, 2.0, 3.0), Point3::origin()],
        faces: Vec::new(),
    };
    let read = through(&cloud, "glb");
    assert_eq!(read.soup(), &cloud);
    let mut loose = shapes::tetrahedron();
    loose.positions.push(Point3::new(9.0, 9.0, 9.0));
    let read = through(&loose, "gltf");
    assert_eq!(read.soup().positions.len(), 5);
    let x = Positions::from(read.soup().positions.clone());
    assert!(read.check_writable("a.gltf").is_ok() && read.to_bytes("a.gltf", &x).is_ok());
}
