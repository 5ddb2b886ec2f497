//! `drape bake`, and the maps of `drape transfer`.

use crate::support::Workplace;

/// A sheet with a colour at each corner.
const SHEET: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
    property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n\
    property list uchar int vertex_indices\nend_header\n0 0 0 255 0 0\n1 0 0 0 255 0\n1 1 0 0 0 255\n0 1 0 9 9 9\n4 0 1 2 3\n";
const SQUARE: &str =
    "v 0 0 0.001\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n";

#[test]
fn a_result_gets_three_maps_with_the_same_bytes_whatever_the_threads() {
    let place = Workplace::new();
    place.write("sheet.ply", SHEET);
    place.write("square.obj", SQUARE);
    let line =
        "bake square.obj sheet.ply -o a.png --normal n.png --displacement d.png --bake-size 64";
    let ended = place.drape(&format!("{line} --threads 1")).well();
    assert!(ended.stderr.contains("white is 0.000"), "{}", ended.stderr);
    let bytes = |name: &str| std::fs::read(place.path(name)).expect("the map is there");
    let before = ["a.png", "n.png", "d.png"].map(bytes);
    place.drape(&format!("{line} --threads 2")).well();
    assert!(before == ["a.png", "n.png", "d.png"].map(bytes));
    // Width and height, and 16 bits of grey.
    assert_eq!(before[2][16..26], [0, 0, 0, 64, 0, 0, 0, 64, 16, 0]);
}

#[test]
fn what_cannot_be_baked_is_known_before_the_drape() {
    let place = Workplace::new();
    let ended = place.transfer("--bake t.png");
    assert_eq!(ended.code, Some(2));
    assert!(
        ended.stderr.contains("has neither colours"),
        "{}",
        ended.stderr
    );
    place.write("sheet.ply", SHEET);
    place.write("bare.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let ended = place.drape("bake bare.obj sheet.ply -o t.png");
    assert!(
        ended.stderr.contains("no texture coordinates"),
        "{}",
        ended.stderr
    );
    assert!(!place.exists("t.png") && !place.exists("out.obj"));
    // Relief and normals need no colours.
    let ended = place.transfer("--bake-normal n.png --bake-size 32").well();
    assert!(ended.stdout.contains("wrote n.png") && place.exists("n.png"));
    assert!(
        ended.stderr.contains("belong to several faces"),
        "{}",
        ended.stderr
    );
}
