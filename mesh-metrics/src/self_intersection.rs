//! Pairs of triangles of one mesh that pass through each other.

use mesh_core::{Aabb, Point3, Positions, TriangleBvh, Triangulation};
use rayon::prelude::*;
use robust::{orient3d, Coord3D};

/// The pairs of triangles that pass through each other at `x`: rows, the lower first, in order.
///
/// A pair counts when an edge of one crosses the inside of the other; the signs are exact. Triangles that only touch,
/// share a corner or an edge, or overlap within one plane do not count: neighbours never do unless one pierces the
/// other, whether or not they name the same vertices.
pub fn self_intersections(triangulation: &Triangulation, x: &Positions) -> Vec<[usize; 2]> {
    let bvh = TriangleBvh::new(triangulation.corners(x).collect());
    let pairs_of = |one: u32| {
        let corners = bvh.triangle(one);
        let mut others = Vec::new();
        bvh.for_each_overlapping(&Aabb::of(&corners), |other| {
            if one < other && is_intersecting(&corners, &bvh.triangle(other)) {
                others.push(other as usize);
            }
        });
        others.sort_unstable();
        others
            .into_iter()
            .map(move |other| [one as usize, other])
            .collect()
    };
    let pairs: Vec<Vec<[usize; 2]>> = (0..bvh.len() as u32)
        .into_par_iter()
        .map(pairs_of)
        .collect();
    pairs.concat()
}

/// The pairs of triangles without a common corner that pass through each other at `x` and did not at `rest`: rows, the lower
/// first, in order.
///
/// This is what other programs count, which cannot tell neighbours that pierce each other from neighbours that touch.
pub fn new_crossings(
    triangulation: &Triangulation,
    rest: &Positions,
    x: &Positions,
) -> Vec<[usize; 2]> {
    let pairs = self_intersections(triangulation, x);
    without_neighbours(
        triangulation,
        &new_intersections(triangulation, rest, pairs),
    )
}

/// Those pairs that do not pass through each other at `rest`.
pub(crate) fn new_intersections(
    triangulation: &Triangulation,
    rest: &Positions,
    mut pairs: Vec<[usize; 2]>,
) -> Vec<[usize; 2]> {
    let at_rest = |t: usize| triangulation.triangles()[t].map(|v| rest[v]);
    pairs.retain(|&[one, two]| !is_intersecting(&at_rest(one), &at_rest(two)));
    pairs
}

/// Those pairs that share no corner.
pub(crate) fn without_neighbours(
    triangulation: &Triangulation,
    pairs: &[[usize; 2]],
) -> Vec<[usize; 2]> {
    let triangles = triangulation.triangles();
    let is_apart = |[one, two]: &[usize; 2]| {
        let other = &triangles[*two];
        !triangles[*one].iter().any(|v| other.contains(v))
    };
    pairs.iter().copied().filter(is_apart).collect()
}

fn is_intersecting(s: &[Point3; 3], t: &[Point3; 3]) -> bool {
    let pierces = |s: &[Point3; 3], t| (0..3).any(|k| is_piercing(s[k], s[(k + 1) % 3], t));
    is_straddling(s, t) && is_straddling(t, s) && (pierces(s, t) || pierces(t, s))
}

/// Whether `s` has corners on both sides of the plane of `t`.
fn is_straddling(s: &[Point3; 3], &[a, b, c]: &[Point3; 3]) -> bool {
    let sides = s.map(|p| orientation(a, b, c, p));
    sides.contains(&1) && sides.contains(&-1)
}

/// Whether the open segment from `p` to `q` crosses the inside of the triangle.
fn is_piercing(p: Point3, q: Point3, &[a, b, c]: &[Point3; 3]) -> bool {
    if orientation(a, b, c, p) * orientation(a, b, c, q) != -1 {
        return false;
    }
    let sides = [
        orientation(p, q, a, b),
        orientation(p, q, b, c),
        orientation(p, q, c, a),
    ];
    sides == [1, 1, 1] || sides == [-1, -1, -1]
}

