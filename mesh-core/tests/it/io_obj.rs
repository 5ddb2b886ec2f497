//! OBJ files survive.

use mesh_core::io::{Format, Place, ReadProblem};
use mesh_core::{io, shapes, Vector3};

use crate::io_support::{bent, check_round_trip, file, refusal, rest, written_text};

/// Everything a file may hold: CRLF and LF, continuations, negative indices, w, colours, elements, unknown statements.
const RICH: &str = "\u{feff}# made by hand\r\nmtllib not here.mtl\r\n\r\no Body part\r\nv 0 0 0 1.0\r\nv  1.0\t0 0 # right\n\
v 1 1 0 .5 .25 0\nv 0 +1.0e0 \\\n  -0.0\nv 0.5 0.5 1e0\nvt 0 0\nvt 1 0 0\nvn 0 0 -1\nvn 0.0 0.0 1.0\nvn 1 0 0\n\
g left arm\ns 1\nusemtl Skin tone\nf 1/1/1 2/2/1 3/1/1 \\\r\n 4/2/1\ng arm\ns off\nf -5//2 2//2 5//2\nusemtl Cloth\n\
f 2/1 3/2/ 5\nf 3 4 5\nf 1 2\nl 1 2 3\np 4\ncurv 0 1 \\\n 2 3\nvp 0.5\nbevel on\nf 4 1 5";

#[test]
fn all_that_is_in_a_file_is_seen() {
    let read = file("rich.obj", RICH);
    let soup = read.soup();
    assert_eq!((soup.positions.len(), soup.positions[3].y), (5, 1.0));
    let arities: Vec<usize> = soup.faces.iter().map(Vec::len).collect();
    assert_eq!(arities, [4, 3, 3, 3, 2, 3]);
    assert_eq!(soup.faces[1], [0, 1, 4]);

    let contents = read.contents();
    assert_eq!(
        (contents.n_uvs, contents.n_normals, contents.n_comments),
        (2, 3, 1)
    );
    assert_eq!(
        (
            contents.n_lines_and_points,
            contents.n_smoothing_groups,
            contents.n_colors
        ),
        (2, 1, 1)
    );
    let faces = |named: &[io::NamedFaces]| -> Vec<(String, usize)> {
        named
            .iter()
            .map(|n| (n.name.clone(), n.n_faces()))
            .collect()
    };
    let of = |name: &str, n: usize| (name.to_owned(), n);
    assert_eq!(faces(&contents.objects), [of("Body part", 6)]);
    assert_eq!(faces(&contents.groups), [of("left", 1), of("arm", 6)]);
    assert_eq!(
        faces(&contents.materials),
        [of("Skin tone", 2), of("Cloth", 4)]
    );
    assert_eq!(contents.references, ["not here.mtl"]);
    assert!(contents.has_uvs());
}

#[test]
fn only_positions_and_normals_change() {
    check_round_trip("rich.obj", RICH.as_bytes());
    let read = file("rich.obj", RICH);
    let mut x = rest(&read);
    x.as_mut_slice()[3].z = 0.125;
    x.as_mut_slice()[1].x = 1.0 / 3.0;
    let expected = RICH
        .replace("v  1.0\t0 0 # right", "v  0.3333333333333333\t0 0 # right")
        .replace("  -0.0\n", "  0.125\n");
    let text = written_text(&read, &x);
    let without_normals = |text: &str| -> Vec<String> {
        text.split('\n')
            .filter(|l| !l.starts_with("vn"))
            .map(str::to_owned)
            .collect()
    };
    assert_eq!(without_normals(&text), without_normals(&expected));
    assert!(
        text.contains("\nvn 1 0 0\n"),
        "no corner names it: it keeps its text"
    );
}

#[test]
fn shared_and_split_normals_follow_the_shape() {
    // Two walls of a corner: rows 1 and 2 are split along the edge, row 3 is shared, row 4 looks to the back.
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1 0 -1\nv 1 1 -1\nvn 0 0 1\nvn 1 0 0\nvn 0.7 0 0.7\nvn 0 0 -1\n\
                f 1//1 2//3 3//4 4//1\nf 2//3 5//2 6//2 3//2\n";
    let read = file("walls.obj", text);
    // (x, y, z) ↦ (z, x, y): every normal turns with the shape.
    let x = rest(&read).map(|p| p.coords.zxy().into());
    let normals: Vec<Vector3> = written_text(&read, &x)
        .lines()
        .filter_map(|l| l.strip_prefix("vn "))
        .map(|l| Vector3::from_iterator(l.split(' ').map(|c| c.parse::<f64>().unwrap())))
        .collect();
    let half = 0.5f64.sqrt();
    let expected = [[1., 0., 0.], [0., 1., 0.], [half, half, 0.], [-1., 0., 0.]].map(Vector3::from);
    for (n, e) in normals.iter().zip(expected) {
        // Unit vectors, rounded a few times.
        assert!((n - e).norm() < 1e-15, "{n} is not {e}");
    }
}

