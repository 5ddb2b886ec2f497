//! What is broken in a draped mesh: folds, skinny triangles, bent corners, faces turned inside out.

use mesh_core::measure::{corner_angle, triangle_normal, triangle_quality};
use mesh_core::{
    NormalSign, Point3, Positions, TargetSurface, Triangulation, TriangulationEdge, Vector3,
};

/// A triangle with `Q_f` below this is skinny (Mesh Draping, Eq. 4).
pub const SKINNY_QUALITY: f64 = 0.1;

/// An edge is folded when the normals of its two triangles have a dot product below this.
pub const FOLD_COSINE: f64 = -0.5;

/// The edges whose triangles turn against each other where they did not at rest.
///
/// `n₁·n₂ < −0.5` draped and `n₁·n₂ ≥ −0.5` at rest, over the edges that exactly two triangles share.
///
/// Degenerate input: a triangle without area has no normal and folds no edge.
pub fn folded_edges(
    triangulation: &Triangulation,
    rest: &Positions,
    draped: &Positions,
) -> Vec<TriangulationEdge> {
    let [before, after] = [rest, draped].map(|x| normals(triangulation, x));
    let cosine = |n: &[Vector3], [s, t]: [usize; 2]| n[s].dot(&n[t]);
    let is_folded = |e: &TriangulationEdge| {
        cosine(&after, e.triangles) < FOLD_COSINE && cosine(&before, e.triangles) >= FOLD_COSINE
    };
    triangulation.interior_edges().filter(is_folded).collect()
}

/// Quality `Q_f` of every triangle (Eq. 4).
pub fn triangle_qualities(triangulation: &Triangulation, x: &Positions) -> Vec<f64> {
    triangulation.corners(x).map(triangle_quality).collect()
}

/// The triangles with `Q_f < 0.1` at `x`, by row.
pub fn skinny_triangles(triangulation: &Triangulation, x: &Positions) -> Vec<usize> {
    let qualities = triangulation.corners(x).map(triangle_quality).enumerate();
    qualities
        .filter(|&(_, quality)| quality < SKINNY_QUALITY)
        .map(|(t, _)| t)
        .collect()
}

/// Mean absolute difference between the corner angles at rest and draped, in degrees, over all triangles.
///
/// Degenerate input: 0 where there is no triangle; a corner at a zero side counts as 0°.
pub fn mean_angle_deviation(
    triangulation: &Triangulation,
    rest: &Positions,
    draped: &Positions,
) -> f64 {
    let pairs = triangulation
        .corners(rest)
        .zip(triangulation.corners(draped));
    let sum: f64 = pairs
        .flat_map(|(from, to)| (0..3).map(move |k| (angle(to, k) - angle(from, k)).abs()))
        .sum();
    sum.to_degrees() / (3 * triangulation.len()).max(1) as f64
}

/// The triangles whose normal opposes the target's at the point closest to their centroid, by row.
///
/// None for a target whose normals mean nothing, or not their sign.
pub fn opposed_triangles(
    triangulation: &Triangulation,
    x: &Positions,
    target: &dyn TargetSurface,
) -> Option<Vec<usize>> {
    let centroids: Vec<Point3> = triangulation.corners(x).map(centroid).collect();
    let closest = target.closest_points(&centroids);
    let target_normals: Vec<_> = closest.iter().map(|c| target.normal(&c.location)).collect();
    let is_known =
        target.normal_sign() == NormalSign::Oriented && target_normals.iter().any(Option::is_some);
    is_known.then(|| {
        let ours = normals(triangulation, x);
        let is_opposed = |t: &usize| target_normals[*t].is_some_and(|n| n.dot(&ours[*t]) < 0.0);
        (0..ours.len()).filter(is_opposed).collect()
    })
}

/// Unit normal of each triangle; zero where it has no area.
fn normals(triangulation: &Triangulation, x: &Positions) -> Vec<Vector3> {
    triangulation
        .corners(x)
        .map(|corners| triangle_normal(corners).unwrap_or_default())
        .collect()
}

fn angle(corners: [Point3; 3], k: usize) -> f64 {
    corner_angle(corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3])
}

fn centroid([a, b, c]: [Point3; 3]) -> Point3 {
    Point3::from((a.coords + b.coords + c.coords) / 3.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh_core::{shapes, VertexId};

    #[test]
    fn rest_has_no_fold_and_no_deviation() {
        for soup in [
            shapes::icosphere(1),
            shapes::quad_sphere(3),
            shapes::open_grid(3, 3),
            shapes::cone(8),
        ] {
            let (mesh, rest) = soup.into_halfedge().unwrap();
            let triangles = Triangulation::new(&mesh, &rest);
            assert!(folded_edges(&triangles, &rest, &rest).is_empty());
            assert_eq!(mean_angle_deviation(&triangles, &rest, &rest), 0.0);
        }
    }

    #[test]
    fn a_corner_turned_over_folds_one_edge() {
        // A single quad: its far corner is brought over the diagonal, into the other triangle.
        let (mesh, rest) = shapes::open_grid(1, 1).into_halfedge().unwrap();
        let triangles = Triangulation::new(&mesh, &rest);
        let edge = triangles.interior_edges().next();
        let edge = edge.expect("a quad has a diagonal");
        let off_diagonal = mesh
            .vertices()
            .find(|v| !edge.vertices.contains(v))
            .unwrap();
        let centre = Point3::new(0.5, 0.5, 0.0);
        let mut draped = rest.clone();
        draped[off_diagonal] = centre - (rest[off_diagonal] - centre) * 0.5;
        assert_eq!(folded_edges(&triangles, &rest, &draped), [edge]);
        assert_eq!(folded_edges(&triangles, &draped, &draped), []);
    }

    #[test]
    fn skinny_triangles_are_named() {
        let (mesh, rest) = shapes::open_grid(2, 1).into_halfedge().unwrap();
        let triangles = Triangulation::new(&mesh, &rest);
        assert!(skinny_triangles(&triangles, &rest).is_empty());
        let squeezed = rest.map(|p| Point3::new(p.x * 0.01, p.y, p.z));
        assert_eq!(skinny_triangles(&triangles, &squeezed), [0, 1, 2, 3]);
    }

    #[test]
    fn quality_of_right_isosceles_is_half_root_three() {
        let (mesh, rest) = shapes::open_grid(1, 1).into_halfedge().unwrap();
        let triangles = Triangulation::new(&mesh, &rest);
        for quality in triangle_qualities(&triangles, &rest) {
            assert!((quality - 3f64.sqrt() / 2.0).abs() < 1e-15);
        }
    }

    #[test]
    fn angle_deviation_of_a_sheared_triangle() {
        // (0,0) (1,0) (0,1) to (0,0) (1,0) (1,1): angles 90, 45, 45 to 45, 90, 45.
        let soup = mesh_core::PolygonSoup {
            positions: [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]]
                .map(Point3::from)
                .to_vec(),
            faces: vec![vec![0, 1, 2]],
        };
        let (mesh, rest) = soup.into_halfedge().unwrap();
        let mut draped = rest.clone();
        draped[VertexId::new(2)] = Point3::new(1.0, 1.0, 0.0);
        let deviation = mean_angle_deviation(&Triangulation::new(&mesh, &rest), &rest, &draped);
        assert!((deviation - 30.0).abs() < 1e-12);
    }
}
