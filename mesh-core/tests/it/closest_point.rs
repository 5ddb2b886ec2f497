//! Closest points and first hits against brute force.

use mesh_core::bvh::closest_point_on_triangle;
use mesh_core::{shapes, Aabb, Location, Point3, SurfacePoint, TriangleBvh, Vector3};
use proptest::prelude::*;

fn corners(soup: &mesh_core::PolygonSoup) -> Vec<[Point3; 3]> {
    let row = |v: u32| soup.positions[v as usize];
    soup.faces
        .iter()
        .map(|f| [row(f[0]), row(f[1]), row(f[2])])
        .collect()
}

/// The lowest row among the closest.
fn brute_force(
    corners: &[[Point3; 3]],
    q: &Point3,
    accept: impl Fn(u32) -> bool,
) -> Option<(u32, f64)> {
    let distances = (0u32..)
        .zip(corners)
        .filter(|&(row, _)| accept(row))
        .map(|(row, t)| (row, closest_point_on_triangle(q, t).distance_squared));
    distances.min_by(|a, b| a.1.total_cmp(&b.1))
}

fn row(p: &SurfacePoint) -> u32 {
    match p.location {
        Location::Triangle { index, .. } | Location::Point { index } => index,
    }
}

fn found(p: Option<SurfacePoint>) -> Option<(u32, f64)> {
    p.map(|p| (row(&p), p.distance_squared))
}

/// Lattice points make coincident corners, flat triangles and ties frequent.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![(-3i32..4).prop_map(f64::from), -3.0..3.0]
}

fn point() -> impl Strategy<Value = Point3> {
    [coordinate(), coordinate(), coordinate()].prop_map(Point3::from)
}

fn triangles() -> impl Strategy<Value = Vec<[Point3; 3]>> {
    let triangle = prop_oneof![
        8 => [point(), point(), point()],
        1 => [point(), point()].prop_map(|[a, b]| [a, b, b]),
        1 => point().prop_map(|a| [a, a, a]),
        1 => [point(), point()].prop_map(|[a, b]| [a, nalgebra::center(&a, &b), b]),
    ];
    prop::collection::vec(triangle, 0..60)
}

fn moved(corners: &[[Point3; 3]], offset: Vector3) -> Vec<[Point3; 3]> {
    corners.iter().map(|t| t.map(|p| p + offset)).collect()
}

