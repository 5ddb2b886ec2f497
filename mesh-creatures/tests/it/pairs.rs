use mesh_creatures::mesh_core::{
    io, Aabb, Point3, TargetSurface as _, TriangleSoup, Triangulation,
};
use mesh_creatures::{CreaturePair, Dial, Individual, PairConfig, Plan, Variant};
use mesh_metrics::{self_intersections, triangle_qualities};

fn pair(plan: Plan, seed: u64, dial: Dial, config: &PairConfig) -> CreaturePair {
    let [source, target] = [
        Individual::template(plan),
        Individual::drawn(plan, seed, dial),
    ];
    CreaturePair::new(&source, &target, config)
}

#[test]
fn the_truth_lies_on_the_target() {
    let hard = Dial {
        angle: 120.0,
        ratio: 3.0,
    };
    for plan in Plan::ALL {
        for (seed, dial) in [(0, Dial::MIDDLE), (1, Dial::MIDDLE), (2, hard)] {
            let pair = pair(plan, seed, dial, &PairConfig::standard());
            let target = TriangleSoup::new(pair.target).unwrap();
            let size = target.bounds().longest_side();
            let closest = target.closest_points(&pair.truth);
            let far: Vec<f64> = closest
                .iter()
                .map(|c| c.distance_squared.sqrt() / size)
                .collect();
            let worst = far.iter().copied().fold(0.0, f64::max);

            assert!(worst < 0.003, "{plan} {seed}: {worst}");
            let mean = far.iter().sum::<f64>() / far.len() as f64;
            assert!(mean < 4e-4, "{plan} {seed}: {mean}");
        }
    }
}

#[test]
fn targets_are_closed_sound_and_have_none_of_the_templates_vertices() {
    for plan in Plan::ALL {
        let pair = pair(plan, 1, Dial::MIDDLE, &PairConfig::standard());
        let size = Aabb::of(&pair.truth).longest_side();
        let (mesh, x) = pair.target.clone().into_halfedge().unwrap();
        assert!(
            mesh.boundary_loops().is_empty() && mesh.n_cut_edges() == 0,
            "{plan}"
        );
        assert_eq!(
            mesh.n_vertices() + mesh.n_faces() - mesh.n_edges(),
            2,
            "{plan}"
        );
        let triangulation = Triangulation::new(&mesh, &x);
        let worst = triangle_qualities(&triangulation, &x)
            .into_iter()
            .fold(1.0, f64::min);
        assert!(worst > 0.02, "{plan}: {worst}");
        let crossings = self_intersections(&triangulation, &x).len();
        assert!(crossings <= 4, "{plan}: {crossings}");
        let near = |p: &Point3| pair.truth.iter().any(|q| (p - q).norm() < 1e-6 * size);
        assert_eq!(
            pair.target.positions.iter().filter(|p| near(p)).count(),
            0,
            "{plan}"
        );
    }
}

#[test]
fn variants_are_what_their_names_say() {
    let config = |variant| PairConfig {
        variant,
        ..PairConfig::standard()
    };
    let plan = Plan::ALL[0];
    let of = |variant| pair(plan, 1, Dial::MIDDLE, &config(variant));
    let whole = of(Variant::Mesh);
    let surface = TriangleSoup::new(whole.target.clone()).unwrap();
    let size = surface.bounds().longest_side();

    let cloud = of(Variant::Cloud);
    assert!(cloud.target.faces.is_empty());
    assert_eq!(
        cloud.normals.map(|n| n.len()),
        Some(cloud.target.positions.len())
    );
    let off = surface.closest_points(&cloud.target.positions);
    assert!(off.iter().all(|c| c.distance_squared.sqrt() < 1e-9 * size));

    let cracked = of(Variant::Cracked);
    assert_eq!(cracked.target.positions.len(), 3 * whole.target.faces.len());
    let off = surface.closest_points(&cracked.target.positions);
    assert!(off.iter().all(|c| c.distance_squared.sqrt() < 1e-3 * size));

    let scan = of(Variant::HalfScan);
    let share = scan.target.faces.len() as f64 / whole.target.faces.len() as f64;
    assert!((0.2..0.5).contains(&share), "{share}");
    assert_eq!(scan.truth, whole.truth);
}

#[test]
fn landmarks_are_the_first_places_but_those_of_parts_left_out() {
    let plan = Plan::Quadruped;
    let config = PairConfig {
        n_landmarks: 5,
        ..PairConfig::standard()
    };
    let few = pair(plan, 0, Dial::MIDDLE, &config);
    assert_eq!(few.landmarks.len(), 5);
    for l in &few.landmarks {
        assert_eq!(l.target, few.truth[l.vertex]);
    }
    let config = PairConfig {
        n_landmarks: 20,
        without: vec!["tail".into()],
        ..config
    };
    let tailless = pair(plan, 0, Dial::MIDDLE, &config);
    assert!(tailless.landmarks.iter().all(|l| !l.name.contains("tail")));
}

#[test]
fn files_read_back_as_they_are() {
    let folder = std::env::temp_dir().join("mesh_creatures_files");
    std::fs::create_dir_all(&folder).unwrap();
    let config = PairConfig {
        variant: Variant::Cloud,
        ..PairConfig::standard()
    };
    let pair = pair(Plan::Quadruped, 0, Dial::MIDDLE, &config);
    let read = |name: &str, text: String| {
        let path = folder.join(name);
        std::fs::write(&path, text).unwrap();
        io::read_mesh(&path).unwrap()
    };
    let source = read("source.obj", pair.source.to_obj());
    assert_eq!(source.soup().positions.len(), pair.truth.len());
    assert_eq!(source.soup().faces.len(), pair.source.soup.faces.len());
    let truth = read("truth.ply", pair.truth_ply());
    for (p, q) in truth.soup().positions.iter().zip(&pair.truth) {
        assert!((p - q).norm() < 1e-6);
    }
    let cloud = read("cloud.ply", pair.target_ply());
    assert_eq!(
        cloud.vertex_normals().map(|n| n.len()),
        Some(pair.target.positions.len())
    );
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn the_same_pair_has_the_same_bits() {
    let make = || pair(Plan::Quadruped, 2, Dial::MIDDLE, &PairConfig::standard());
    let [one, other] = [make(), make()];
    assert_eq!(one.target, other.target);
    assert_eq!(one.truth, other.truth);
}
