//! How much a map stretches: the discrete Dirichlet energy (Eq. 6).

use mesh_core::{FaceData, Point3, Positions, Triangulation};
use nalgebra::Matrix2;

use crate::normalize::total_area;

/// A rest triangle with less than this share of the total area is left out: its map has no finite size.
const LEAST_AREA_SHARE: f64 = 1e-14;

/// Dirichlet energy of the map from rest to draped, per unit of rest area.
///
/// `½ Σ_f ‖dφ_f‖²_F a_f / Σ_f a_f`, with `dφ_f` the 2×2 linear map of triangle `f` and `a_f` its area at rest.
///
/// Units: none. 1 for an isometry, s² for a uniform scale s. Degenerate input: rest triangles without area are left
/// out; 0 if that leaves none.
/// Source: Mesh Draping, Eq. 6. Departures: the paper's `− 1` is taken in [`crate::q_transfer`]; the areas `a_f` are
/// divided by their sum, without which the identity would not come out at 1.
pub fn dirichlet_energy(
    triangulation: &Triangulation,
    rest: &Positions,
    draped: &Positions,
) -> f64 {
    let area = total_area(triangulation, rest);
    if area == 0.0 {
        return 0.0;
    }
    let energies = stretched_triangles(triangulation, rest, draped);
    energies.map(|t| t.stretch * t.area).sum::<f64>() / area
}

/// Dirichlet energy `D` with rest and draped surface each scaled to unit area: 1 for a similarity, more otherwise.
///
/// `D = ½ Σ_f ‖dφ_f‖²_F a_f / Σ_f â_f`, with `a_f`, `â_f` the areas at rest and draped.
///
/// Units: none; invariant to rigid motion and uniform scale of either shape. Degenerate input: ∞ where a surface has
/// no area.
/// Source: the column "Dirichlet" of Mesh Draping, Table 1. Departures: the paper does not say how the two sizes are
/// made equal; without it a shrunken result scores below 1.
pub fn dirichlet_unit_area(
    triangulation: &Triangulation,
    rest: &Positions,
    draped: &Positions,
) -> f64 {
    let [area, draped_area] = [rest, draped].map(|x| total_area(triangulation, x));
    if area == 0.0 || draped_area == 0.0 {
        return f64::INFINITY;
    }
    dirichlet_energy(triangulation, rest, draped) * area / draped_area
}

/// Stretch `½ ‖dφ_f‖²_F` of each face, with rest and draped surface each scaled to unit area.
///
/// 1 where the face keeps its shape and its share of the area. A polygon is the area-weighted mean of its triangles.
/// Degenerate input: a face without area at rest gives 1; all faces do where the draped surface has no area.
pub fn face_stretch(
    triangulation: &Triangulation,
    rest: &Positions,
    draped: &Positions,
) -> FaceData<f64> {
    let [area, draped_area] = [rest, draped].map(|x| total_area(triangulation, x));
    let mut sums = FaceData::new(triangulation.n_faces(), (0.0, 0.0));
    for t in stretched_triangles(triangulation, rest, draped) {
        let (energy, weight) = &mut sums[triangulation.parent(t.row)];
        *energy += t.stretch * t.area;
        *weight += t.area;
    }
    sums.map(|&(energy, weight)| {
        if weight > 0.0 && draped_area > 0.0 {
            energy / weight * area / draped_area
        } else {
            1.0
        }
    })
}

struct StretchedTriangle {
    row: usize,
    area: f64,
    stretch: f64,
}

/// The triangles with area at rest, each with `½ ‖dφ‖²_F`.
fn stretched_triangles<'a>(
    triangulation: &'a Triangulation,
    rest: &'a Positions,
    draped: &'a Positions,
) -> impl Iterator<Item = StretchedTriangle> + 'a {
    let least_area = LEAST_AREA_SHARE * total_area(triangulation, rest);
    let pairs = triangulation
        .corners(rest)
        .zip(triangulation.corners(draped));
    pairs.enumerate().filter_map(move |(row, (from, to))| {
        let e = edge_matrix(from);
        let area = 0.5 * e.determinant();
        let d_phi = edge_matrix(to) * e.try_inverse()?;
        (area > least_area).then(|| StretchedTriangle {
            row,
            area,
            stretch: 0.5 * d_phi.norm_squared(),
        })
    })
}

