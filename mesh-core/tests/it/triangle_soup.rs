//! Triangle soups with every defect, as targets.

use mesh_core::sampling::SeededRng;
use mesh_core::{
    shapes, Location, NormalSign, Point3, PolygonSoup, TargetSurface, TopologyError, TriangleSoup,
    Vector3,
};
use nalgebra::Rotation3;

/// The same faces, each with corners of its own, every one turned at random.
fn shuffled(soup: &PolygonSoup, seed: u64) -> PolygonSoup {
    let mut rng = SeededRng::new(seed);
    let mut apart = PolygonSoup::default();
    for face in &soup.faces {
        let from = apart.positions.len() as u32;
        apart
            .positions
            .extend(face.iter().map(|&v| soup.positions[v as usize]));
        let mut corners: Vec<u32> = (from..apart.positions.len() as u32).collect();
        if rng.below(2) == 0 {
            corners.reverse();
        }
        apart.faces.push(corners);
    }
    apart
}

/// Share of random places whose normal points away from the origin.
fn outward_share(target: &TriangleSoup) -> f64 {
    let samples = target.sample(2000, &mut SeededRng::new(1));
    let is_outward = |s: &&mesh_core::SurfaceSample| {
        target
            .normal(&s.location)
            .is_some_and(|n| n.dot(&s.point.coords) > 0.0)
    };
    samples.iter().filter(is_outward).count() as f64 / samples.len() as f64
}

fn target(soup: PolygonSoup) -> TriangleSoup {
    TriangleSoup::new(soup).expect("the shape has faces")
}

#[test]
fn faces_are_turned_outwards() {
    for shape in [shapes::icosphere(3), shapes::quad_sphere(6)] {
        let mut inverted = shape.clone();
        inverted.faces.iter_mut().for_each(|f| f.reverse());
        for soup in [shuffled(&shape, 3), inverted, shape] {
            let target = target(soup);
            assert_eq!(target.normal_sign(), NormalSign::Oriented);
            assert_eq!(outward_share(&target), 1.0);
        }
    }
}

#[test]
fn faces_without_shared_corners_are_turned_by_what_they_see() {
    let mut gaps = shuffled(&shapes::icosphere(2), 5);
    for face in &gaps.faces.clone() {
        let center = face
            .iter()
            .map(|&v| gaps.positions[v as usize].coords)
            .sum::<mesh_core::Vector3>()
            / 3.0;
        for &v in face {
            let p = &mut gaps.positions[v as usize];
            *p = Point3::from(p.coords.lerp(&center, 0.02));
        }
    }
    let target = target(gaps);
    assert_eq!(target.normal_sign(), NormalSign::Oriented);
    assert_eq!(outward_share(&target), 1.0);
}

#[test]
fn an_open_sheet_keeps_the_side_of_its_file() {
    let target = target(shapes::open_grid(4, 3));
    assert_eq!(target.normal_sign(), NormalSign::Oriented);
    for sample in target.sample(50, &mut SeededRng::new(2)) {
        assert!(target.normal(&sample.location).is_some_and(|n| n.z > 0.999));
    }
}

#[test]
fn a_flat_shuffled_sheet_has_no_outside() {
    assert_eq!(
        target(shuffled(&shapes::open_grid(4, 4), 1)).normal_sign(),
        NormalSign::Unoriented
    );
}

#[test]
fn boundary_is_the_rim() {
    for soup in [
        shapes::open_grid(4, 3),
        shuffled(&shapes::open_grid(4, 3), 4),
    ] {
        let target = target(soup);
        assert!(target.has_boundary());
        let is_on_boundary =
            |x, y| target.is_on_boundary(&target.closest_point(&Point3::new(x, y, 0.5)).location);
        assert!(
            is_on_boundary(-1.0, 1.3)
                && is_on_boundary(2.2, 3.0)
                && is_on_boundary(0.0, 0.0)
                && is_on_boundary(9.0, 9.0)
        );
        assert!(
            !is_on_boundary(0.5, 0.5)
                && !is_on_boundary(1.0, 1.0)
                && !is_on_boundary(2.0, 1.4)
                && !is_on_boundary(0.01, 1.5)
        );
    }
    for soup in [shapes::icosphere(2), shapes::prism(5)] {
        let target = target(soup);
        assert!(!target.has_boundary());
        let samples = target.vertices();
        assert!(samples
            .iter()
            .all(|p| !target.is_on_boundary(&target.closest_point(p).location)));
    }
}

#[test]
fn defects_do_no_harm() {
    let mut soup = shapes::icosphere(2);
    let n = soup.positions.len() as u32;
    soup.positions.extend([
        Point3::new(50.0, 0.0, 0.0),
        soup.positions[0],
        soup.positions[0],
    ]);
    let first = soup.faces[0].clone();
    soup.faces.push(first.iter().rev().copied().collect());
    soup.faces.push(vec![first[0], first[0], first[1]]);
    soup.faces.push(vec![n + 1, first[1], n + 2]);
    let target = target(soup);
    assert!(!target.has_boundary());
    assert_eq!(target.normal_sign(), NormalSign::Oriented);
    assert_eq!(outward_share(&target), 1.0);
    assert_eq!(target.vertices().len(), n as usize);
    assert!(target.bounds().longest_side() < 2.1);
}

