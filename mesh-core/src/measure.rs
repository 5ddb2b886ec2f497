//! Areas, normals, corner angles, triangle quality, boxes and frames.

use nalgebra::{Matrix3, SymmetricEigen};

use crate::{Point3, Positions, Triangulation, Vector3, VertexData, VertexId};

/// Twice the area of a triangle times its unit normal: `(b − a) × (c − a)`.
#[inline]
pub fn area_vector([a, b, c]: [Point3; 3]) -> Vector3 {
    (b - a).cross(&(c - a))
}

/// Area of a triangle, in squared units of its coordinates; 0 when degenerate.
#[inline]
pub fn triangle_area(corners: [Point3; 3]) -> f64 {
    0.5 * area_vector(corners).norm()
}

/// Unit normal of a triangle by the right-hand rule; none when degenerate.
#[inline]
pub fn triangle_normal(corners: [Point3; 3]) -> Option<Vector3> {
    area_vector(corners).try_normalize(f64::MIN_POSITIVE)
}

/// Angle at `apex` between the directions to `b` and `c`, in radians: `atan2(|u × v|, u·v)`.
///
/// Degenerate input (a zero side) gives 0.
#[inline]
pub fn corner_angle(apex: Point3, b: Point3, c: Point3) -> f64 {
    let (u, v) = (b - apex, c - apex);
    u.cross(&v).norm().atan2(u.dot(&v))
}

/// Quality of a triangle: 1 when equilateral, 0 when flat.
///
/// `Q = 4√3 A / (|e₁|² + |e₂|² + |e₃|²)`
///
/// Units: none; invariant to rigid motion, uniform scale and vertex order. Degenerate input: one point gives 0.
/// Source: Mesh Draping, Eq. 4, after Liu et al. 2020. Departures: none.
#[inline]
pub fn triangle_quality([a, b, c]: [Point3; 3]) -> f64 {
    let edges = (b - a).norm_squared() + (c - b).norm_squared() + (a - c).norm_squared();
    if edges == 0.0 {
        0.0
    } else {
        4.0 * 3f64.sqrt() * triangle_area([a, b, c]) / edges
    }
}

/// Smallest height of a triangle; 0 for a degenerate one.
pub fn smallest_height(corners: [Point3; 3]) -> f64 {
    let [a, b, c] = corners;
    let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
    if longest > 0.0 {
        area_vector(corners).norm() / longest
    } else {
        0.0
    }
}

/// Mean length of the edges of the mesh at `x`; 0 without edges.
pub fn mean_edge_length(triangulation: &Triangulation, x: &Positions) -> f64 {
    let edges = triangulation.edges();
    let total: f64 = edges.iter().map(|&[a, b]| (x[a] - x[b]).norm()).sum();
    total / edges.len().max(1) as f64
}

/// Area of each triangle of `triangulation` at `x`.
pub fn triangle_areas(triangulation: &Triangulation, x: &Positions) -> Vec<f64> {
    triangulation.corners(x).map(triangle_area).collect()
}

/// Area-weighted unit normal of each vertex; zero where no face with area touches it.
pub fn vertex_normals(triangulation: &Triangulation, x: &Positions) -> VertexData<Vector3> {
    let mut normals = VertexData::new(x.len(), Vector3::zeros());
    for &t in triangulation.triangles() {
        let n = area_vector(t.map(|v| x[v]));
        for v in t {
            normals[v] += n;
        }
    }
    normals.map(|n| n.try_normalize(f64::MIN_POSITIVE).unwrap_or_default())
}

/// The entry of [`vertex_normals`] for one vertex, to the bit, at the cost of its own triangles.
pub fn vertex_normal(triangulation: &Triangulation, x: &Positions, v: VertexId) -> Vector3 {
    let triangles = triangulation.vertex_triangles(v).iter();
    let corners = triangles.map(|&t| triangulation.triangles()[t as usize].map(|v| x[v]));
    let sum = corners.fold(Vector3::zeros(), |sum, c| sum + area_vector(c));
    sum.try_normalize(f64::MIN_POSITIVE).unwrap_or_default()
}

/// Axis-aligned box. Empty when any `min` exceeds its `max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Smallest coordinates.
    pub min: Point3,
    /// Largest coordinates.
    pub max: Point3,
}

