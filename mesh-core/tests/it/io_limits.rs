//! Messages that can be shown anywhere, and work that stays within bounds.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::time::Instant;

use mesh_core::io::{self, MeshFile};
use mesh_core::{Point3, PointCloud, PolygonSoup, TargetSurface, TriangleSoup, Triangulation};

use crate::io_support::{file, refusal};

#[test]
fn names_cannot_command_a_terminal() {
    let error = refusal("a\u{1b}[2J.obj", "v 0 0 \u{1b}[31m\n").to_string();
    assert_eq!(
        error,
        "a\\u{1b}[2J.obj:1: expected a number, found `\\u{1b}[31m`"
    );
    let ply = "ply\nformat ascii 1.0\nelement \u{7} 1000\nproperty int a\nelement vertex 1\nproperty float x\n\
               property float y\nproperty float z\nend_header\n0\n";
    let error = refusal("a.ply", ply).to_string();
    assert!(
        error.contains("rows of `\\u{7}` are promised") && !error.contains('\u{7}'),
        "{error}"
    );
    let shown = io::printable("a\u{202E}b\nc");
    assert_eq!(shown, "a\\u{202e}b\\nc");
}

#[test]
fn messages_name_formats_with_their_article() {
    let ply = "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    let message = refusal("a.ply", ply).to_string();
    assert!(message.contains("really a PLY file"), "{message}");
    let message = refusal("a.obj", "f\n").to_string();
    assert!(message.contains("really an OBJ file"), "{message}");
}

#[test]
fn coordinates_too_large_to_measure_with_are_refused_by_file_and_place() {
    let ply = "ply\nformat ascii 1.0\nelement vertex 1\nproperty double x\nproperty double y\nproperty double z\n\
               end_header\n0 -1e155 0\n";
    for (name, text, place) in [
        ("a.obj", "v 0 0 0\nv 0 -1e155 0\n", "a.obj:2: "),
        ("a.off", "OFF\n1 0 0\n0 -1e155 0\n", "a.off:3: "),
        ("a.xyz", "0 -1e155 0\n", "a.xyz:1: "),
        ("a.ply", ply, "a.ply:8: "),
    ] {
        let message = refusal(name, text).to_string();
        let expected = format!("{place}the coordinate `-1e155` is too large to measure with");
        assert!(message.starts_with(&expected), "{message}");
    }
}

#[test]
fn a_face_out_of_range_before_its_vertices_is_named() {
    let ply = "ply\nformat ascii 1.0\nelement face 2\nproperty list uchar int vertex_indices\nelement vertex 3\n\
               property float x\nproperty float y\nproperty float z\nend_header\n3 0 1 2\n3 0 1 7\n0 0 0\n1 0 0\n0 1 0\n";
    let message = refusal("a.ply", ply).to_string();
    assert!(
        message.starts_with("a.ply: face 1 (counted from 0): a face names vertex 7"),
        "{message}"
    );
}

/// Below the normal numbers no direction can be told from a length: nothing may break over that.
#[test]
fn subnormal_coordinates_break_nothing() {
    let text =
        "v 0 0 0\nv 5e-324 0 0\nv 0 1e-323 0\nv 0 0 2e-320\nf 1 2 3\nf 1 2 4\nf 2 3 4\nf 1 2 3 4\n";
    let message = refusal("a.obj", text).to_string();
    let expected = "a.obj: all vertices lie within 2e-320 of each other, too small to measure with";
    assert!(message.starts_with(expected), "{message}");
    assert_eq!(
        file("a.obj", text.replace("2e-320", "1"))
            .soup()
            .faces
            .len(),
        4
    );

    let positions = [
        [0.; 3],
        [5e-324, 0., 0.],
        [0., 1e-323, 0.],
        [0., 0., 2e-320],
    ];
    let soup = PolygonSoup {
        positions: positions.map(Point3::from).to_vec(),
        faces: vec![
            vec![0, 1, 2],
            vec![0, 1, 3],
            vec![1, 2, 3],
            vec![0, 1, 2, 3],
        ],
    };
    let target = TriangleSoup::new(soup.clone()).unwrap();
    assert_eq!(
        target.closest_point(&soup.positions[3]).distance_squared,
        0.0
    );
    let cloud = PointCloud::new(soup.positions.clone(), None).unwrap();
    assert!(cloud.closest_point(&soup.positions[3]).distance_squared >= 0.0);
    assert!(soup.weld(0.0).soup.positions.len() <= 4);
    let (mesh, rest) = soup.clone().into_halfedge().unwrap();
    assert!(Triangulation::new(&mesh, &rest).len() <= 5);
    for name in ["a.stl", "a.glb", "a.ply"] {
        let name = format!("mesh_core_tiny_{}_{name}", std::process::id());
        let path = std::env::temp_dir().join(name);
        io::write_soup(&path, &soup).unwrap();
        std::fs::remove_file(path).unwrap();
    }
}

/// Work that grows with the square of the file would take hours.
#[test]
fn a_polygon_of_very_many_corners_is_read_and_converted_at_once() {
    use std::fmt::Write;
    let n = 100_000;
    let mut text = String::new();
    for k in 0..n {
        let angle = f64::from(k) / f64::from(n) * std::f64::consts::TAU;
        writeln!(text, "v {} {} 0", angle.cos(), angle.sin()).unwrap();
    }
    text.push('f');
    (1..=n).for_each(|k| write!(text, " {k}").unwrap());
    let start = Instant::now();
    let read = file("a.obj", text);
    let x = read.soup().positions.clone().into();
    let stl = MeshFile::from_bytes("a.stl", read.to_bytes("a.stl", &x).unwrap()).unwrap();
    assert_eq!(stl.soup().faces.len(), n as usize - 2);
    assert!(start.elapsed().as_secs() < 20);
}

#[test]
fn very_many_faces_over_the_same_corners_are_read_and_converted_at_once() {
    let cube = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n";
    let text = [cube, &"f 1 2 3\n".repeat(300_000)].concat();
    let start = Instant::now();
    let read = file("a.obj", text);
    let x = read.soup().positions.clone().into();
    assert_eq!(read.to_bytes("a.stl", &x).unwrap().len(), 84 + 50 * 300_000);
    assert!(start.elapsed().as_secs() < 20);
}

#[cfg(unix)]
#[test]
fn a_device_is_refused_and_a_pipe_is_read() {
    let error = io::read_mesh("/dev/zero").unwrap_err();
    assert_eq!(
        error.to_string(),
        "/dev/zero: a device cannot be read; give a file or a pipe"
    );

    let folder = std::env::temp_dir().join(format!("mesh_core_pipe_{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("a.obj");
    let made = std::process::Command::new("mkfifo").arg(&path).status();
    if made.is_ok_and(|status| status.success()) {
        let writer = std::thread::spawn({
            let path = path.clone();
            move || std::fs::write(path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap()
        });
        assert_eq!(io::read_soup(&path).unwrap().faces.len(), 1);
        writer.join().unwrap();
    }
    std::fs::remove_dir_all(&folder).unwrap();
}
