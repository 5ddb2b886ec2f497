//! Maps of a sheet over a sheet, whose every texel is known.

use std::fmt::Write as _;

use mesh_core::io::MeshFile;
use mesh_core::shapes;
use mesh_draping::{Seams, Source, Target};

use super::*;

/// Texels along the side.
const SIZE: usize = 32;

/// A square of 1 by 1 in the plane of x and y, whose texture coordinates are x and y, moved by `shift`.
fn source(shift: f64) -> Source {
    let soup = shapes::open_grid(3, 3);
    let mut obj = String::new();
    let side = soup
        .positions
        .iter()
        .fold(0.0, |most: f64, p| most.max(p.x));
    for p in &soup.positions {
        let _ = writeln!(obj, "v {} {} 0", p.x / side, p.y / side);
    }
    for p in &soup.positions {
        let _ = writeln!(obj, "vt {} {}", p.x / side + shift, p.y / side + shift);
    }
    for face in &soup.faces {
        let corners = face.iter().map(|v| format!(" {0}/{0}", v + 1));
        let _ = writeln!(obj, "f{}", corners.collect::<String>());
    }
    let file = MeshFile::from_bytes("source.obj", obj.into_bytes()).expect("an OBJ file");
    Source::of_file(file, Seams::EXACT).expect("a mesh")
}

/// A larger sheet at a height, whose colours are its places: red is x, green is y; with one face turned over or all.
fn sheet(height: f64, is_turned: bool) -> MeshFile {
    let mut ply = String::from(
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n\
         property double red\nproperty double green\nproperty double blue\nelement face 1\n\
         property list uchar int vertex_indices\nend_header\n",
    );
    for [x, y] in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]] {
        let _ = writeln!(ply, "{x} {y} {height} {x} {y} 0.25");
    }
    ply += if is_turned {
        "4 3 2 1 0\n"
    } else {
        "4 0 1 2 3\n"
    };
    MeshFile::from_bytes("target.ply", ply.into_bytes()).expect("a PLY file")
}

fn bake(source: &Source, file: &MeshFile) -> Bake {
    let target = Target::of_file(file.clone()).expect("a target");
    Bake::new(source, source.rest(), &target, SIZE).expect("maps")
}

#[test]
fn every_texel_has_the_colour_of_its_place() {
    for (shift, is_turned) in [(0.0, false), (0.0, true), (3.0, false)] {
        let file = sheet(0.01, is_turned);
        let bake = bake(&source(shift), &file);
        let (texture, _) = bake.colors(&Paint::of_file(&file).unwrap()).unwrap();
        for y in 0..SIZE {
            for x in 0..SIZE {
                let centre = |k: usize| (k as f32 + 0.5) / SIZE as f32;
                let right = [centre(x), 1.0 - centre(y), 0.25];
                let found = texture.texel(x, y);
                let off = (0..3)
                    .map(|k| (found[k] - right[k]).abs())
                    .fold(0.0, f32::max);
                assert!(off < 1e-5, "{x} {y}: {found:?} {right:?}");
            }
        }
        let wraps = bake.findings().contains(&BakeFinding::Wrapped);
        assert_eq!(wraps, shift > 0.0);
    }
}

#[test]
fn normals_and_heights_are_those_of_the_target() {
    let bake = bake(&source(0.0), &sheet(-0.015, false));
    let (heights, scale) = bake.displacement();
    assert!((scale - 0.015).abs() < 1e-12);
    for (normal, height) in bake.normals().texels().iter().zip(heights.texels()) {
        assert!(normal
            .iter()
            .zip([0.5, 0.5, 1.0])
            .all(|(n, right)| (n - right).abs() < 1e-6));
        // As far in as the scale says: black.
        assert!(height[0].abs() < 1e-6);
    }
}

#[test]
fn what_lies_far_and_what_overlaps_is_told() {
    let far = bake(&source(0.0), &sheet(0.5, false));
    assert!(matches!(far.findings(), [BakeFinding::Far { share }] if *share == 1.0));
    let mut obj = String::from("vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n");
    for z in [0, 1] {
        let _ = writeln!(obj, "v 0 0 {z}\nv 1 0 {z}\nv 1 1 {z}\nv 0 1 {z}");
    }
    obj += "f 1/1 2/2 3/3 4/4\nf 5/1 6/2 7/3 8/4\n";
    let file = MeshFile::from_bytes("stacked.obj", obj.into_bytes()).unwrap();
    let stacked = Source::of_file(file, Seams::EXACT).unwrap();
    let found = bake(&stacked, &sheet(0.0, false));
    let overlaps =
        |f: &BakeFinding| matches!(f, BakeFinding::Overlapping { share } if *share > 0.9);
    assert!(
        found.findings().iter().any(overlaps),
        "{:?}",
        found.findings()
    );
}

#[test]
fn what_cannot_be_baked_is_refused() {
    let file = sheet(0.0, false);
    let target = Target::of_file(file).unwrap();
    let plain = Source::of_soup(shapes::open_grid(2, 2), Seams::EXACT).unwrap();
    let baked = |source: &Source, size| Bake::new(source, source.rest(), &target, size).err();
    assert!(matches!(baked(&plain, SIZE), Some(BakeError::NoUvs)));
    assert!(matches!(
        baked(&source(0.0), 1),
        Some(BakeError::Size { .. })
    ));
    let off = b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n".to_vec();
    let bare = MeshFile::from_bytes("bare.off", off).unwrap();
    assert!(matches!(
        Paint::of_file(&bare).err(),
        Some(BakeError::NoColors { .. })
    ));
}
