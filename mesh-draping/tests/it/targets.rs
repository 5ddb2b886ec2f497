//! What is no part of a target is left out, and said as a value.

use mesh_draping::mesh_core::io::{Finding, MeshFile};
use mesh_draping::mesh_core::{shapes, Point3};
use mesh_draping::{Error, Note, Seams, Shape, Source, Target};

#[test]
fn a_clean_target_says_nothing() {
    for soup in [
        shapes::icosphere(2),
        shapes::quad_sphere(3),
        shapes::open_grid(3, 3),
    ] {
        let target = Target::of_soup(soup.clone()).unwrap();
        assert!(target.notes().is_empty(), "{:?}", target.notes());
        assert_eq!(target.vertices(), soup.positions);
        assert!(!target.is_cloud() && target.kept_points().is_empty());
    }
}

#[test]
fn what_its_file_contradicts_itself_in_is_said_of_either_shape() {
    let text =
        "solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
    let file = MeshFile::from_bytes("a.stl", text.into()).unwrap();
    let note = |shape| Note::File {
        shape,
        finding: Finding::NoEnd,
    };
    let source = Source::of_file(file.clone(), Seams::EXACT).unwrap();
    assert_eq!(source.notes(), [note(Shape::Source)]);
    let target = Target::of_file(file).unwrap();
    assert_eq!(target.notes()[0], note(Shape::Target));
    let told = target.notes()[0].to_string();
    assert!(
        told.starts_with("the file of the target: it ends without"),
        "{told}"
    );
}

#[test]
fn crumbs_are_left_out_and_stay_in_the_soup() {
    let mut soup = shapes::icosphere(3);
    let first = soup.positions.len() as u32;
    let corners = [[1.5, 0.0, 0.0], [1.52, 0.0, 0.0], [1.5, 0.02, 0.0]];
    soup.positions.extend(corners.map(Point3::from));
    soup.faces.push(vec![first, first + 1, first + 2]);
    let target = Target::of_soup(soup).unwrap();
    let [Note::TrianglesLeftOut {
        n_crumbs: 1, share, ..
    }] = target.notes()
    else {
        panic!("{:?}", target.notes());
    };
    assert!(*share > 0.0 && *share < 1e-3);
    assert!(target.judged().bounds().max.x < 1.1);
    assert_eq!(
        target.triangles().len(),
        shapes::icosphere(3).faces.len() + 1
    );
}

#[test]
fn stray_points_are_left_out_of_a_cloud() {
    let mut points = shapes::icosphere(4).positions;
    points.push(Point3::new(9.0, 0.0, 0.0));
    let n_points = points.len();
    let target = Target::of_points(points, None).unwrap();
    assert!(target.is_cloud());
    let expected = Note::PointsLeftOut { n: 1, n_points };
    assert_eq!(target.notes()[0], expected);
    assert_eq!(target.kept_points().len(), n_points - 1);
}

#[test]
fn nothing_is_no_target() {
    let nothing = Target::of_points(Vec::new(), None);
    assert!(matches!(nothing, Err(Error::Mesh(_))));
    let not_finite = Target::of_points(vec![Point3::new(f64::NAN, 0.0, 0.0)], None);
    assert!(matches!(not_finite, Err(Error::Mesh(_))));
}