/// The side of the plane `abc` that `d` is on, exactly: −1, 0 or 1.
fn orientation(a: Point3, b: Point3, c: Point3, d: Point3) -> i8 {
    if [a, b, c].contains(&d) {
        return 0; // neighbours share corners: no need to find this zero in exact arithmetic
    }
    let [a, b, c, d] = [a, b, c, d].map(|p| Coord3D {
        x: p.x,
        y: p.y,
        z: p.z,
    });
    let volume = orient3d(a, b, c, d);
    i8::from(volume > 0.0) - i8::from(volume < 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh_core::{shapes, PolygonSoup, Vector3};

    /// The pairs of several shapes put into one mesh.
    fn pairs_of(shapes: &[PolygonSoup]) -> Vec<[usize; 2]> {
        let mut all = PolygonSoup::default();
        for shape in shapes {
            all.append(shape.clone());
        }
        let (mesh, rest) = all.into_halfedge().unwrap();
        self_intersections(&Triangulation::new(&mesh, &rest), &rest)
    }

    fn moved(mut shape: PolygonSoup, by: [f64; 3]) -> PolygonSoup {
        for p in &mut shape.positions {
            *p += Vector3::from(by);
        }
        shape
    }

    fn triangle(corners: [[f64; 3]; 3]) -> PolygonSoup {
        PolygonSoup {
            positions: corners.map(Point3::from).to_vec(),
            faces: vec![vec![0, 1, 2]],
        }
    }

    #[test]
    fn sound_shapes_have_none() {
        for shape in [
            shapes::icosphere(2),
            shapes::quad_sphere(6),
            shapes::open_grid(5, 5),
            shapes::cone(9),
            shapes::prism(7),
        ] {
            assert_eq!(pairs_of(&[shape]), [] as [[usize; 2]; 0]);
        }
    }

    #[test]
    fn crossing_triangles_are_one_pair_and_touching_ones_none() {
        let floor = triangle([[0., 0., 0.], [4., 0., 0.], [0., 4., 0.]]);
        let wall = triangle([[1., 1., -1.], [1., 1., 1.], [9., 9., 0.]]);
        assert_eq!(pairs_of(&[floor.clone(), wall]), [[0, 1]]);
        let standing = triangle([[1., 1., 0.], [1., 1., 1.], [2., 2., 1.]]);
        assert!(pairs_of(&[floor.clone(), standing]).is_empty());
        let same_corner = triangle([[0., 0., 0.], [-1., 0., 1.], [0., -1., 1.]]);
        assert!(pairs_of(&[floor, same_corner]).is_empty());
    }

    #[test]
    fn a_neighbour_that_pierces_counts() {
        // Two triangles share vertex 0; the far side of the second stabs through the first.
        let soup = PolygonSoup {
            positions: [
                [0., 0., 0.],
                [4., 0., 0.],
                [0., 4., 0.],
                [1., 1., -1.],
                [1.5, 1., 1.],
            ]
            .map(Point3::from)
            .to_vec(),
            faces: vec![vec![0, 1, 2], vec![0, 3, 4]],
        };
        assert_eq!(pairs_of(&[soup]), [[0, 1]]);
    }

    #[test]
    fn crossings_are_new_and_between_triangles_without_a_common_corner() {
        let ball = shapes::icosphere(2);
        let n = ball.positions.len();
        let mut both = ball.clone();
        let moved = |f: &Vec<u32>| f.iter().map(|v| v + n as u32).collect::<Vec<_>>();
        both.faces.extend(ball.faces.iter().map(moved));
        both.positions.extend(&ball.positions);
        let (mesh, x) = both.into_halfedge().unwrap();
        let triangulation = Triangulation::new(&mesh, &x);
        let apart = |by: f64| -> Positions {
            // Not along an axis: edges of mirror images would meet edges, which is touching.
            let shift = Vector3::new(by, 0.1, 0.03);
            let by = |row: usize| if row < n { Vector3::zeros() } else { shift };
            let rows = x.iter().enumerate();
            rows.map(|(row, p)| p + by(row)).collect()
        };
        let (rest, crossed) = (apart(3.0), apart(0.7));
        let crossings = new_crossings(&triangulation, &rest, &crossed);
        assert_eq!(crossings, self_intersections(&triangulation, &crossed));
        assert!(!crossings.is_empty());
        assert!(new_crossings(&triangulation, &crossed, &crossed).is_empty());
    }

    #[test]
    fn overlapping_spheres_meet_and_distant_ones_do_not() {
        let ball = shapes::quad_sphere(5);
        assert!(pairs_of(&[ball.clone(), moved(ball.clone(), [3., 0., 0.])]).is_empty());
        let pairs = pairs_of(&[ball.clone(), moved(ball.clone(), [0.7, 0.1, 0.03])]);
        let n = 2 * ball.faces.len();
        assert!(pairs.len() >= 20);
        assert!(pairs.iter().all(|&[one, other]| one < n && other >= n));
        assert!(pairs.is_sorted());
    }
}