#[test]
fn moving_one_corner_leaves_normals_elsewhere_alone() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 0 0\nv 6 0 0\nv 5 1 0\nvn 0.000 0 1.0\nvn 0 0 1\nf 1//1 2//1 3//1\nf 4//2 5//2 6//2\n";
    let read = file("two.obj", text);
    let mut x = rest(&read);
    x.as_mut_slice()[3].z = 1.0;
    let changed: Vec<String> = written_text(&read, &x)
        .lines()
        .zip(text.lines())
        .filter(|(new, old)| new != old)
        .map(|(new, _)| new[..2].to_owned())
        .collect();
    assert_eq!(changed, ["v ", "vn"]);
}

#[test]
fn faces_may_come_before_their_vertices() {
    let read = file("early.obj", "f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n");
    assert_eq!(read.soup().faces, [[0, 1, 2]]);
}

#[test]
fn old_line_ends_and_missing_extensions_are_read() {
    let read = file("noname", "# one\rv 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r");
    assert_eq!((read.format(), read.soup().faces.len()), (Format::Obj, 1));
    assert_eq!(read.contents().n_comments, 1);
}

#[test]
fn normals_of_vertices() {
    let read = file(
        "n.obj",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 9 9 9\nvn 0 0 2\nvn 0 2 0\nf 1//1 2//1 3//2\n",
    );
    let normals = read.vertex_normals().unwrap();
    assert_eq!(
        normals,
        [Vector3::z(), Vector3::z(), Vector3::y(), Vector3::zeros()]
    );
    let cloud = file("cloud.obj", "v 0 0 0\nv 1 0 0\nvn 0 0 3\nvn 0 1 0\n");
    assert_eq!(
        cloud.vertex_normals().unwrap(),
        [Vector3::z(), Vector3::y()]
    );
    assert!(file("plain.obj", "v 0 0 0\nf 1 1 1\n")
        .vertex_normals()
        .is_none());
}

#[test]
fn each_fault_names_its_line() {
    let at = |text: &str| {
        let error = refusal("bad.obj", text);
        let Place::Line(line) = error.place else {
            panic!("{error}")
        };
        assert!(
            error.to_string().starts_with(&format!("bad.obj:{line}: ")),
            "{error}"
        );
        (line, error.to_string())
    };
    for (text, line, says) in [
        ("v 0 0 0\nv 0 nan 0\n", 2, "`nan` is not a number"),
        ("v 0 0 0\nv 0 0 -inf\n", 2, "`-inf` is infinite"),
        (
            "v 0 0 0\r\nv 0 0 1e999\r\n",
            2,
            "`1e999` is too large for a number",
        ),
        ("v 0 0\n", 1, "a coordinate was expected"),
        ("v 0 0 # 0\n", 1, "a coordinate was expected"),
        ("\n\nv 0 0 x1\n", 3, "found `x1`"),
        ("v 0 0 0\n\nf 1 1 2\n", 3, "names vertex 2, but there are 1"),
        (
            "v 0 0 0\nf 1 1 99\nf 1 1 1\nv 0 0 0\n",
            2,
            "names vertex 99, but there are 2",
        ),
        ("v 0 0 0\nf 1 0 1\n", 2, "names vertex 0"),
        ("v 0 0 0\nf 1 -2 1\n", 2, "names vertex -2"),
        ("v 0 0 0\nf 1 1/x 1\n", 2, "found `1/x`"),
        ("v 0 0 0\nf 1 1/1/1/1 1\n", 2, "found `1/1/1/1`"),
        ("v 0 0 0\nf 1 1 99999999999999999999\n", 2, "a corner like"),
        ("v 0 0 0\nf 1 1 5000000000\n", 2, "names vertex 5000000000"),
    ] {
        let (found, message) = at(text);
        assert!(found == line && message.contains(says), "{message}");
    }
}

