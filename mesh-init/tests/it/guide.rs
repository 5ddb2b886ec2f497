//! Starts that are led by distances along the surfaces.

use mesh_core::{
    shapes, Landmark, Point3, PointCloud, PolygonSoup, Positions, TargetSurface, TriangleSoup,
    Triangulation, Vector3, VertexId,
};
use mesh_init::{initialize, Guide, GuideConfig, GuideInput, InitConfig, InitInput};

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
        for config in [GuideConfig::stiff(), GuideConfig::soft()] {
            let after = miss(&guided(&bend, target, &config), &bend.truth);
            assert!(after < 0.4 * before, "{before} to {after}");
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