proptest! {
    #[test]
    fn equals_brute_force(corners in triangles(), queries in prop::collection::vec(point(), 10), hint in 0u32..80) {
        let bvh = TriangleBvh::new(corners.clone());
        for q in &queries {
            let expected = brute_force(&corners, q, |_| true);
            prop_assert_eq!(found(bvh.closest_point(q)), expected);
            prop_assert_eq!(bvh.closest_point_from(q, hint), bvh.closest_point(q));
            let odd = |row| row % 2 == 1;
            prop_assert_eq!(found(bvh.closest_point_where(q, odd)), brute_force(&corners, q, odd));
        }
    }

    #[test]
    fn equals_brute_force_far_from_the_origin(corners in triangles(), q in point(), shift in -1.0..1.0) {
        let offset = Vector3::new(1e6, -1e6 + shift, 1e6);
        let corners = moved(&corners, offset);
        let q = q + offset;
        let bvh = TriangleBvh::new(corners.clone());
        prop_assert_eq!(found(bvh.closest_point(&q)), brute_force(&corners, &q, |_| true));
    }

    #[test]
    fn no_overlapping_triangle_is_missed(corners in triangles(), a in point(), b in point()) {
        let bounds = Aabb::of([&a, &b]);
        let mut found = Vec::new();
        TriangleBvh::new(corners.clone()).for_each_overlapping(&bounds, |row| found.push(row));
        found.sort_unstable();
        // Boxes are rounded by up to 1e-6 of the size of the whole, here below 10.
        let meets = |row: &u32, slack: f64| {
            let b = Aabb::of(&corners[*row as usize]);
            (0..3).all(|k| b.min[k] <= bounds.max[k] + slack && bounds.min[k] <= b.max[k] + slack)
        };
        let rows = 0..corners.len() as u32;
        prop_assert!(rows.filter(|row| meets(row, 0.0)).all(|row| found.binary_search(&row).is_ok()));
        prop_assert!(found.iter().all(|row| meets(row, 1e-5)));
    }

    #[test]
    fn refit_equals_a_new_hierarchy(corners in triangles(), q in point(), scale in 1e-3..1e3) {
        let mut bvh = TriangleBvh::new(corners.clone());
        let turned: Vec<[Point3; 3]> = corners
            .iter()
            .rev()
            .map(|t| t.map(|p| Point3::new(p.y * scale, p.z * scale, p.x * scale - 7.0)))
            .collect();
        bvh.refit(turned.iter().copied());
        prop_assert_eq!(found(bvh.closest_point(&q)), brute_force(&turned, &q, |_| true));
        prop_assert_eq!(bvh.bounds(), TriangleBvh::new(turned.clone()).bounds());
        for (row, t) in turned.iter().enumerate() {
            prop_assert_eq!(&bvh.triangle(row as u32), t);
        }
    }

    /// The closest point is on the triangle, and no point of it is closer.
    #[test]
    fn closest_point_on_triangle_is_closest(t in [point(), point(), point()], q in point(), u in 0.0..1.0f64, v in 0.0..1.0f64) {
        let closest = closest_point_on_triangle(&q, &t);
        let [a, b, c] = closest.barycentric;
        prop_assert!(a >= 0.0 && b >= 0.0 && c >= 0.0 && (a + b + c - 1.0).abs() < 1e-12);
        let d = (closest.point(&t) - q).norm_squared();
        prop_assert!((d - closest.distance_squared).abs() < 1e-12);
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        let other: Point3 = t[0] + (t[1] - t[0]) * u + (t[2] - t[0]) * v;
        prop_assert!(closest.distance_squared <= (other - q).norm_squared() + 1e-12);
    }

    #[test]
    fn rays_from_inside_a_closed_shape_hit_it(direction in [-1.0..1.0f64, -1.0..1.0, -1.0..1.0], at_corner in any::<bool>(), k in 0usize..42) {
        let sphere = shapes::icosphere(1);
        let bvh = TriangleBvh::new(corners(&sphere));
        let direction = if at_corner { sphere.positions[k].coords } else { Vector3::from(direction) };
        prop_assume!(direction.norm() > 1e-3);
        let origin = Point3::new(0.01, 0.02, -0.03) * f64::from(u8::from(!at_corner));
        let hit = bvh.first_hit(&origin, &direction).expect("the sphere is closed");
        prop_assert!((hit.point - (origin + direction * hit.distance)).norm() < 1e-12);
        prop_assert!((0.9..1.001).contains(&hit.point.coords.norm()));
    }
}

#[test]
fn empty_hierarchy_answers_none() {
    let bvh = TriangleBvh::new(Vec::new());
    assert!(bvh.is_empty());
    assert_eq!(bvh.closest_point(&Point3::origin()), None);
    assert_eq!(bvh.first_hit(&Point3::origin(), &Vector3::x()), None);
    assert!(bvh.closest_points(&[Point3::origin()]).is_empty());
}

#[test]
fn extreme_queries_are_answered() {
    let bvh = TriangleBvh::new(corners(&shapes::icosphere(2)));
    for far in [1e19, 1e150, f64::MAX, f64::INFINITY, f64::NAN] {
        assert!(bvh.closest_point(&Point3::new(far, 0.0, 0.0)).is_some());
    }
    let from_afar = bvh.closest_point(&Point3::new(1e7, 0.0, 0.0));
    assert!(from_afar.is_some_and(|p| p.point.x > 0.99));
}

#[test]
fn first_hit_is_the_nearest() {
    let bvh = TriangleBvh::new(corners(&shapes::icosphere(3)));
    let hit = bvh
        .first_hit(&Point3::new(0.1, 0.05, 3.0), &-Vector3::z())
        .expect("it points at the sphere");
    assert!((hit.point.z - 0.99).abs() < 0.01 && (hit.distance - 2.01).abs() < 0.01);
    assert_eq!(
        bvh.first_hit(&Point3::new(2.0, 0.0, 3.0), &-Vector3::z()),
        None
    );
    assert_eq!(bvh.first_hit(&Point3::origin(), &Vector3::zeros()), None);
}

#[test]
fn answers_do_not_depend_on_the_threads() {
    let sphere = shapes::icosphere(3);
    let bvh = TriangleBvh::new(corners(&sphere));
    let queries: Vec<Point3> = sphere.positions.iter().map(|p| p * 1.1).collect();
    let with = |n| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(n)
            .build()
            .unwrap();
        pool.install(|| bvh.closest_points(&queries))
    };
    assert_eq!(with(1), with(4));
    assert_eq!(with(1).len(), queries.len());
}
