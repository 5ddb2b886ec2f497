use mesh_core::{shapes, Point3, Vector3, VertexId};
use mesh_operators::{geodesic_distance_unfolded, SolveError, SpaceExtension};
use nalgebra::Matrix3;

use crate::shapes as all_shapes;

fn displacement(p: &Point3) -> Vector3 {
    Vector3::new(p.x * p.y, (2.0 * p.z).sin(), p.x - 0.5 * p.z * p.z)
}

/// Far from the origin and in small units, so that nothing hangs on either.
fn moved(p: &Point3) -> Point3 {
    Point3::from(p.coords * 1e-3) + Vector3::new(1e4, -1e4, 5.0)
}

#[test]
fn takes_the_given_values_at_the_centres() {
    for s in all_shapes::all() {
        let points: Vec<Point3> = s.rest.iter().map(moved).collect();
        let values: Vec<Vector3> = s.rest.iter().map(displacement).collect();
        let field = SpaceExtension::new(&points, &values, 1000).unwrap();
        for (p, d) in points.iter().zip(&values) {
            assert!((field.displacement_at(p) - d).norm() < 1e-6, "{}", s.name);
        }
    }
}

#[test]
fn affine_displacements_extend_exactly() {
    let s = all_shapes::shape("icosphere", shapes::icosphere(3));
    let linear = Matrix3::new(0.3, -1.0, 0.2, 0.0, 0.5, 0.1, 2.0, 0.0, -0.4);
    let affine = |p: &Point3| linear * p.coords + Vector3::new(3.0, 2.0, 1.0);
    let values: Vec<Vector3> = s.rest.iter().map(affine).collect();
    let field = SpaceExtension::new(s.rest.as_slice(), &values, 50).unwrap();
    assert_eq!(field.kernels.len(), 50);
    for p in [[9., -4., 3.], [0.1, 0.2, 0.3]].map(Point3::from) {
        assert!((field.displacement_at(&p) - affine(&p)).norm() < 1e-9);
    }
}

#[test]
fn flat_and_small_sets_of_points_still_give_a_field() {
    let grid = all_shapes::shape("open grid", shapes::open_grid(5, 5));
    let shift = Vector3::new(1.0, 2.0, 3.0);
    for n in [1, 2, 3, grid.rest.len()] {
        let points = &grid.rest.as_slice()[..n];
        let field = SpaceExtension::new(points, &vec![shift; n], 1000).unwrap();
        let p = Point3::new(-3.0, 2.0, 7.0);
        assert!(
            (field.displacement_at(&p) - shift).norm() < 1e-9,
            "{n} points"
        );
    }
    let twice = [Point3::origin(); 2];
    assert!(SpaceExtension::new(&twice, &[shift; 2], 1000).is_ok());
    assert!(matches!(
        SpaceExtension::new(&[], &[], 1000),
        Err(SolveError::SingularField { n_centres: 0 })
    ));
}

#[test]
fn distances_on_a_flat_sheet_are_straight() {
    let s = all_shapes::shape("open grid", shapes::open_grid(12, 9));
    let source = VertexId::new(45);
    let distance = geodesic_distance_unfolded(&s.triangulation, &s.rest, &[source]);
    for v in s.mesh.vertices() {
        let straight = (s.rest[v] - s.rest[source]).norm();
        assert!(
            (distance[v] - straight).abs() < 1e-9,
            "{v}: {} {straight}",
            distance[v]
        );
    }
}

#[test]
fn distances_on_a_sphere_approach_great_circles() {
    for (name, soup, tolerance) in [
        ("icosphere", shapes::icosphere(4), 0.02),
        ("quad sphere", shapes::quad_sphere(20), 0.02),
    ] {
        let s = all_shapes::shape(name, soup);
        let source = VertexId::new(0);
        let distance = geodesic_distance_unfolded(&s.triangulation, &s.rest, &[source]);
        for v in s.mesh.vertices() {
            let (p, q) = (s.rest[v].coords, s.rest[source].coords);
            let arc = p.cross(&q).norm().atan2(p.dot(&q));
            assert!(
                (distance[v] - arc).abs() <= tolerance * arc,
                "{name} {v}: {} {arc}",
                distance[v]
            );
        }
    }
}

#[test]
fn what_no_path_reaches_is_infinitely_far() {
    let mut soup = shapes::tetrahedron();
    soup.positions.push(Point3::new(9.0, 9.0, 9.0));
    let s = all_shapes::shape("tetrahedron and a point", soup);
    let near = geodesic_distance_unfolded(&s.triangulation, &s.rest, &[VertexId::new(0)]);
    assert_eq!(near[VertexId::new(4)], f64::INFINITY);
    let none = geodesic_distance_unfolded(&s.triangulation, &s.rest, &[]);
    assert!(none.iter().all(|d| d.is_infinite()));
}
