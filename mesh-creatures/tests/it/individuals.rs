use mesh_creatures::mesh_core::Triangulation;
use mesh_creatures::{Dial, Individual, Plan, Template};
use mesh_metrics::{folded_edges, self_intersections, triangle_qualities, SKINNY_QUALITY};

const DIALS: [Dial; 3] = [
    Dial {
        angle: 20.0,
        ratio: 1.2,
    },
    Dial::MIDDLE,
    Dial {
        angle: 120.0,
        ratio: 3.0,
    },
];

#[test]
fn individuals_have_the_vertices_and_faces_of_their_template() {
    for plan in Plan::ALL {
        let template = Template::new(&Individual::template(plan), 1);
        for dial in DIALS {
            for seed in 0..4 {
                let other = Template::new(&Individual::drawn(plan, seed, dial), 1);
                assert_eq!(other.soup.faces, template.soup.faces, "{plan} {seed}");
                assert_eq!(other.parts, template.parts, "{plan} {seed}");
                let names = |t: &Template| {
                    t.places
                        .iter()
                        .map(|p| p.name.clone())
                        .collect::<std::collections::BTreeSet<_>>()
                };
                assert_eq!(names(&other), names(&template), "{plan} {seed}");
            }
        }
    }
}

#[test]
fn individuals_neither_fold_nor_pass_through_themselves() {
    for plan in Plan::ALL {
        let rest = Template::new(&Individual::template(plan), 1).soup;
        let (mesh, rest) = rest.into_halfedge().unwrap();
        let triangulation = Triangulation::new(&mesh, &rest);
        for dial in DIALS {
            for seed in 0..4 {
                let moved = Template::new(&Individual::drawn(plan, seed, dial), 1);
                let x = moved.soup.positions.into();
                let folds = folded_edges(&triangulation, &rest, &x).len();
                assert_eq!(folds, 0, "{plan} {seed} {dial:?}");
                let worst = triangle_qualities(&triangulation, &x)
                    .into_iter()
                    .fold(1.0, f64::min);
                assert!(worst > SKINNY_QUALITY, "{plan} {seed} {dial:?}: {worst}");
                // Quads may be cut along the other diagonal at rest than where soundness was looked at.
                let crossings = self_intersections(&triangulation, &x).len();
                assert!(crossings <= 4, "{plan} {seed} {dial:?}: {crossings}");
            }
        }
    }
}

#[test]
fn a_dial_at_its_start_draws_the_template() {
    let still = Dial {
        angle: 0.0,
        ratio: 1.0,
    };
    for plan in Plan::ALL {
        assert_eq!(
            Individual::drawn(plan, 5, still),
            Individual::template(plan),
            "{plan}"
        );
    }
}

#[test]
fn a_seed_draws_one_individual_and_another_seed_another() {
    for plan in Plan::ALL {
        let draw = |seed| Individual::drawn(plan, seed, Dial::MIDDLE);
        assert_eq!(draw(3), draw(3));
        assert_ne!(draw(3), draw(4));
    }
}
