//! Polygons cut into triangles.

use spade::{ConstrainedDelaunayTriangulation, Triangulation as _};

use crate::measure::triangle_quality;
use crate::{HalfedgeMesh, Point3, Positions, Vector3, VertexId};

/// The triangles of polygons, without what touches what.
pub(crate) struct Cut {
    /// Those of one face together, in face order.
    pub(crate) triangles: Vec<[VertexId; 3]>,
    /// As simple programs cut, as many a face.
    pub(crate) simple: Vec<[VertexId; 3]>,
    /// The first triangle of each face, and how many there are in all.
    pub(crate) face_starts: Vec<u32>,
}

impl Cut {
    /// Cuts every face of `mesh` on the shape `rest`.
    pub(crate) fn new(mesh: &HalfedgeMesh, rest: &Positions) -> Self {
        let mut triangles = Vec::with_capacity(mesh.n_faces() * 2);
        let mut simple = Vec::with_capacity(mesh.n_faces() * 2);
        let mut face_starts = vec![0];
        for f in mesh.faces() {
            match *mesh.face_vertices(f) {
                [] => {}
                [a, b, c] => {
                    triangles.push([a, b, c]);
                    simple.push([a, b, c]);
                }
                [a, b, c, d] => {
                    let quad = [a, b, c, d];
                    let normal = polygon_area_vector(&quad.map(|v| rest[v]));
                    triangles.extend(split_quad(quad, |t| signed_quality(t, rest, &normal)));
                    simple.extend(split_quad(quad, |t| triangle_quality(t.map(|v| rest[v]))));
                }
                ref polygon => {
                    triangles.extend(split_polygon(polygon, rest));
                    simple.extend(fan(polygon));
                }
            }
            face_starts.push(triangles.len() as u32);
        }
        Self {
            triangles,
            simple,
            face_starts,
        }
    }
}

/// Area vector of a polygon (Newell): twice the area of its projection times the normal.
fn polygon_area_vector(points: &[Point3]) -> Vector3 {
    let origin = points[0];
    points
        .windows(2)
        .map(|side| (side[0] - origin).cross(&(side[1] - origin)))
        .sum()
}

/// Quality of a triangle, negative when it turns against `normal`.
fn signed_quality(triangle: [VertexId; 3], rest: &Positions, normal: &Vector3) -> f64 {
    let corners = triangle.map(|v| rest[v]);
    triangle_quality(corners) * crate::measure::area_vector(corners).dot(normal).signum()
}

/// The quad along the diagonal whose worst triangle has the better quality.
fn split_quad(
    [a, b, c, d]: [VertexId; 4],
    quality: impl Fn([VertexId; 3]) -> f64,
) -> [[VertexId; 3]; 2] {
    let worst = |[one, two]: [[VertexId; 3]; 2]| quality(one).min(quality(two));
    let (first, second) = ([[a, b, c], [a, c, d]], [[a, b, d], [b, c, d]]);
    if worst(first) >= worst(second) {
        first
    } else {
        second
    }
}

/// The triangles from the first corner of a polygon; none of fewer than three corners.
pub(crate) fn fan<T: Copy>(polygon: &[T]) -> impl Iterator<Item = [T; 3]> + '_ {
    let sides = polygon.windows(2).skip(1);
    sides.map(|side| [polygon[0], side[0], side[1]])
}

/// Constrained Delaunay triangulation of the polygon, projected along its area vector; a fan where the projection
/// crosses itself.
fn split_polygon(polygon: &[VertexId], rest: &Positions) -> Vec<[VertexId; 3]> {
    planar_delaunay(polygon, rest)
        .filter(|triangles| triangles.len() == polygon.len() - 2)
        .unwrap_or_else(|| fan(polygon).collect())
}

fn planar_delaunay(polygon: &[VertexId], rest: &Positions) -> Option<Vec<[VertexId; 3]>> {
    let points: Vec<Point3> = polygon.iter().map(|&v| rest[v]).collect();
    let normal = polygon_area_vector(&points).try_normalize(f64::MIN_POSITIVE)?;
    let axis = if normal.x.abs() < 0.7 {
        Vector3::x()
    } else {
        Vector3::y()
    };
    let u = normal.cross(&axis).try_normalize(f64::MIN_POSITIVE)?;
    let v = normal.cross(&u);
    let size = crate::Aabb::of(&points).longest_side();
    let flat: Vec<[f64; 2]> = points
        .iter()
        .map(|p| {
            [
                (p - points[0]).dot(&u) / size,
                (p - points[0]).dot(&v) / size,
            ]
        })
        .collect();

    let mut rows = inner_triangles(&flat)?;
    rows.sort_unstable();
    Some(
        rows.into_iter()
            .map(|t| t.map(|row| polygon[row]))
            .collect(),
    )
}

