//! What was read although the file contradicts itself is said, and what would be read wrong is refused.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use mesh_core::io::Finding;

use crate::io_support::{bent, check_round_trip, file, refusal, rest, written};

/// A binary STL file of `n` triangles whose header states `stated`.
fn stl(n: u32, stated: u32) -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes.extend(stated.to_le_bytes());
    for k in 0..n {
        let k = k as f32;
        let numbers = [0., 0., 1., k, 0., 0., k + 1., 0., 0., k, 1., 0.];
        numbers
            .iter()
            .for_each(|c: &f32| bytes.extend(c.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

#[test]
fn all_triangles_of_an_stl_with_a_wrong_count_are_read_and_that_is_said() {
    for stated in [0, 11, 13, u32::MAX] {
        let bytes = stl(12, stated);
        let read = file("a.stl", &bytes);
        assert_eq!(read.soup().faces.len(), 12);
        let stated = u64::from(stated);
        assert_eq!(read.findings(), [Finding::WrongCount { stated, found: 12 }]);
        check_round_trip("a.stl", &bytes);
    }
    assert_eq!(file("a.stl", stl(12, 12)).findings(), []);
    let told = file("a.stl", stl(12, 11)).findings()[0].to_string();
    assert_eq!(
        told,
        "its header states 11 triangles, but there are 12; these were read"
    );
}

#[test]
fn an_stl_cut_within_a_triangle_is_refused() {
    let bytes = stl(12, 12);
    let message = refusal("a.stl", &bytes[..bytes.len() - 10]).to_string();
    assert!(message.contains("12 triangles are promised"), "{message}");
}

#[test]
fn bytes_behind_the_last_triangle_are_told_where_they_could_be_triangles() {
    let bytes = [stl(2, 2), vec![7; 70]].concat();
    let read = file("a.stl", &bytes);
    assert_eq!(read.findings(), [Finding::BytesBehind { n_bytes: 70 }]);
    assert_eq!(written(&read, &rest(&read)), bytes);
    assert_eq!(&written(&read, &bent(&read))[84 + 100..], [7; 70]);
}

#[test]
fn a_text_stl_that_was_cut_short_is_refused_or_said() {
    let text = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
    assert_eq!(file("a.stl", text).findings(), [Finding::NoEnd]);
    assert_eq!(file("a.stl", [text, "endsolid"].concat()).findings(), []);
    let cut = [text, &text[8..text.len() - 9]].concat();
    let message = refusal("a.stl", cut).to_string();
    assert!(
        message.starts_with("a.stl:15: ends where the rest of a facet"),
        "{message}"
    );
}

#[test]
fn text_that_is_no_stl_is_not_taken_for_a_binary_one() {
    let text = "no mesh at all\n".repeat(20);
    let message = refusal("a.stl", &text[..84 + 50 * 4]).to_string();
    assert!(
        message.contains("a.stl:1: expected `solid` or a binary STL file, found `no mesh"),
        "{message}"
    );
}
