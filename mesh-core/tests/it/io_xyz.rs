//! Lists of points survive; so do files in gzip.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::io::Write;

use mesh_core::io::Format;
use mesh_core::{Point3, Vector3};

use crate::io_support::{bent, check_round_trip, file, refusal, rest, written, written_text};

#[test]
fn blanks_commas_headings_and_counts() {
    for text in [
        "0 0 0\n1\t2 3.5\n",
        "# scan\n\n0,0,0\r\n1, 2,3.5\r\n",
        "x;y;z;name\n0;0;0\n1;2;3.5;",
        "2\n0 0 0 255 0 0\n1 2 3.5 0 0 255\n",
    ] {
        let read = file("scan.xyz", text);
        assert_eq!(
            read.soup().positions,
            [Point3::origin(), Point3::new(1.0, 2.0, 3.5)],
            "{text}"
        );
        assert!(read.vertex_normals().is_none(), "{text}");
        check_round_trip("scan.xyz", text.as_bytes());
    }
    let read = file("noname", "1 2 3\n");
    assert_eq!((read.format(), read.soup().faces.len()), (Format::Xyz, 0));
}

#[test]
fn only_the_first_three_columns_change() {
    let read = file("scan.csv", "a,b,c,d\n0,0,0,7\n1,2,3,8\n");
    let mut x = rest(&read);
    x.as_mut_slice()[1].y = -0.5;
    assert_eq!(written_text(&read, &x), "a,b,c,d\n0,0,0,7\n1,-0.5,3,8\n");
}

#[test]
fn unit_columns_are_normals() {
    let read = file("scan.xyz", "0 0 0 0 0 1\n1 0 0 0 -1.001 0\n");
    assert_eq!(
        read.vertex_normals().unwrap(),
        [Vector3::z(), -Vector3::y()]
    );
    assert_eq!(read.contents().n_normals, 2);
    let colored = file("scan.xyz", "0 0 0 9 9 9 0 0 1\n1 0 0 8 8 8 1 0 0\n");
    assert_eq!(
        colored.vertex_normals().unwrap(),
        [Vector3::z(), Vector3::x()]
    );
}

#[test]
fn faults_name_their_line() {
    for (text, says) in [
        ("0 0 0\n1 2\n", "bad.xyz:2: ends where a coordinate"),
        ("0 0 0\n\n1 2 nan\n", "bad.xyz:3: the coordinate `nan`"),
        ("0 0 0\n1 2 x\n", "bad.xyz:2: expected a number, found `x`"),
        ("x y z\n", "no vertex"),
    ] {
        let message = refusal("bad.xyz", text).to_string();
        assert!(message.contains(says), "{message}");
    }
}

fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn gzip_is_taken_off_and_put_on() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let read = file("a.obj.gz", packed(text.as_bytes()));
    assert_eq!((read.format(), read.soup().faces.len()), (Format::Obj, 1));
    assert_eq!(
        read.to_bytes("a.obj", &rest(&read)).unwrap(),
        text.as_bytes()
    );
    let x = bent(&read);
    let again = file("a.obj.gz", written(&read, &x));
    assert!(written(&read, &x).starts_with(&[0x1F, 0x8B]));
    assert_eq!(again.soup().positions, x.as_slice());
}

#[test]
fn damaged_and_swollen_gzip_is_refused() {
    let mut cut = packed(b"v 0 0 0\nf 1 1 1\n");
    cut.truncate(cut.len() - 9);
    assert!(refusal("a.obj.gz", cut)
        .to_string()
        .contains("cannot be unpacked"));
    let bomb = packed(&vec![b' '; 64 << 20]);
    assert!(refusal("a.obj.gz", bomb)
        .to_string()
        .contains("unpacked bytes"));
}
