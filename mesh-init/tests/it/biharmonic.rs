use mesh_core::{shapes, Vector3, VertexId};
use mesh_init::biharmonic_displacement;

use crate::shapes as all_shapes;

#[test]
fn given_displacements_are_met_and_equal_ones_move_everything() {
    let shift = Vector3::new(1.0, -2.0, 0.5);
    for s in all_shapes::all() {
        let held = all_shapes::handles(&s).map(|v| (v, shift));
        let d = biharmonic_displacement(&s.triangulation, &s.rest, &held).unwrap();
        for v in s.mesh.vertices() {
            assert!((d[v] - shift).norm() < 1e-9, "{} {v}", s.name);
        }
        let varied: Vec<(VertexId, Vector3)> = held
            .iter()
            .map(|&(v, d)| (v, d * v.index() as f64))
            .collect();
        let d = biharmonic_displacement(&s.triangulation, &s.rest, &varied).unwrap();
        for (v, expected) in varied {
            assert_eq!(d[v], expected, "{}", s.name);
        }
    }
}

/// On a flat sheet a linear field has no Laplacian inside; the outer two rows fix it.
#[test]
fn linear_fields_continue_linearly_into_a_flat_sheet() {
    let s = all_shapes::shape("open grid", shapes::open_grid(9, 9));
    let linear = |v: VertexId| Vector3::new(0.3 * s.rest[v].x, s.rest[v].y - s.rest[v].x, 2.0);
    let is_outer = |v: &VertexId| {
        let p = s.rest[*v];
        p.x < 1.5 || p.y < 1.5 || p.x > 7.5 || p.y > 7.5
    };
    let held: Vec<_> = s
        .mesh
        .vertices()
        .filter(is_outer)
        .map(|v| (v, linear(v)))
        .collect();
    let d = biharmonic_displacement(&s.triangulation, &s.rest, &held).unwrap();
    for v in s.mesh.vertices() {
        assert!((d[v] - linear(v)).norm() < 1e-9, "{v}");
    }
}

#[test]
fn pieces_without_a_held_vertex_stay() {
    let mut soup = shapes::quad_sphere(3);
    let n = soup.positions.len();
    let second = shapes::tetrahedron();
    soup.positions.extend(
        second
            .positions
            .iter()
            .map(|p| p + Vector3::new(5.0, 0.0, 0.0)),
    );
    soup.faces.extend(
        second
            .faces
            .iter()
            .map(|f| f.iter().map(|v| v + n as u32).collect()),
    );
    let s = all_shapes::shape("two pieces", soup);
    let shift = Vector3::new(0.0, 0.0, 1.0);
    let d =
        biharmonic_displacement(&s.triangulation, &s.rest, &[(VertexId::new(0), shift)]).unwrap();
    for v in s.mesh.vertices() {
        let expected = if v.index() < n {
            shift
        } else {
            Vector3::zeros()
        };
        assert!((d[v] - expected).norm() < 1e-9, "{v}");
    }
}

#[test]
fn a_surface_of_degenerate_faces_still_gets_a_field() {
    let mut s = all_shapes::shape("open grid", shapes::open_grid(6, 6));
    for p in s.rest.iter_mut() {
        p.y = 0.0;
        p.x = p.x.min(2.0);
    }
    let held = [
        (VertexId::new(0), Vector3::x()),
        (VertexId::new(48), Vector3::zeros()),
    ];
    let d = biharmonic_displacement(&s.triangulation, &s.rest, &held).unwrap();
    assert!(d.iter().all(|d| d.iter().all(|c| c.is_finite())));
}
