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

fn fan(polygon: &[VertexId]) -> impl Iterator<Item = [VertexId; 3]> + '_ {
    polygon[1..]
        .windows(2)
        .map(|side| [polygon[0], side[0], side[1]])
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

    let mut delaunay = ConstrainedDelaunayTriangulation::<spade::Point2<f64>>::new();
    let mut row_of = Vec::new();
    for (row, &[s, t]) in flat.iter().enumerate() {
        let handle = delaunay.insert(spade::Point2::new(s, t)).ok()?;
        if handle.index() != row {
            return None;
        }
        row_of.push(handle);
    }
    for k in 0..row_of.len() {
        let (from, to) = (row_of[k], row_of[(k + 1) % row_of.len()]);
        if !delaunay.can_add_constraint(from, to) && !delaunay.exists_constraint(from, to) {
            return None;
        }
        delaunay.add_constraint(from, to);
    }
    let mut rows: Vec<[usize; 3]> = delaunay
        .inner_faces()
        .map(|face| face.vertices().map(|vertex| vertex.index()))
        .filter(|t| is_inside(centroid(t.map(|row| flat[row])), &flat))
        .map(lowest_first)
        .collect();
    rows.sort_unstable();
    Some(
        rows.into_iter()
            .map(|t| t.map(|row| polygon[row]))
            .collect(),
    )
}

fn centroid(corners: [[f64; 2]; 3]) -> [f64; 2] {
    [0, 1].map(|axis| corners.iter().map(|c| c[axis]).sum::<f64>() / 3.0)
}

/// Even–odd rule.
fn is_inside([x, y]: [f64; 2], polygon: &[[f64; 2]]) -> bool {
    let n = polygon.len();
    let crossings = (0..n).filter(|&k| {
        let ([ax, ay], [bx, by]) = (polygon[k], polygon[(k + 1) % n]);
        (ay > y) != (by > y) && x < ax + (bx - ax) * (y - ay) / (by - ay)
    });
    crossings.count() % 2 == 1
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
