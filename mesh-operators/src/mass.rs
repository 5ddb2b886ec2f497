//! The share of the surface's area that each vertex stands for.

use mesh_core::measure::triangle_area;
use mesh_core::{Point3, Positions, Triangulation, VertexData};

/// Mixed Voronoi area of each vertex.
///
/// The part of each triangle that is nearest to the vertex: `⅛ (|e_b|² cot β + |e_c|² cot γ)`; in an obtuse triangle
/// half of it for the obtuse corner and a quarter for the others.
///
/// One entry per vertex of `x`, in squared units, each ≥ 0; they sum to the area of the surface. 0 where no triangle
/// with area touches the vertex. Source: Meyer, Desbrun, Schröder and Barr 2003, Fig. 4. Departures: none.
pub fn voronoi_mass(triangulation: &Triangulation, x: &Positions) -> VertexData<f64> {
    distribute(triangulation, x, voronoi_parts)
}

/// A third of the area of every triangle that touches the vertex.
///
/// One entry per vertex of `x`, in squared units, each ≥ 0; they sum to the area of the surface.
pub fn barycentric_mass(triangulation: &Triangulation, x: &Positions) -> VertexData<f64> {
    distribute(triangulation, x, |corners| {
        [triangle_area(corners) / 3.0; 3]
    })
}

fn distribute(
    triangulation: &Triangulation,
    x: &Positions,
    parts: impl Fn([Point3; 3]) -> [f64; 3],
) -> VertexData<f64> {
    let mut mass = VertexData::new(x.len(), 0.0);
    for &triangle in triangulation.triangles() {
        for (v, part) in triangle.into_iter().zip(parts(triangle.map(|v| x[v]))) {
            mass[v] += part;
        }
    }
    mass
}

fn voronoi_parts(corners: [Point3; 3]) -> [f64; 3] {
    let area = triangle_area(corners);
    if area == 0.0 {
        return [0.0; 3];
    }
    // The side opposite to corner k, running around the triangle, and u·v at corner k.
    let side = [0, 1, 2].map(|k: usize| corners[(k + 2) % 3] - corners[(k + 1) % 3]);
    let dot = [0, 1, 2].map(|k: usize| -side[(k + 1) % 3].dot(&side[(k + 2) % 3]));
    if let Some(obtuse) = dot.iter().position(|&d| d < 0.0) {
        return [0, 1, 2].map(|k| if k == obtuse { area / 2.0 } else { area / 4.0 });
    }
    // cot at corner k = u·v / |u × v| = dot / (2 area)
    let opposite = [0, 1, 2].map(|k| side[k].norm_squared() * dot[k] / (2.0 * area));
    [0, 1, 2].map(|k: usize| (opposite[(k + 1) % 3] + opposite[(k + 2) % 3]) / 8.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn right_triangle_splits_into_a_half_and_quarters() {
        let parts = voronoi_parts([[0., 0., 0.], [2., 0., 0.], [0., 2., 0.]].map(Point3::from));
        for (got, expected) in parts.into_iter().zip([1.0, 0.5, 0.5]) {
            assert!((got - expected).abs() < 1e-15);
        }
    }

    /// The circumcentre lies outside: the obtuse corner keeps half of the area 1, wherever it stands in the triangle.
    #[test]
    fn obtuse_triangle_gives_half_to_its_obtuse_corner() {
        let corners = [[0., 0., 0.], [4., 0., 0.], [1.5, 0.5, 0.]].map(Point3::from);
        for obtuse in 0..3 {
            let turned = [0, 1, 2].map(|k: usize| corners[(k + 2 + 3 - obtuse) % 3]);
            let mut expected = [0.25; 3];
            expected[obtuse] = 0.5;
            for (got, expected) in voronoi_parts(turned).into_iter().zip(expected) {
                assert!((got - expected).abs() < 1e-15, "{got} {expected}");
            }
        }
    }

    /// Against the area of the Voronoi cells themselves: between the midpoints of the sides and the circumcentre.
    #[test]
    fn acute_triangle_splits_at_its_circumcentre() {
        // Circumcentre (2, 1): at equal distance √5 from all corners.
        let corners = [[0., 0., 0.], [4., 0., 0.], [1., 3., 0.]].map(Point3::from);
        let centre = Point3::new(2.0, 1.0, 0.0);
        let cell = |k: usize| {
            let (a, b, c) = (corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]);
            let halves = [nalgebra::center(&a, &b), nalgebra::center(&a, &c)];
            halves
                .map(|m| triangle_area([a, m, centre]))
                .iter()
                .sum::<f64>()
        };
        for (k, part) in voronoi_parts(corners).into_iter().enumerate() {
            assert!((part - cell(k)).abs() < 1e-14, "{part} {}", cell(k));
        }
    }

    #[test]
    fn equilateral_triangle_splits_evenly() {
        let parts = voronoi_parts(
            [[0., 0., 0.], [1., 0., 0.], [0.5, 0.75f64.sqrt(), 0.]].map(Point3::from),
        );
        for part in parts {
            assert!((part - 3f64.sqrt() / 12.0).abs() < 1e-15);
        }
    }
}