#[test]
fn a_target_without_triangles_is_an_error() {
    let no_faces = TriangleSoup::new(PolygonSoup {
        faces: vec![vec![0, 0, 1]],
        ..shapes::tetrahedron()
    });
    assert_eq!(no_faces.err(), Some(TopologyError::NoFaces));
    let out_of_range = TriangleSoup::new(PolygonSoup {
        faces: vec![vec![0, 1, 9]],
        ..shapes::tetrahedron()
    });
    assert!(matches!(
        out_of_range.err(),
        Some(TopologyError::VertexOutOfRange { vertex: 9, .. })
    ));
}

/// A cone is sampled in proportion to its area: below height h lies the share 1 − (1 − h)².
#[test]
fn samples_are_uniform_by_area() {
    let target = target(shapes::cone(64));
    let n = 20_000;
    let samples = target.sample(n, &mut SeededRng::new(11));
    for h in [0.1, 0.3, 0.5, 0.8] {
        let expected = 1.0 - (1.0 - h) * (1.0 - h);
        let share = samples.iter().filter(|s| s.point.z < h).count() as f64 / n as f64;
        // Four standard deviations of a binomial share.
        assert!((share - expected).abs() < 4.0 * (expected * (1.0 - expected) / n as f64).sqrt());
    }
    for s in &samples {
        let Location::Triangle { index, barycentric } = s.location else {
            unreachable!("a soup has triangles")
        };
        let corners = target.bvh().triangle(index);
        let point = (0..3)
            .map(|k| corners[k].coords * barycentric[k])
            .sum::<mesh_core::Vector3>();
        assert!((point - s.point.coords).norm() < 1e-15 && barycentric.iter().all(|&w| w >= 0.0));
    }
}

#[test]
fn cracks_and_single_missing_faces_are_no_boundary_and_holes_are() {
    // Corners of their own, a thousandth of a side apart, and every eleventh face missing.
    let mut cracked = shuffled(&shapes::icosphere(3), 7);
    for (k, p) in cracked.positions.iter_mut().enumerate() {
        *p *= 1.0 + 1e-4 * ((k % 7) as f64 - 3.0);
    }
    let whole = cracked.faces.len();
    let mut row = 0;
    cracked.faces.retain(|_| {
        row += 1;
        row % 11 != 0
    });
    assert!(cracked.faces.len() < whole);
    let share = |target: &TriangleSoup| {
        let out: Vec<Point3> = target.vertices().iter().map(|p| p * 1.2).collect();
        let hits = target.closest_points(&out);
        let open = hits.iter().filter(|h| target.is_on_boundary(&h.location));
        open.count() as f64 / out.len() as f64
    };
    assert!(share(&target(cracked.clone())) < 0.02);

    // Half a ball ends at a rim, cracked or not.
    let centre_up = |f: &Vec<u32>| {
        f.iter()
            .map(|&v| cracked.positions[v as usize].z)
            .sum::<f64>()
    };
    let half = PolygonSoup {
        faces: cracked
            .faces
            .iter()
            .filter(|f| centre_up(f) > 0.0)
            .cloned()
            .collect(),
        ..cracked.clone()
    };
    let half = target(half);
    assert!(half.has_boundary());
    let below: Vec<Point3> = (0..40)
        .map(|k| 0.157 * f64::from(k))
        .map(|turn| Point3::new(turn.cos(), turn.sin(), -0.3))
        .collect();
    let hits = half.closest_points(&below);
    let open = hits
        .iter()
        .filter(|h| half.is_on_boundary(&h.location))
        .count();
    assert!(open > 30, "{open}");
}

#[test]
fn normals_turn_with_the_shape() {
    // Loose triangles all over the place: no side of theirs is surely outside.
    let mut rng = SeededRng::new(3);
    let mut random = || Point3::from(Vector3::from_fn(|_, _| rng.uniform()));
    let loose = PolygonSoup {
        positions: (0..900).map(|_| random()).collect(),
        faces: (0..300)
            .map(|t| vec![3 * t, 3 * t + 1, 3 * t + 2])
            .collect(),
    };
    let turn = Rotation3::from_euler_angles(0.7, -1.1, 2.3);
    let mut turned = loose.clone();
    turned.positions.iter_mut().for_each(|p| *p = turn * *p);
    let [loose, turned] = [loose, turned].map(|soup| TriangleSoup::new(soup).unwrap());
    for index in 0..300 {
        let middle = Location::Triangle {
            index,
            barycentric: [0.3, 0.3, 0.4],
        };
        let [n, m] = [&loose, &turned].map(|target| target.normal(&middle).unwrap());
        assert!((turn * n - m).norm() < 1e-9, "triangle {index}");
    }
}
