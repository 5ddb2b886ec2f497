use mesh_core::{shapes, Point3, Positions, Vector3, VertexId};
use mesh_init::{ArapScratch, ArapSolver};
use nalgebra::Rotation3;

use crate::shapes as all_shapes;

#[test]
fn a_rigid_motion_is_a_fixed_point_without_energy() {
    let turn = Rotation3::from_euler_angles(1.0, 2.0, -0.5);
    for s in all_shapes::all() {
        let moved = s.rest.map(|p| turn * p + Vector3::new(3.0, 0.0, -1.0));
        let solver = ArapSolver::new(&s.triangulation, &s.rest, &all_shapes::handles(&s)).unwrap();
        assert!(solver.energy(&moved) < 1e-20, "{}", s.name);
        let mut x = moved.clone();
        solver.step(&mut x, &mut ArapScratch::default());
        assert!(
            all_shapes::largest_distance(&x, &moved) < 1e-10,
            "{}",
            s.name
        );
    }
}

#[test]
fn held_vertices_are_met_and_energy_never_rises() {
    for s in all_shapes::all() {
        let held = all_shapes::handles(&s);
        let solver = ArapSolver::new(&s.triangulation, &s.rest, &held).unwrap();
        // A violent start: every vertex thrown somewhere, held ones far apart.
        let mut x: Positions = s
            .mesh
            .vertices()
            .map(|v| {
                s.rest[v]
                    + Vector3::new(
                        (9.7 * v.index() as f64).sin(),
                        (3.1 * v.index() as f64).cos(),
                        0.3,
                    ) * 2.0
            })
            .collect();
        let targets = held.map(|v| x[v]);
        let mut scratch = ArapScratch::default();
        let mut energy = f64::INFINITY;
        for _ in 0..25 {
            let before = solver.step(&mut x, &mut scratch);
            assert!(
                before >= 0.0 && before <= energy * (1.0 + 1e-12),
                "{}: {before} after {energy}",
                s.name
            );
            energy = before;
        }
        for (v, target) in held.iter().zip(targets) {
            assert_eq!(x[*v], target, "{}", s.name);
        }
        assert!(solver.energy(&solver.solve(&targets, &x)) <= energy * (1.0 + 1e-12));
    }
}

#[test]
fn a_bent_strip_keeps_its_sides() {
    let s = all_shapes::shape("strip", shapes::open_grid(20, 3));
    let ends: Vec<VertexId> = s
        .mesh
        .vertices()
        .filter(|&v| s.rest[v].x < 1.5 || s.rest[v].x > 18.5)
        .collect();
    let turn = Rotation3::from_axis_angle(&Vector3::y_axis(), -1.2);
    let bent = |p: &Point3| {
        if p.x < 10.0 {
            *p
        } else {
            turn * (p - Vector3::new(10., 0., 0.)) + Vector3::new(10., 0., 0.)
        }
    };
    let targets: Vec<Point3> = ends.iter().map(|&v| bent(&s.rest[v])).collect();
    let x = ArapSolver::new(&s.triangulation, &s.rest, &ends)
        .unwrap()
        .solve(&targets, &s.rest);
    for e in s.mesh.edges() {
        let [a, b] = s.mesh.edge_vertices(e);
        let ratio = (x[a] - x[b]).norm() / (s.rest[a] - s.rest[b]).norm();
        assert!((0.8..1.2).contains(&ratio), "edge {e}: {ratio}");
    }
}
