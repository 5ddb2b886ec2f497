use mesh_creatures::mesh_core::{measure, Point3, Triangulation};
use mesh_creatures::{Individual, Plan, Template};

#[test]
fn templates_are_closed_quads_of_genus_0_that_turn_outwards() {
    for plan in Plan::ALL {
        for n_splits in [0, 1, 2] {
            let template = Template::new(&Individual::template(plan), n_splits);
            assert!(template.soup.faces.iter().all(|f| f.len() == 4), "{plan}");
            let (mesh, x) = template.soup.clone().into_halfedge().unwrap();
            assert!(mesh.boundary_loops().is_empty(), "{plan}");
            assert_eq!(mesh.n_cut_edges(), 0, "{plan}");
            assert_eq!(
                mesh.n_vertices() + mesh.n_faces() - mesh.n_edges(),
                2,
                "{plan}"
            );
            let triangulation = Triangulation::new(&mesh, &x);
            assert_eq!(triangulation.pieces().n, 1, "{plan}");
            let volume: f64 = triangulation
                .corners(&x)
                .map(|[a, b, c]| a.coords.dot(&b.coords.cross(&c.coords)) / 6.0)
                .sum();
            assert!(volume > 0.0, "{plan}");
        }
    }
}

#[test]
fn templates_have_a_few_thousand_vertices() {
    for plan in Plan::ALL {
        let n = Template::new(&Individual::template(plan), 1)
            .soup
            .positions
            .len();
        assert!((1_200..=4_000).contains(&n), "{plan}: {n}");
    }
}

#[test]
fn finer_templates_have_the_vertices_of_the_coarser_ones() {
    for plan in Plan::ALL {
        let [coarse, fine] = [1, 2].map(|n| Template::new(&Individual::template(plan), n));
        for (p, q) in coarse.soup.positions.iter().zip(&fine.soup.positions) {
            assert!((p - q).norm() < 1e-12, "{plan}: {p} {q}");
        }
        assert_eq!(coarse.places, fine.places, "{plan}");
    }
}

#[test]
fn creatures_are_as_alike_left_and_right() {
    for plan in Plan::ALL {
        let template = Template::new(&Individual::template(plan), 1);
        let x = &template.soup.positions;
        for p in x {
            let mirrored = Point3::new(-p.x, p.y, p.z);
            assert!(
                x.iter().any(|q| (q - mirrored).norm() < 1e-9),
                "{plan}: {p}"
            );
        }
    }
}

#[test]
fn texture_tiles_do_not_overlap_and_turn_one_way() {
    for plan in Plan::ALL {
        let template = Template::new(&Individual::template(plan), 1);
        let area = |uv: &[[f64; 2]; 4]| {
            let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
            0.5 * (0..4).map(|k| cross(uv[k], uv[(k + 1) % 4])).sum::<f64>()
        };
        let areas: Vec<f64> = template.uvs.iter().map(area).collect();
        assert!(areas.iter().all(|&a| a > 0.0), "{plan}");
        assert!(areas.iter().sum::<f64>() < 1.0, "{plan}");
        let inside = |x: &f64| (0.0..=1.0).contains(x);
        assert!(
            template.uvs.iter().flatten().flatten().all(inside),
            "{plan}"
        );
    }
}

#[test]
fn parts_and_places_have_names_of_their_own() {
    for plan in Plan::ALL {
        let template = Template::new(&Individual::template(plan), 1);
        assert!(
            template.places.len() >= 20,
            "{plan}: {}",
            template.places.len()
        );
        for (k, place) in template.places.iter().enumerate() {
            let others = &template.places[..k];
            assert!(
                others.iter().all(|o| o.name != place.name),
                "{plan}: {}",
                place.name
            );
            assert!(
                others.iter().all(|o| o.vertex != place.vertex),
                "{plan}: {}",
                place.name
            );
        }
        let used = |part: usize| template.parts.contains(&part);
        assert!((0..template.part_names.len()).all(used), "{plan}");
    }
}

#[test]
fn the_first_places_are_far_apart() {
    for plan in Plan::ALL {
        let template = Template::new(&Individual::template(plan), 1);
        let x = &template.soup.positions;
        let size = measure::Aabb::of(x).longest_side();
        let first: Vec<_> = template.places[..5].iter().map(|p| x[p.vertex]).collect();
        for (k, p) in first.iter().enumerate() {
            let apart = |q: &mesh_creatures::mesh_core::Point3| (p - q).norm() > 0.25 * size;
            assert!(first[..k].iter().all(apart), "{plan}");
        }
    }
}
