//! Places that a person means who points near them: the nearest vertex, or the most curved one.

use mesh_core::{Point3, Vector3};

/// How far around a place the most curved vertex is looked for, and how far around each its curvature is measured, in longest
/// sides of the shape's box: the corner of an eye, not its lid.
pub const SNAP_REACH: f64 = 0.03;

/// The vertices of a shape, each with its normal and the area that it stands for.
#[derive(Clone, Debug)]
pub struct SnapPoints {
    points: Vec<Point3>,
    normals: Vec<Vector3>,
    areas: Vec<f64>,
}

impl SnapPoints {
    /// Those of a surface. Each face gives its corners equal shares of its area; vertices without any are never snapped to.
    pub fn of_faces<F: AsRef<[u32]>>(
        points: Vec<Point3>,
        faces: impl IntoIterator<Item = F>,
    ) -> Self {
        let mut normals = vec![Vector3::zeros(); points.len()];
        let mut areas = vec![0.0; points.len()];
        for face in faces {
            let corners = face.as_ref();
            let at = |k: usize| points[corners[k] as usize];
            let fan = (2..corners.len()).map(|k| (at(k - 1) - at(0)).cross(&(at(k) - at(0))) / 2.0);
            let area: Vector3 = fan.sum();
            for &v in corners {
                normals[v as usize] += area;
                areas[v as usize] += area.norm() / corners.len() as f64;
            }
        }
        Self {
            normals: normals.into_iter().map(unit).collect(),
            points,
            areas,
        }
    }

    /// Those of a cloud: every point counts alike. One normal per point.
    pub fn of_cloud(points: Vec<Point3>, normals: Vec<Vector3>) -> Self {
        Self {
            areas: vec![1.0; points.len()],
            points,
            normals,
        }
    }

    /// A vertex.
    pub fn point(&self, row: usize) -> Option<Point3> {
        self.points.get(row).copied()
    }

    /// The vertex nearest to a place, the lowest row among equals; none where there is no surface.
    pub fn nearest(&self, place: &Point3) -> Option<usize> {
        let far = |&row: &usize| (self.points[row] - place).norm_squared();
        self.rows().min_by(|a, b| far(a).total_cmp(&far(b)))
    }

    /// The most curved vertex nearer to a place than `radius`, the lowest row among equals; the nearest one where none is so
    /// near. Curvature is by how far a vertex stands out of, or lies below, the middle of the surface within `radius` of it:
    ///
    /// `h = |n · (v − c)|`, `c = Σ aⱼ pⱼ / Σ aⱼ` over `|pⱼ − v| < r`
    ///
    /// with normal n and areas a: 0 where the surface is flat, and at its open ends. As it takes the mean of many, the noise of
    /// a scan hardly matters. Source: Pottmann et al. 2009, integral invariants, with a mean for the volume.
    pub fn most_curved(&self, place: &Point3, radius: f64) -> Option<usize> {
        let within = |row: &usize, reach: f64| (self.points[*row] - place).norm() < reach;
        let around: Vec<usize> = self
            .rows()
            .filter(|row| within(row, 2.0 * radius))
            .collect();
        let near = around.iter().copied().filter(|row| within(row, radius));
        let curved = near.map(|row| (row, self.curvature(row, &around, radius)));
        let most = curved.max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)));
        most.map(|(row, _)| row).or_else(|| self.nearest(place))
    }

    fn curvature(&self, row: usize, around: &[usize], radius: f64) -> f64 {
        let at = self.points[row];
        let near = around.iter().copied();
        let near = near.filter(|&j| (self.points[j] - at).norm() < radius);
        let (mut sum, mut area) = (Vector3::zeros(), 0.0);
        for j in near {
            sum += (self.points[j] - at) * self.areas[j];
            area += self.areas[j];
        }
        (self.normals[row].dot(&sum) / area).abs()
    }

    /// The vertices that are part of the surface.
    fn rows(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.points.len()).filter(|&row| self.areas[row] > 0.0)
    }
}

fn unit(n: Vector3) -> Vector3 {
    n.try_normalize(f64::MIN_POSITIVE).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh_core::shapes;

    /// A grid with one bump and a little noise.
    fn bumpy() -> SnapPoints {
        let mut soup = shapes::open_grid(40, 40);
        for (k, p) in soup.positions.iter_mut().enumerate() {
            let away = (*p - Point3::new(12.0, 25.0, 0.0)).norm_squared();
            p.z = 3.0 * (-away / 6.0).exp() + 0.05 * (1.7 * k as f64).sin();
        }
        SnapPoints::of_faces(soup.positions, soup.faces)
    }

    #[test]
    fn the_top_of_a_bump_is_found_from_beside_it() {
        let points = bumpy();
        for place in [[14.0, 24.0, 1.0], [11.0, 27.5, 0.5], [12.0, 25.0, 3.0]] {
            let row = points.most_curved(&Point3::from(place), 4.0);
            let at = points.point(row.unwrap()).unwrap();
            assert!(
                (at.xy() - nalgebra::Point2::new(12.0, 25.0)).norm() < 1.5,
                "{at}"
            );
        }
    }

    #[test]
    fn open_ends_are_not_curved() {
        let points = bumpy();
        let row = points
            .most_curved(&Point3::new(1.5, 1.5, 0.0), 3.0)
            .unwrap();
        let around: Vec<usize> = points.rows().collect();
        assert!(points.curvature(row, &around, 3.0) < 0.1);
    }

    #[test]
    fn the_nearest_vertex_is_one_of_the_surface() {
        let mut soup = shapes::open_grid(3, 3);
        soup.positions.push(Point3::new(1.2, 1.2, 0.0));
        let points = SnapPoints::of_faces(soup.positions, soup.faces);
        let place = Point3::new(1.2, 1.1, 0.0);
        let at = points.point(points.nearest(&place).unwrap()).unwrap();
        assert_eq!(at, Point3::new(1.0, 1.0, 0.0));
        // Where nothing is within reach, likewise.
        assert_eq!(points.most_curved(&place, 1e-6), points.nearest(&place));
        let cloud = SnapPoints::of_cloud(Vec::new(), Vec::new());
        assert_eq!(cloud.nearest(&place), None);
        assert_eq!(cloud.most_curved(&place, 1.0), None);
    }
}
