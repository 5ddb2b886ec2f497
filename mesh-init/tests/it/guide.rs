//! Starts that are led by distances along the surfaces.

use mesh_core::{
    shapes, Landmark, Point3, PointCloud, PolygonSoup, Positions, TargetSurface, TriangleSoup,
    Triangulation, Vector3, VertexId,
};
use mesh_init::{initialize, Guide, GuideConfig, GuideInput, GuideMarks, InitConfig, InitInput};

/// Half the length of the limb, in radii.
const HALF: f64 = 6.0;

/// A long round limb along x.
fn limb(n: usize) -> PolygonSoup {
    let mut soup = shapes::quad_sphere(n);
    for p in &mut soup.positions {
        *p = Point3::new(HALF * p.x, p.y, p.z);
    }
    soup
}

/// Bends what lies beyond x = 0 by `angle` radians, over a knee of four radii.
fn bent(p: &Point3, angle: f64) -> Point3 {
    let knee = 4.0;
    let t = (p.x / knee).clamp(0.0, 1.0);
    let (turn, radius) = (angle * t, knee / angle);
    let along = Vector3::new(turn.cos(), turn.sin(), 0.0);
    let across = Vector3::new(-turn.sin(), turn.cos(), 0.0);
    let middle = Point3::new(radius * turn.sin(), radius * (1.0 - turn.cos()), 0.0)
        + along * (p.x - knee * t);
    middle + across * p.y + Vector3::z() * p.z
}

/// Mean distance of the vertices from where they belong, in longest sides.
fn miss(x: &Positions, truth: &Positions) -> f64 {
    let sum: f64 = x.iter().zip(truth).map(|(p, q)| (p - q).norm()).sum();
    sum / x.len() as f64 / (2.0 * HALF)
}

/// The limb with marks around its root and on one side of its knee: none at the end that turns.
struct Bend {
    triangulation: Triangulation,
    rest: Positions,
    truth: Positions,
    landmarks: Vec<Landmark>,
    mesh: TriangleSoup,
    cloud: PointCloud,
}

fn bend(angle: f64) -> Bend {
    let (mesh, rest) = limb(10).into_halfedge().expect("a limb is a mesh");
    let truth = rest.map(|p| bent(p, angle));
    let nearest = |place: Point3| -> VertexId {
        let squared = |v: &VertexId| (rest[*v] - place).norm_squared();
        rest.ids()
            .min_by(|a, b| squared(a).total_cmp(&squared(b)))
            .expect("a limb has vertices")
    };
    let places = [
        [-HALF, 0.0, 0.0],
        [-3.0, 0.9, 0.0],
        [-3.0, -0.9, 0.0],
        [-3.0, 0.0, 0.9],
        [0.0, 0.0, -1.0],
        [0.0, 1.0, 0.0],
    ];
    let marks = places.map(|p| nearest(Point3::from(p)));
    let mut fine = limb(24);
    fine.positions.iter_mut().for_each(|p| *p = bent(p, angle));
    Bend {
        triangulation: Triangulation::new(&mesh, &rest),
        landmarks: marks.map(|v| Landmark::new(v, truth[v])).to_vec(),
        cloud: PointCloud::new(fine.positions.clone(), None).expect("a limb is a cloud"),
        mesh: TriangleSoup::new(fine).expect("a limb is a surface"),
        rest,
        truth,
    }
}

fn guided(bend: &Bend, target: &dyn TargetSurface, config: &GuideConfig) -> Positions {
    let input = GuideInput {
        triangulation: &bend.triangulation,
        rest: &bend.rest,
        landmarks: &bend.landmarks,
        target,
    };
    let guide = Guide::new(input).expect("a limb with landmarks on it");
    guide.start(config).expect("a limb can be deformed")
}

/// An end without a landmark turns to its counterpart, through 120 degrees, over a mesh and over a cloud.
#[test]
fn an_end_without_a_landmark_turns_whole() {
    let bend = bend(2.1);
    let input = InitInput {
        triangulation: &bend.triangulation,
        rest: &bend.rest,
        landmarks: &bend.landmarks,
        target_frame: bend.mesh.principal_frame(),
    };
    let by_landmarks = initialize(input, &InitConfig::standard()).unwrap();
    let before = miss(&by_landmarks.positions, &bend.truth);
    let targets: [&dyn TargetSurface; 2] = [&bend.mesh, &bend.cloud];
    for target in targets {
        for config in [
            GuideConfig::stiff(),
            GuideConfig::soft(),
            GuideConfig::by_ends(),
        ] {
            let after = miss(&guided(&bend, target, &config), &bend.truth);
            assert!(after < 0.4 * before, "{before} to {after}");
        }
    }
}