/// The edges `b − a` and `c − a` as columns, in an orthonormal frame of the triangle's plane.
fn edge_matrix([a, b, c]: [Point3; 3]) -> Matrix2<f64> {
    let (u, v) = (b - a, c - a);
    let x = u.try_normalize(f64::MIN_POSITIVE).unwrap_or_default();
    let along = v.dot(&x);
    Matrix2::new(u.norm(), along, 0.0, (v - x * along).norm())
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh_core::{shapes, PolygonSoup, Vector3};

    fn shapes_of_every_sort() -> Vec<PolygonSoup> {
        vec![
            shapes::icosphere(1),
            shapes::quad_sphere(3),
            shapes::open_grid(3, 2),
            shapes::cone(7),
            shapes::prism(5),
        ]
    }

    fn each(check: impl Fn(&Triangulation, &Positions)) {
        for soup in shapes_of_every_sort() {
            let (mesh, rest) = soup.into_halfedge().unwrap();
            check(&Triangulation::new(&mesh, &rest), &rest);
        }
    }

    #[test]
    fn identity_is_one_everywhere() {
        each(|triangles, rest| {
            assert!((dirichlet_energy(triangles, rest, rest) - 1.0).abs() < 1e-12);
            assert!((dirichlet_unit_area(triangles, rest, rest) - 1.0).abs() < 1e-12);
            let stretch = face_stretch(triangles, rest, rest);
            assert!(stretch.iter().all(|s| (s - 1.0).abs() < 1e-12));
        });
    }

    #[test]
    fn uniform_scale_gives_its_square_and_no_distortion() {
        each(|triangles, rest| {
            let grown = rest.map(|p| p * 3.0 + Vector3::new(1.0, 2.0, 3.0));
            assert!((dirichlet_energy(triangles, rest, &grown) - 9.0).abs() < 1e-11);
            assert!((dirichlet_unit_area(triangles, rest, &grown) - 1.0).abs() < 1e-12);
        });
    }

    #[test]
    fn stretch_along_one_axis_has_its_closed_form() {
        // A sheet stretched by k along x: ½ (k² + 1) in energy, k in area.
        let (mesh, rest) = shapes::open_grid(4, 3).into_halfedge().unwrap();
        let triangles = Triangulation::new(&mesh, &rest);
        let k = 2.5;
        let draped = rest.map(|p| Point3::new(k * p.x, p.y, p.z));
        let energy = 0.5 * (k * k + 1.0);
        assert!((dirichlet_energy(&triangles, &rest, &draped) - energy).abs() < 1e-12);
        assert!((dirichlet_unit_area(&triangles, &rest, &draped) - energy / k).abs() < 1e-12);
    }

    #[test]
    fn collapsed_shape_is_infinitely_distorted() {
        each(|triangles, rest| {
            let point = rest.map(|_| Point3::origin());
            assert_eq!(dirichlet_unit_area(triangles, rest, &point), f64::INFINITY);
            assert_eq!(dirichlet_unit_area(triangles, &point, rest), f64::INFINITY);
            assert!(face_stretch(triangles, rest, &point)
                .iter()
                .all(|&s| s == 1.0));
        });
    }

    #[test]
    fn flat_rest_triangle_does_not_count() {
        let soup = PolygonSoup {
            positions: [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [2., 0., 0.]]
                .map(Point3::from)
                .to_vec(),
            faces: vec![vec![0, 1, 2], vec![0, 3, 1]],
        };
        let (mesh, rest) = soup.into_halfedge().unwrap();
        let triangles = Triangulation::new(&mesh, &rest);
        assert_eq!(dirichlet_energy(&triangles, &rest, &rest), 1.0);
    }
}
