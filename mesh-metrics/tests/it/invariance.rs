//! What must not change a figure.

use mesh_core::{shapes, HalfedgeMesh, Point3, PolygonSoup, Positions, Triangulation, Vector3};
use mesh_metrics::{
    dirichlet_energy, dirichlet_unit_area, folded_edges, mean_angle_deviation, q_transfer,
    self_intersections, skinny_triangles,
};
use nalgebra::Rotation3;
use proptest::prelude::*;

fn shape() -> impl Strategy<Value = PolygonSoup> {
    prop_oneof![
        Just(shapes::icosphere(1)),
        Just(shapes::quad_sphere(3)),
        Just(shapes::open_grid(4, 3)),
        Just(shapes::cone(7)),
        Just(shapes::prism(5)),
    ]
}

/// A shape, and what it became when each vertex was moved at random.
fn draped() -> impl Strategy<Value = (HalfedgeMesh, Positions, Positions)> {
    let noise = prop::collection::vec(prop::array::uniform3(-0.6..0.6), 100);
    (shape(), noise).prop_map(|(soup, noise)| {
        let (mesh, rest) = soup.into_halfedge().unwrap();
        let moved = rest
            .iter()
            .zip(noise.iter().cycle())
            .map(|(p, &n)| p + Vector3::from(n));
        let draped = moved.collect();
        (mesh, rest, draped)
    })
}

fn similarity() -> impl Strategy<Value = (Rotation3<f64>, f64, Vector3)> {
    let vector = || prop::array::uniform3(-3.0..3.0).prop_map(Vector3::from);
    (vector(), 0.1..10.0, vector())
        .prop_map(|(axis, scale, shift)| (Rotation3::new(axis), scale, shift))
}

fn relative(a: f64, b: f64) -> f64 {
    (a - b).abs() / a.abs().max(b.abs()).max(1e-300)
}

proptest! {
    #[test]
    fn rigid_motion_and_scale_change_nothing(
        (mesh, rest, draped) in draped(),
        (rotation, scale, shift) in similarity(),
    ) {
        let triangles = Triangulation::new(&mesh, &rest);
        let moved = draped.map(|p| rotation * p * scale + shift);
        let relative_to_unmoved = |f: fn(&Triangulation, &Positions, &Positions) -> f64| {
            relative(f(&triangles, &rest, &moved), f(&triangles, &rest, &draped))
        };
        // Sums of some hundred terms of similar size, each good to a few units in the last place of its edges.
        prop_assert!(relative_to_unmoved(dirichlet_unit_area) < 1e-10);
        prop_assert!(relative_to_unmoved(mean_angle_deviation) < 1e-10);
        prop_assert_eq!(folded_edges(&triangles, &rest, &moved), folded_edges(&triangles, &rest, &draped));
        prop_assert_eq!(skinny_triangles(&triangles, &moved), skinny_triangles(&triangles, &draped));
    }

    #[test]
    fn dirichlet_is_at_least_one((mesh, rest, draped) in draped()) {
        // ‖dφ‖² ≥ 2 |det dφ|, so ½ Σ ‖dφ‖² a ≥ Σ â.
        let triangles = Triangulation::new(&mesh, &rest);
        prop_assert!(dirichlet_unit_area(&triangles, &rest, &draped) >= 1.0 - 1e-12);
    }

    #[test]
    fn energy_grows_with_the_square_of_the_size((mesh, rest, draped) in draped(), scale in 0.1..10.0) {
        let triangles = Triangulation::new(&mesh, &rest);
        let grown = draped.map(|p| p * scale);
        let expected = scale * scale * dirichlet_energy(&triangles, &rest, &draped);
        prop_assert!(relative(dirichlet_energy(&triangles, &rest, &grown), expected) < 1e-12);
    }

    #[test]
    fn self_intersections_equal_brute_force((mesh, rest, draped) in draped()) {
        let triangles = Triangulation::new(&mesh, &rest);
        let corners: Vec<[Point3; 3]> = triangles.corners(&draped).collect();
        let mut expected = Vec::new();
        for one in 0..corners.len() {
            for other in one + 1..corners.len() {
                if is_crossing(&corners[one], &corners[other]) || is_crossing(&corners[other], &corners[one]) {
                    expected.push([one, other]);
                }
            }
        }
        prop_assert_eq!(self_intersections(&triangles, &draped), expected);
    }

    #[test]
    fn score_falls_with_either_part(f_d in 0.0..20.0, f_a in 0.1..50.0, more in 0.01..5.0) {
        let q = q_transfer(f_d, f_a, 5.0);
        prop_assert!((0.0..=1.0).contains(&q));
        prop_assert!(q_transfer(f_d + more, f_a, 5.0) <= q && q_transfer(f_d, f_a + more, 5.0) < q);
        prop_assert_eq!(q_transfer(f_a, f_d, 5.0), q);
    }
}

/// Whether an edge of `s` crosses the inside of `t`, by solving for the place: corners shared do not count.
fn is_crossing(s: &[Point3; 3], [a, b, c]: &[Point3; 3]) -> bool {
    (0..3).any(|k| {
        let (p, q) = (s[k], s[(k + 1) % 3]);
        let columns = nalgebra::Matrix3::from_columns(&[b - a, c - a, p - q]);
        let is_shared = [p, q].iter().any(|e| e == a || e == b || e == c);
        let inside =
            |w: Vector3| w.x > 0.0 && w.y > 0.0 && w.x + w.y < 1.0 && w.z > 0.0 && w.z < 1.0;
        !is_shared
            && columns
                .try_inverse()
                .is_some_and(|inverse| inside(inverse * (p - a)))
    })
}