/// Polygons with more corners than this are inserted in rounds: in turn, a corner that sees many others along a straight
/// side costs as much as these are. For smaller ones that would only choose otherwise between triangles on one circle.
const LARGE: usize = 1000;

/// The rows from 0 to n in the order in which they are inserted: in turn, or in rounds of a fixed pseudo-random half of
/// what is left each (biased randomised insertion order, Amenta, Choi and Rote 2003), those of a round in turn.
fn insertion_order(n: usize) -> Vec<usize> {
    let mut rows: Vec<usize> = (0..n).collect();
    if n > LARGE {
        // Fibonacci hashing; its high bits are the good ones.
        let round = |row: usize| {
            (row as u64)
                .wrapping_mul(0x9E37_79B9_7F4A_7C15)
                .leading_zeros()
        };
        rows.sort_by_key(|&row| std::cmp::Reverse(round(row)));
    }
    rows
}

type Delaunay = ConstrainedDelaunayTriangulation<spade::Point2<f64>>;

/// The triangles inside the loop `flat` of its constrained Delaunay triangulation; none where corners coincide or sides
/// cross.
fn inner_triangles(flat: &[[f64; 2]]) -> Option<Vec<[usize; 3]>> {
    let n = flat.len();
    let order = insertion_order(n);
    let mut delaunay = Delaunay::new();
    let mut handle_of = vec![None; n];
    for (nth, &row) in order.iter().enumerate() {
        let [s, t] = flat[row];
        let handle = delaunay.insert(spade::Point2::new(s, t)).ok()?;
        if handle.index() != nth {
            return None;
        }
        handle_of[row] = Some(handle);
    }
    for row in 0..n {
        let (from, to) = handle_of[row].zip(handle_of[(row + 1) % n])?;
        if !delaunay.can_add_constraint(from, to) && !delaunay.exists_constraint(from, to) {
            return None;
        }
        delaunay.add_constraint(from, to);
    }
    let is_inside = inside(&delaunay);
    let inner = delaunay
        .inner_faces()
        .filter(|face| is_inside[face.index()]);
    let rows = inner.map(|face| face.vertices().map(|vertex| order[vertex.index()]));
    Some(rows.map(lowest_first).collect())
}

/// Whether each face lies inside the loop of constraint edges, by the even–odd rule: whether an odd number of them is
/// crossed on the way in from the outer face.
fn inside(delaunay: &Delaunay) -> Vec<bool> {
    let outer = delaunay.outer_face();
    let mut is_inside = vec![None; delaunay.num_all_faces()];
    is_inside[outer.index()] = Some(false);
    let from_outside = delaunay
        .directed_edges()
        .filter(|edge| edge.face() == outer);
    let mut open: Vec<_> = from_outside.collect();
    while let Some(edge) = open.pop() {
        let (here, there) = (edge.face().index(), edge.rev().face());
        if is_inside[there.index()].is_some() {
            continue;
        }
        let is_crossing = edge.is_constraint_edge();
        is_inside[there.index()] = is_inside[here].map(|here| here != is_crossing);
        let sides = there.as_inner().map(|face| face.adjacent_edges());
        open.extend(sides.into_iter().flatten());
    }
    is_inside
        .into_iter()
        .map(|inside| inside == Some(true))
        .collect()
}

