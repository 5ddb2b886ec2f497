//! Point clouds as targets.

use mesh_core::sampling::SeededRng;
use mesh_core::{
    shapes, Location, NormalSign, Point3, PointCloud, TargetSurface, TopologyError, TriangleSoup,
    Vector3,
};
use proptest::prelude::*;

fn rng(seed: u64) -> SeededRng {
    SeededRng::new(seed)
}

fn scattered(soup: mesh_core::PolygonSoup, n: usize) -> Vec<Point3> {
    let samples = TriangleSoup::new(soup)
        .expect("the shape has faces")
        .sample(n, &mut rng(7));
    samples.into_iter().map(|s| s.point).collect()
}

fn normal(cloud: &PointCloud, index: usize) -> Option<Vector3> {
    cloud.normal(&Location::Point {
        index: index as u32,
    })
}

fn lattice_point() -> impl Strategy<Value = Point3> {
    [-4i32..5, -4i32..5, -4i32..5].prop_map(|p| Point3::from(p.map(f64::from)))
}

proptest! {
    #[test]
    fn closest_point_equals_brute_force(points in prop::collection::vec(lattice_point(), 1..80), queries in prop::collection::vec(lattice_point(), 10)) {
        let cloud = PointCloud::new(points.clone(), None).unwrap();
        for q in queries {
            let closest = cloud.closest_point(&q);
            let distances = points.iter().map(|p| (p - q).norm_squared());
            let (row, d) = distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
            prop_assert_eq!(closest.distance_squared, d);
            prop_assert_eq!(closest.location, Location::Point { index: row as u32 });
        }
    }
}

#[test]
fn estimated_normals_of_a_sphere_point_outwards() {
    let points = scattered(shapes::icosphere(4), 4000);
    let cloud = PointCloud::new(points.clone(), None).unwrap();
    assert_eq!(cloud.normal_sign(), NormalSign::Oriented);
    for (row, p) in points.iter().enumerate() {
        // a patch of 25 of 4000 points spans 0.08 rad from its middle.
        assert!(normal(&cloud, row).is_some_and(|n| n.dot(&p.coords) > 0.99));
    }
}

#[test]
fn given_normals_are_kept_and_their_signs_mended() {
    let points = shapes::icosphere(4).positions;
    let outward: Vec<Vector3> = points.iter().map(|p| p.coords * 3.0).collect();
    let mut rng = rng(3);
    let random: Vec<Vector3> = outward
        .iter()
        .map(|&n| if rng.below(2) == 0 { n } else { -n })
        .collect();
    let inward = outward.iter().map(|n| -n).collect();
    for given in [outward.clone(), random, inward] {
        let cloud = PointCloud::new(points.clone(), Some(given)).unwrap();
        assert_eq!(cloud.normal_sign(), NormalSign::Oriented);
        for (row, p) in points.iter().enumerate() {
            assert!(normal(&cloud, row).is_some_and(|n| (n - p.coords).norm() < 1e-12));
        }
    }
}

#[test]
fn a_flat_cloud_has_no_outside_unless_told() {
    let points = scattered(shapes::open_grid(3, 3), 500);
    assert_eq!(
        PointCloud::new(points.clone(), None).unwrap().normal_sign(),
        NormalSign::Unoriented
    );
    let up = vec![Vector3::z(); points.len()];
    let told = PointCloud::new(points, Some(up)).unwrap();
    assert_eq!(told.normal_sign(), NormalSign::Oriented);
    assert_eq!(normal(&told, 9), Some(Vector3::z()));
}

#[test]
fn boundary_is_the_rim() {
    let points = scattered(shapes::open_grid(10, 10), 5000);
    let cloud = PointCloud::new(points.clone(), None).unwrap();
    let rim = |p: &Point3| p.x.min(p.y).min(10.0 - p.x).min(10.0 - p.y);
    let is_on_boundary = |row: usize| cloud.is_on_boundary(&Location::Point { index: row as u32 });
    let rows = |is_wanted: &dyn Fn(&Point3) -> bool| -> Vec<usize> {
        (0..points.len())
            .filter(|&row| is_wanted(&points[row]))
            .collect()
    };
    // The spacing is 0.14: within 0.02 of the rim a point has next to no neighbour beyond it.
    let outermost = rows(&|p| rim(p) < 0.02);
    let n_found = outermost.iter().filter(|&&row| is_on_boundary(row)).count();
    assert!(
        10 * n_found >= 9 * outermost.len(),
        "{n_found} of {} rim points",
        outermost.len()
    );
    let n_inside = rows(&|p| rim(p) > 0.3)
        .into_iter()
        .filter(|&row| is_on_boundary(row))
        .count();
    assert!(
        n_inside <= points.len() / 500,
        "{n_inside} points inside count as boundary"
    );
}

#[test]
fn a_closed_cloud_has_no_boundary() {
    let points = scattered(shapes::quad_sphere(12), 5000);
    let cloud = PointCloud::new(points, None).unwrap();
    let is_on_boundary = |row| cloud.is_on_boundary(&Location::Point { index: row });
    assert!((0..5000).filter(|&row| is_on_boundary(row)).count() <= 10);
}

#[test]
fn few_or_equal_points_have_no_normal() {
    for n in [1, 2, 40] {
        let cloud = PointCloud::new(vec![Point3::new(1.0, 2.0, 3.0); n], None).unwrap();
        assert_eq!(normal(&cloud, 0), None);
        assert_eq!(cloud.normal_sign(), NormalSign::Unoriented);
        assert_eq!(
            cloud.closest_point(&Point3::origin()).distance_squared,
            14.0
        );
    }
}

#[test]
fn bad_clouds_are_errors() {
    assert_eq!(
        PointCloud::new(Vec::new(), None).err(),
        Some(TopologyError::NoPoints)
    );
    let nan = vec![Point3::origin(), Point3::new(0.0, f64::NAN, 0.0)];
    assert_eq!(
        PointCloud::new(nan, None).err(),
        Some(TopologyError::NonFiniteCoordinate { vertex: 1 })
    );
    let one = Some(vec![Vector3::x()]);
    let count = TopologyError::NormalCount {
        n_normals: 1,
        n_points: 2,
    };
    assert_eq!(
        PointCloud::new(vec![Point3::origin(); 2], one).err(),
        Some(count)
    );
}

#[test]
fn samples_are_points() {
    let points = shapes::tetrahedron().positions;
    let cloud = PointCloud::new(points.clone(), None).unwrap();
    let samples = cloud.sample(4000, &mut rng(5));
    for (row, p) in points.iter().enumerate() {
        let hits = samples
            .iter()
            .filter(|s| s.location == Location::Point { index: row as u32 } && s.point == *p);
        // Four standard deviations of a binomial count.
        assert!(hits.count().abs_diff(1000) < 110);
    }
}

#[test]
fn clouds_do_not_depend_on_the_threads() {
    let points = scattered(shapes::icosphere(2), 3000);
    let with = |n| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(n)
            .build()
            .unwrap();
        let cloud = pool
            .install(|| PointCloud::new(points.clone(), None))
            .unwrap();
        (0..points.len())
            .map(|row| normal(&cloud, row))
            .collect::<Vec<_>>()
    };
    assert_eq!(with(1), with(4));
}