impl Aabb {
    /// The box that holds nothing.
    pub const EMPTY: Self = Self {
        min: Point3::new(f64::INFINITY, f64::INFINITY, f64::INFINITY),
        max: Point3::new(f64::NEG_INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY),
    };

    /// The smallest box around `points`.
    pub fn of<'a>(points: impl IntoIterator<Item = &'a Point3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| Self {
            min: b.min.inf(p),
            max: b.max.sup(p),
        })
    }

    /// The middle of the box.
    pub fn center(&self) -> Point3 {
        nalgebra::center(&self.min, &self.max)
    }

    /// Length of the longest side; 0 when empty.
    pub fn longest_side(&self) -> f64 {
        (self.max - self.min).max().max(0.0)
    }

    /// Length of the diagonal; 0 when empty.
    pub fn diagonal(&self) -> f64 {
        if self.longest_side() > 0.0 {
            (self.max - self.min).norm()
        } else {
            0.0
        }
    }
}

/// The frame in which a shape is centred and its longest side is 1: `p ↦ (p − center) / scale`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnitFrame {
    /// Middle of the shape's box.
    pub center: Point3,
    /// Longest side of the shape's box; 1 where the shape is a single point.
    pub scale: f64,
}

impl UnitFrame {
    /// The frame of a shape with box `bounds`.
    pub fn of(bounds: Aabb) -> Self {
        let side = bounds.longest_side();
        Self {
            center: if bounds.min.x <= bounds.max.x {
                bounds.center()
            } else {
                Point3::origin()
            },
            scale: if side > 0.0 { side } else { 1.0 },
        }
    }

    /// The frame of a shape with these points whose box stands along their principal axes: `scale` is its longest side,
    /// `center` its middle.
    ///
    /// It does not depend on how the shape is turned, as the frame of a box along x, y and z does. Only place and size
    /// change; the axes stay those of the coordinates.
    pub fn principal(points: &[Point3]) -> Self {
        let n = points.len().max(1) as f64;
        let rough = Self::of(Aabb::of(points));
        let unit = |p: &Point3| rough.to_unit(p).coords;
        let mean = points.iter().map(unit).sum::<Vector3>() / n;
        let spread = points
            .iter()
            .map(|p| (unit(p) - mean) * (unit(p) - mean).transpose())
            .sum::<Matrix3<f64>>();
        let axes = SymmetricEigen::new(spread / n).eigenvectors;
        let along: Vec<Point3> = points
            .iter()
            .map(|p| (axes.transpose() * unit(p)).into())
            .collect();
        let bounds = Aabb::of(&along);
        if bounds.longest_side() > 0.0 {
            Self {
                center: rough.from_unit(&(axes * bounds.center().coords).into()),
                scale: rough.scale * bounds.longest_side(),
            }
        } else {
            rough
        }
    }

    /// From the shape's coordinates into the unit frame.
    #[inline]
    pub fn to_unit(&self, p: &Point3) -> Point3 {
        Point3::from((p - self.center) / self.scale)
    }

    /// From the unit frame back to the shape's coordinates.
    #[inline]
    pub fn from_unit(&self, p: &Point3) -> Point3 {
        self.center + p.coords * self.scale
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heights_and_edges_of_a_right_triangle() {
        let corners = [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0]].map(Point3::from);
        assert!((smallest_height(corners) - 2.4).abs() < 1e-15);
        assert_eq!(smallest_height([Point3::origin(); 3]), 0.0);

        let soup = crate::PolygonSoup {
            positions: corners.to_vec(),
            faces: vec![vec![0, 1, 2]],
        };
        let (mesh, x) = soup.into_halfedge().unwrap();
        assert_eq!(mean_edge_length(&Triangulation::new(&mesh, &x), &x), 4.0);
    }

    #[test]
    fn a_normal_alone_is_that_among_all() {
        for soup in [crate::shapes::icosphere(2), crate::shapes::open_grid(3, 2)] {
            let (mesh, x) = soup.into_halfedge().unwrap();
            let t = Triangulation::new(&mesh, &x);
            let all = vertex_normals(&t, &x);
            assert!(x.ids().all(|v| vertex_normal(&t, &x, v) == all[v]));
        }
    }
}