/// A limb that is bent so far that its landmarks are near each other says nothing about its size in space; along it they do.
#[test]
fn the_size_given_does_not_matter() {
    let here = bend(2.8);
    let small = Bend {
        rest: here.rest.map(|p| p * 0.2),
        ..bend(2.8)
    };
    let config = GuideConfig::by_ends();
    let expected = guided(&here, &here.mesh, &config);
    let found = guided(&small, &small.mesh, &config);
    assert!(miss(&found, &expected) < 0.02);
    assert!(miss(&found, &here.truth) < 0.05);
}

/// Three arms in a plane, the middle one `lengths[1]` long, and a stem without a landmark; marks stand around the middle.
fn star(lengths: [f64; 4], n: usize) -> PolygonSoup {
    let mut soup = shapes::quad_sphere(n);
    let arms = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)];
    for p in &mut soup.positions {
        let far = arms.iter().zip(lengths).map(|((x, y), length)| {
            let along = (p.x * x + p.y * y).max(0.0);
            Vector3::new(x * length, y * length, 0.0) * along.powi(6)
        });
        *p += far.sum::<Vector3>();
    }
    soup
}

/// Ends that no landmark marks are led to each other, also where a part is twice as long, and none to another's.
#[test]
fn ends_without_landmarks_find_each_other() {
    let (mesh, rest) = star([3.0, 4.0, 2.0, 3.0], 12)
        .into_halfedge()
        .expect("a star is a mesh");
    let truth: Positions = star([3.0, 4.0, 4.0, 3.0], 12)
        .positions
        .into_iter()
        .collect();
    let target = TriangleSoup::new(star([3.0, 4.0, 4.0, 3.0], 24)).expect("a star is a surface");
    let nearest = |place: [f64; 3]| {
        let squared = |v: &VertexId| (rest[*v] - Point3::from(place)).norm_squared();
        let ids = rest.ids();
        ids.min_by(|a, b| squared(a).total_cmp(&squared(b)))
            .expect("a star has vertices")
    };
    let marks = [
        [0.6, 0.6, 0.3],
        [-0.6, 0.6, 0.4],
        [-0.6, -0.6, 0.3],
        [0.0, 0.0, -1.0],
        [0.6, -0.6, 0.5],
    ];
    let landmarks: Vec<Landmark> = marks
        .map(nearest)
        .map(|v| Landmark::new(v, truth[v]))
        .to_vec();
    let input = GuideInput {
        triangulation: &Triangulation::new(&mesh, &rest),
        rest: &rest,
        landmarks: &landmarks,
        target: &target,
    };
    let guide = Guide::new(input).expect("a star with landmarks on it");
    let stiff = GuideConfig {
        marks: GuideMarks::AndEnds,
        ..GuideConfig::stiff()
    };
    for config in [stiff, GuideConfig::by_ends()] {
        let x = guide.start(&config).expect("a star can be deformed");
        for end in [
            [4.0, 0.0, 0.0],
            [0.0, 5.0, 0.0],
            [-3.0, 0.0, 0.0],
            [0.0, -4.0, 0.0],
        ] {
            let v = nearest(end);
            assert!(
                (x[v] - truth[v]).norm() < 0.5,
                "{end:?}: {} instead of {}",
                x[v],
                truth[v]
            );
        }
    }
}

/// The same in other units, turned and elsewhere.
#[test]
fn units_and_frames_do_not_matter() {
    let here = bend(1.2);
    let turn = nalgebra::Rotation3::from_euler_angles(0.4, -1.0, 2.0);
    let there = |p: &Point3| turn * p * 50.0 + Vector3::new(300.0, -20.0, 7.0);
    let mut soup = limb(24);
    soup.positions
        .iter_mut()
        .for_each(|p| *p = there(&bent(p, 1.2)));
    let moved = Bend {
        rest: here.rest.map(there),
        truth: here.truth.map(there),
        landmarks: here
            .landmarks
            .iter()
            .map(|l| Landmark::new(l.source.main_vertex(), there(&l.target)))
            .collect(),
        mesh: TriangleSoup::new(soup).unwrap(),
        ..bend(1.2)
    };
    let config = GuideConfig::soft();
    let expected = guided(&here, &here.mesh, &config).map(there);
    let found = guided(&moved, &moved.mesh, &config);
    // The box, whose longest side is the unit, is another one when the shape is turned.
    assert!(miss(&found, &expected) / 50.0 < 0.01);
}

#[test]
fn without_landmarks_space_leads_and_a_flat_target_is_no_trouble() {
    let here = bend(0.3);
    let free = Bend {
        landmarks: Vec::new(),
        ..bend(0.3)
    };
    let x = guided(&free, &here.mesh, &GuideConfig::soft());
    assert!(miss(&x, &here.truth) < miss(&here.rest, &here.truth));
    let flat = TriangleSoup::new(shapes::open_grid(3, 3)).unwrap();
    let x = guided(&here, &flat, &GuideConfig::stiff());
    assert!(x.iter().all(|p| p.coords.iter().all(|c| c.is_finite())));
}
