//! What touches what among triangles, against a search through all of them.

use mesh_core::{shapes, FaceId, PolygonSoup, Positions, Triangulation, VertexId};

fn built(soup: PolygonSoup) -> (Triangulation, Positions) {
    let (mesh, rest) = soup.into_halfedge().expect("the shape is a mesh");
    (Triangulation::new(&mesh, &rest), rest)
}

/// Closed and open, of triangles and of polygons; one with a fin on its first edge, a double, and a vertex of its own.
fn all() -> Vec<PolygonSoup> {
    let mut branched = shapes::open_grid(3, 2);
    let [a, b] = [branched.faces[0][0], branched.faces[0][1]];
    let n = branched.positions.len() as u32;
    let tip = branched.positions[0] + mesh_core::Vector3::z();
    branched.positions.extend([tip, tip]);
    branched.faces.extend([vec![a, b, n], vec![b, a, n]]);
    vec![
        shapes::tetrahedron(),
        shapes::icosphere(1),
        shapes::quad_sphere(3),
        shapes::open_grid(4, 3),
        shapes::cone(5),
        shapes::prism(7),
        branched,
    ]
}

/// The triangles with both vertices among their corners.
fn sharing(t: &Triangulation, edge: [VertexId; 2]) -> Vec<u32> {
    let has = |corners: &[VertexId; 3]| edge.iter().all(|v| corners.contains(v));
    let triangles = (0u32..).zip(t.triangles());
    triangles.filter(|(_, c)| has(c)).map(|(k, _)| k).collect()
}

#[test]
fn edges_and_their_triangles_are_those_of_a_search() {
    for soup in all() {
        let (t, _) = built(soup);
        let mut expected = Vec::new();
        for a in t.vertices() {
            for b in t.vertices().filter(|&b| a < b) {
                if !sharing(&t, [a, b]).is_empty() {
                    expected.push([a, b]);
                }
            }
        }
        assert_eq!(t.edges(), expected);
        for (e, &edge) in t.edges().iter().enumerate() {
            assert_eq!(t.edge_triangles(e), sharing(&t, edge));
        }
        let interior: Vec<_> = t.interior_edges().map(|e| e.vertices).collect();
        let shared_by_two = |edge: &[VertexId; 2]| sharing(&t, *edge).len() == 2;
        expected.retain(shared_by_two);
        assert_eq!(interior, expected);
    }
}

#[test]
fn triangles_know_their_edges_neighbours_and_open_sides() {
    for soup in all() {
        let (t, _) = built(soup);
        for (row, corners) in t.triangles().iter().enumerate() {
            for k in 0..3 {
                let mut ends = [corners[(k + 1) % 3], corners[(k + 2) % 3]];
                ends.sort_unstable();
                assert_eq!(t.edges()[t.triangle_edges(row)[k]], ends);
                let sharing = sharing(&t, ends);
                let others: Vec<usize> = sharing.iter().map(|&s| s as usize).collect();
                let across = match others[..] {
                    [a, b] => Some(if a == row { b } else { a }),
                    _ => None,
                };
                assert_eq!(t.triangle_neighbours(row)[k], across);
                assert_eq!(t.is_boundary_side(row, k), sharing.len() == 1);
            }
        }
        for v in t.vertices() {
            let open = |(e, edge): (usize, &[VertexId; 2])| {
                edge.contains(&v) && t.edge_triangles(e).len() == 1
            };
            let is_open = t.edges().iter().enumerate().any(open);
            assert_eq!(t.is_boundary_vertex(v), is_open);
        }
    }
}

#[test]
fn vertices_know_their_neighbours_and_triangles() {
    for soup in all() {
        let (t, x) = built(soup);
        assert_eq!(t.n_vertices(), x.len());
        for v in t.vertices() {
            let at = |edge: &&[VertexId; 2]| edge.contains(&v);
            let other = |edge: &[VertexId; 2]| edge[usize::from(edge[0] == v)];
            let mut expected: Vec<VertexId> = t.edges().iter().filter(at).map(other).collect();
            expected.sort_unstable();
            assert_eq!(t.vertex_neighbours(v), expected);
            assert_eq!(t.vertex_triangles(v), sharing(&t, [v, v]));
            assert_eq!(t.is_used(v), !expected.is_empty());
        }
        let used: Vec<VertexId> = t.used_vertices().collect();
        assert!(t.vertices().all(|v| used.contains(&v) == t.is_used(v)));
    }
}

#[test]
fn faces_keep_their_loops_and_own_their_triangles() {
    for soup in all() {
        let faces = soup.faces.clone();
        let (t, _) = built(soup);
        assert_eq!(t.n_faces(), faces.len());
        for (row, corners) in faces.iter().enumerate() {
            let f = FaceId::new(row);
            let loop_of: Vec<u32> = t
                .face_vertices(f)
                .iter()
                .map(|v| v.index() as u32)
                .collect();
            assert_eq!(&loop_of, corners);
            assert_eq!(t.face_triangles(f).len(), corners.len() - 2);
            assert!(t.face_triangles(f).all(|triangle| t.parent(triangle) == f));
        }
    }
}

#[test]
fn pieces_are_what_edges_join() {
    let mut two = shapes::prism(5);
    let n = two.positions.len() as u32;
    two.append(shapes::open_grid(2, 2));
    two.positions.push(mesh_core::Point3::new(9.0, 9.0, 9.0));
    let (t, x) = built(two);
    let pieces = t.pieces();
    assert_eq!(pieces.n, 3);
    let expected = (0..x.len()).map(|v| match v {
        v if v < n as usize => 0,
        v if v + 1 == x.len() => 2,
        _ => 1,
    });
    assert_eq!(pieces.of_vertex, expected.collect::<Vec<u32>>());

    let every_third = |v: VertexId| v.index() % 3 != 1;
    let groups = t.connected_groups(every_third);
    assert_eq!(
        groups.concat().len(),
        t.vertices().filter(|&v| every_third(v)).count()
    );
    for edge in t
        .edges()
        .iter()
        .filter(|e| e.iter().all(|&v| every_third(v)))
    {
        assert!(groups.iter().any(|g| edge.iter().all(|v| g.contains(v))));
    }
    assert!(groups.windows(2).all(|w| w[0][0] < w[1][0]));
}
