//! A result that is as symmetric as its source.

use mesh_core::{MeshPoint, Point3, Positions, Vector3};
use nalgebra::{Matrix3, SymmetricEigen};

use crate::landmarks::{symmetry_plane, MirrorError, Plane};
use crate::Source;

/// Which place of a symmetric source lies opposite each vertex.
pub(crate) struct Opposites(Vec<MeshPoint>);

impl Opposites {
    /// The places of the surface at rest nearest to the mirror images of the vertices.
    ///
    /// # Errors
    /// A source that is not symmetric across the middle of its box.
    pub(crate) fn of(source: &Source) -> Result<Self, MirrorError> {
        let plane = symmetry_plane(source)?;
        let images: Vec<Point3> = source.rest().iter().map(|p| plane.mirror(p)).collect();
        let hits = source.bvh().closest_points(&images);
        // What a hierarchy of triangles finds lies on one of them.
        let places = hits.iter().filter_map(|hit| source.place(hit.location));
        Ok(Self(places.collect()))
    }

    /// The mean of a shape and of its mirror image, vertex by vertex: `x' = (x + mirror(o)) / 2` with the place o opposite x,
    /// across the plane that lies most nearly in the middle between all x and o.
    ///
    /// A shape without two sides, whose places lie on their opposites, stays as it is.
    pub(crate) fn symmetrised(&self, shape: &Positions) -> Positions {
        let opposite: Vec<Point3> = self.0.iter().map(|place| place.position(shape)).collect();
        let Some(plane) = between(shape, &opposite) else {
            return shape.clone();
        };
        let pairs = shape.iter().zip(&opposite);
        pairs
            .map(|(x, o)| nalgebra::center(x, &plane.mirror(o)))
            .collect()
    }
}

/// The plane whose normal is the main direction from opposite to opposite (the largest eigenvector of `Σ d dᵀ`), through the
/// mean of their middles; none where there is no direction.
fn between(shape: &Positions, opposite: &[Point3]) -> Option<Plane> {
    let mut spread = Matrix3::zeros();
    let mut middle = Vector3::zeros();
    for (x, o) in shape.iter().zip(opposite) {
        let across = x - o;
        spread += across * across.transpose();
        middle += nalgebra::center(x, o).coords / shape.len() as f64;
    }
    let eigen = SymmetricEigen::new(spread);
    let normal = eigen
        .eigenvectors
        .column(eigen.eigenvalues.imax())
        .into_owned();
    (eigen.eigenvalues.max() > 0.0).then(|| Plane {
        normal,
        point: middle.into(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Seams;
    use mesh_core::shapes;
    use nalgebra::Rotation3;

    fn egg() -> Source {
        let mut soup = shapes::quad_sphere(4);
        for p in &mut soup.positions {
            *p = Point3::new(p.x, 2.0 * p.y + 0.3 * p.z, 1.5 * p.z);
        }
        Source::of_soup(soup, Seams::EXACT).unwrap()
    }

    #[test]
    fn a_symmetric_shape_stays_wherever_it_stands() {
        let (source, turn) = (egg(), Rotation3::from_euler_angles(0.3, -0.7, 1.1));
        let shape = source
            .rest()
            .map(|p| turn * p + Vector3::new(5.0, -2.0, 1.0));
        let same = Opposites::of(&source).unwrap().symmetrised(&shape);
        for (a, b) in shape.iter().zip(&same) {
            assert!((a - b).norm() < 1e-9);
        }
    }

    #[test]
    fn a_dent_of_one_side_is_shared_by_both() {
        let source = egg();
        let opposites = Opposites::of(&source).unwrap();
        let dented = source
            .rest()
            .map(|p| Point3::new(if p.x > 0.0 { 0.8 * p.x } else { p.x }, p.y, p.z));
        let shape = opposites.symmetrised(&dented);
        let again = opposites.symmetrised(&shape);
        for (a, b) in shape.iter().zip(&again) {
            assert!((a - b).norm() < 1e-9);
        }
        let widths = [-1.0, 1.0].map(|side| shape.iter().map(|p| side * p.x).fold(0.0, f64::max));
        assert!((widths[0] + widths[1] - 1.8).abs() < 1e-6, "{widths:?}");
    }

    #[test]
    fn what_is_not_symmetric_is_refused() {
        let mut soup = shapes::quad_sphere(4);
        for p in &mut soup.positions {
            let bump: f64 = (-2.0 * (*p - Point3::new(0.6, 0.6, 0.5)).norm_squared()).exp();
            *p += p.coords * 1.5 * bump;
        }
        let source = Source::of_soup(soup, Seams::EXACT).unwrap();
        assert!(Opposites::of(&source).is_err());
    }
}
