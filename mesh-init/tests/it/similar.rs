use mesh_core::{shapes, Point3, Vector3, VertexId};
use mesh_init::{PulledVertex, SimilarConfig, SimilarSolver};
use nalgebra::Rotation3;

use crate::shapes as all_shapes;

#[test]
fn a_similarity_is_a_fixed_point() {
    let turn = Rotation3::from_euler_angles(0.2, 1.0, -2.0);
    for s in all_shapes::all() {
        let moved = s.rest.map(|p| turn * p * 1.7 + Vector3::new(1.0, 2.0, 3.0));
        let handles = all_shapes::handles(&s);
        let solver = SimilarSolver::new(
            &s.triangulation,
            &s.rest,
            &handles.map(PulledVertex::new),
            SimilarConfig::standard(),
        )
        .unwrap();
        let x = solver.solve(&handles.map(|v| moved[v]), &moved);
        assert!(
            all_shapes::largest_distance(&x, &moved) < 1e-8,
            "{}",
            s.name
        );
    }
}

/// A sheet whose end turns by 70°: a field of displacements shears it, spread rotations bend it.
#[test]
fn a_limb_that_turns_keeps_its_length() {
    let s = all_shapes::shape("strip", shapes::open_grid(24, 4));
    let turn = Rotation3::from_axis_angle(&Vector3::y_axis(), -1.2);
    let bent = |p: &Point3| {
        if p.x < 12.0 {
            *p
        } else {
            turn * (p - Vector3::new(12., 0., 0.)) + Vector3::new(12., 0., 0.)
        }
    };
    let handles: Vec<VertexId> = [0, 8, 16, 24, 104, 112, 120, 124].map(VertexId::new).into();
    let targets: Vec<Point3> = handles.iter().map(|&v| bent(&s.rest[v])).collect();
    let solver = SimilarSolver::new(
        &s.triangulation,
        &s.rest,
        &handles
            .iter()
            .copied()
            .map(PulledVertex::new)
            .collect::<Vec<_>>(),
        SimilarConfig::standard(),
    )
    .unwrap();
    let x = solver.solve(&targets, &s.rest);
    for e in s.mesh.edges() {
        let [a, b] = s.mesh.edge_vertices(e);
        let ratio = (x[a] - x[b]).norm();
        assert!((0.7..1.3).contains(&ratio), "edge {e}: {ratio}");
    }
}