#[test]
fn files_that_are_no_meshes() {
    let problem = |name: &str, bytes: &[u8]| refusal(name, bytes).problem;
    assert!(matches!(problem("a.obj", b""), ReadProblem::Empty));
    assert!(matches!(
        problem("a.obj", b"# nothing\n"),
        ReadProblem::NoVertices { .. }
    ));
    assert!(matches!(
        problem("a.obj", b"v 0 0 0\0\x01\x02"),
        ReadProblem::Binary { .. }
    ));
    assert!(matches!(
        problem("a.doc", b"Dear all,\n"),
        ReadProblem::UnknownFormat
    ));
    let missing = io::read_mesh("/nowhere/a.obj").unwrap_err();
    assert!(
        matches!(missing.problem, ReadProblem::Io(_))
            && missing.to_string().contains("/nowhere/a.obj")
    );
}

#[test]
fn shapes_are_written_and_read() {
    for soup in [
        shapes::tetrahedron(),
        shapes::quad_sphere(3),
        shapes::prism(7),
        shapes::open_grid(2, 3),
    ] {
        for name in ["shape.obj", "shape.off", "shape.ply"] {
            let path =
                std::env::temp_dir().join(format!("mesh_core_{}_{name}", std::process::id()));
            io::write_soup(&path, &soup).unwrap();
            let read = io::read_mesh(&path).unwrap();
            std::fs::remove_file(&path).unwrap();
            assert_eq!(read.soup(), &soup);
            let bytes = read.to_bytes(name, &rest(&read)).unwrap();
            check_round_trip(name, &bytes);
        }
    }
}

#[test]
fn another_extension_converts_and_tells_what_is_lost() {
    let read = file("rich.obj", RICH);
    let x = bent(&read);
    let ply = file("rich.ply", read.to_bytes("rich.ply", &x).unwrap());
    assert_eq!(ply.format(), Format::Ply);
    assert_eq!(
        (&ply.soup().positions[..], &ply.soup().faces),
        (x.as_slice(), &read.soup().faces)
    );
    assert_eq!(read.lost_in("other.obj"), None);
    assert_eq!(read.lost_in("no extension"), None);
    let lost = read.lost_in("rich.ply").unwrap();
    assert!(
        lost.contains("2 texture coordinates") && lost.contains("2 materials"),
        "{lost}"
    );
}

#[test]
fn what_cannot_be_written_leaves_the_old_file() {
    let folder = std::env::temp_dir().join(format!("mesh_core_atomic_{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("out.obj");
    std::fs::write(&path, "old").unwrap();

    let read = file("in.obj", "v 0 0 0\nv 1 0 0\nf 1 2 1\n");
    let mut x = rest(&read);
    x.as_mut_slice()[1].y = f64::NAN;
    let error = read.write(&path, &x).unwrap_err();
    assert!(error.to_string().contains("vertex 1"), "{error}");
    assert!(read
        .write(&path, &mesh_core::Positions::from(vec![]))
        .is_err());
    assert!(read
        .write(folder.join("no/such/folder.obj"), &rest(&read))
        .is_err());
    assert_eq!(std::fs::read(&path).unwrap(), b"old");

    read.write(&path, &rest(&read)).unwrap();
    assert_eq!(
        std::fs::read(&path).unwrap(),
        b"v 0 0 0\nv 1 0 0\nf 1 2 1\n"
    );
    let names: Vec<_> = std::fs::read_dir(&folder)
        .unwrap()
        .map(|e| e.unwrap().file_name())
        .collect();
    assert_eq!(names, ["out.obj"], "nothing is left behind");
    std::fs::remove_dir_all(&folder).unwrap();
}

/// Each name was looked up among all names before it on the line.
#[test]
fn a_line_of_many_groups_is_read_at_once() {
    let names: String = (0..200_000).map(|k| format!(" {k}")).collect();
    let text = format!("v 0 0 0\ng{names}\nf 1 1 1\n");
    let start = std::time::Instant::now();
    assert_eq!(file("a.obj", text).contents().groups.len(), 200_000);
    assert!(start.elapsed().as_secs() < 5);
}

/// Found by fuzzing: areas of coordinates near 1e308 overflow, and NaN is not equal to itself, so that normals of a mesh
/// that had not moved were written as NaN. Such coordinates are refused; the largest that are read keep their normals.
#[test]
fn normals_between_huge_coordinates_keep_their_text() {
    let text = "v 0 0 0\nv 1e75 5 0\nv 0 1e75 -1e75\nvn 0 0 1\nf 1//1 2//1 3//1\n";
    let read = file("a.obj", text);
    assert_eq!(written_text(&read, &rest(&read)), text);
    let message = refusal("a.obj", text.replace("1e75", "1e155")).to_string();
    assert!(
        message.starts_with("a.obj:2: the coordinate `1e155` is too large to measure with"),
        "{message}"
    );
}