/// The same loop, starting at its lowest row.
fn lowest_first(t: [usize; 3]) -> [usize; 3] {
    let [a, b, c] = t;
    if a <= b && a <= c {
        [a, b, c]
    } else if b <= c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{PolygonSoup, Triangulation};

    fn triangulate(points: &[[f64; 3]]) -> Triangulation {
        let soup = PolygonSoup {
            positions: points.iter().map(|&p| Point3::from(p)).collect(),
            faces: vec![(0..points.len() as u32).collect()],
        };
        let (mesh, rest) = soup.into_halfedge().unwrap();
        Triangulation::new(&mesh, &rest)
    }

    fn area(points: &[[f64; 3]]) -> f64 {
        let x: Positions = points.iter().map(|&p| Point3::from(p)).collect();
        triangulate(points)
            .corners(&x)
            .map(crate::measure::triangle_area)
            .sum()
    }

    #[test]
    fn concave_quad_is_split_inside() {
        let arrow = [[0., 0., 0.], [2., 0., 0.], [0.5, 0.5, 0.], [0., 2., 0.]];
        assert!((area(&arrow) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn simple_programs_cut_concave_quads_outside_and_polygons_as_fans() {
        // The kite's inner diagonal cuts slivers, the outer one covers area twice.
        let kite = [[0., 0., 0.], [1., 5., 0.], [0., 0.5, 0.], [-1., 5., 0.]];
        let simple = triangulate(&kite).simply_cut().unwrap();
        let rows = |t: &[VertexId; 3]| t.map(VertexId::index);
        let cut: Vec<_> = simple.triangles().iter().map(rows).collect();
        assert_eq!(cut, [[0, 1, 3], [1, 2, 3]]);
        assert_eq!(simple.parent(1), triangulate(&kite).parent(1));

        let square = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]];
        assert_eq!(triangulate(&square).simply_cut(), None);
        let house = [
            [0., 0., 0.],
            [1., 0., 0.],
            [1., 1., 0.],
            [0.5, 1.5, 0.],
            [0., 1., 0.],
        ];
        let cut = triangulate(&house).simply_cut();
        let has_fan = cut.is_some_and(|t| t.triangles().iter().all(|t| t[0].index() == 0));
        assert!(has_fan);
    }

    #[test]
    fn concave_polygon_keeps_its_area() {
        let l_shape = [
            [0., 0., 0.],
            [2., 0., 0.01],
            [2., 1., 0.],
            [1., 1., 0.],
            [1., 2., -0.01],
            [0., 2., 0.],
        ];
        let triangles = triangulate(&l_shape);
        assert_eq!(triangles.len(), 4);
        assert!((area(&l_shape) - 3.0).abs() < 1e-3);
    }

    /// Closed form: a simple polygon of n corners is n − 2 triangles of its area, whatever n is. Work that grew with the
    /// square of n took 36 s for the largest of these.
    #[test]
    fn large_polygons_are_cut_at_once() {
        let round = |n: usize| {
            (0..n).map(move |k| {
                let angle = k as f64 / n as f64 * std::f64::consts::TAU;
                let radius = 1.0 + 0.5 * (7.0 * angle).sin();
                [radius * angle.cos(), radius * angle.sin(), 0.0]
            })
        };
        let strip = |n: usize| {
            let half = n / 2;
            (0..n).map(move |k| match k < half {
                true => [k as f64, 0.0, 0.0],
                false => [(n - 1 - k) as f64, 1.0, 0.0],
            })
        };
        let start = std::time::Instant::now();
        for n in [990, 1010, 100_000] {
            let strip: Vec<_> = strip(n).collect();
            assert_eq!(triangulate(&strip).len(), n - 2);
            let area_of_strip = (n / 2 - 1) as f64;
            assert!((area(&strip) / area_of_strip - 1.0).abs() < 1e-9);
            let round: Vec<_> = round(n).collect();
            assert_eq!(triangulate(&round).len(), n - 2);
        }
        assert!(start.elapsed().as_secs() < 30);
    }

    /// Brute force: the centre of each triangle is inside by the even–odd rule.
    #[test]
    fn triangles_of_concave_polygons_are_inside() {
        for seed in 1..200u32 {
            let n = 5 + seed as usize % 40;
            let points: Vec<[f64; 3]> = (0..n)
                .map(|k| {
                    let angle = k as f64 / n as f64 * std::f64::consts::TAU;
                    let radius = 1.0 + 0.9 * (f64::from(seed) * 12.9898 * (k + 1) as f64).sin();
                    [radius * angle.cos(), radius * angle.sin(), 0.0]
                })
                .collect();
            let triangles = triangulate(&points);
            assert_eq!(triangles.len(), n - 2, "{seed}");
            let rest: Positions = points.iter().map(|&p| Point3::from(p)).collect();
            for corners in triangles.corners(&rest) {
                let [x, y] = [0, 1].map(|axis| corners.iter().map(|c| c[axis]).sum::<f64>() / 3.0);
                let crossings = (0..n).filter(|&k| {
                    let ([ax, ay, _], [bx, by, _]) = (points[k], points[(k + 1) % n]);
                    (ay > y) != (by > y) && x < ax + (bx - ax) * (y - ay) / (by - ay)
                });
                assert_eq!(crossings.count() % 2, 1, "{seed}");
            }
        }
    }

    #[test]
    fn self_crossing_polygon_falls_back_to_a_fan() {
        let star = [
            [0., 1., 0.],
            [0.6, -0.8, 0.],
            [-0.95, 0.3, 0.],
            [0.95, 0.3, 0.],
            [-0.6, -0.8, 0.],
        ];
        assert_eq!(triangulate(&star).len(), 3);
    }
}
