//! A point cloud seen as small discs: a surface between its points.

use std::sync::Arc;

use super::{Location, NormalSign, PointCloud, SurfacePoint, SurfaceSample, TargetSurface};
use crate::sampling::SeededRng;
use crate::{Aabb, Point3, Vector3};

/// Radius of a disc as a share of the mean distance to the neighbours: so far a cloud's points stand for its surface.
const RADIUS: f64 = 0.7;
/// Half the thickness of the band around a disc whose neighbours fill space, likewise.
const BAND: f64 = 0.5;
/// Only points farther apart than this share of the longest side are in doubt: dense clouds show their tips.
const COARSE: f64 = 0.02;

/// A cloud whose points are discs across their normals, with the area that the spacing of the points gives them.
///
/// Closest points lie between the points of the cloud, and samples are uniform by area however uneven the cloud. The
/// disc of the nearest point is asked, not every disc. Where neighbours do not lie flat, as on a thin tail of few points,
/// nobody knows where the surface runs between them: places in a band around the disc count as on it.
pub struct SurfelCloud {
    cloud: Arc<PointCloud>,
    /// Area up to and including each point.
    cumulative: Vec<f64>,
    longest_side: f64,
}

impl SurfelCloud {
    /// The discs of `cloud`.
    pub fn new(cloud: Arc<PointCloud>) -> Self {
        let mut area = 0.0;
        let cumulative = cloud
            .spacing()
            .iter()
            .map(|s| {
                area += s * s;
                area
            })
            .collect();
        Self {
            longest_side: cloud.bounds().longest_side(),
            cloud,
            cumulative,
        }
    }
}

/// A vector no longer than `most`.
fn shortened(v: Vector3, most: f64) -> Vector3 {
    let length = v.norm();
    if length > most {
        v * (most / length)
    } else {
        v
    }
}

impl TargetSurface for SurfelCloud {
    fn closest_point(&self, query: &Point3) -> SurfacePoint {
        self.closest_point_from(query, u32::MAX)
    }

    fn closest_point_from(&self, query: &Point3, hint: u32) -> SurfacePoint {
        let nearest = self.cloud.closest_point_from(query, hint);
        let Location::Point { index } = nearest.location else {
            return nearest;
        };
        let Some(normal) = self.cloud.normal(&nearest.location) else {
            return nearest;
        };
        let row = index as usize;
        let (spacing, flatness) = (self.cloud.spacing()[row], self.cloud.flatness()[row]);
        let offset = query - nearest.point;
        let along: Vector3 = offset - normal * normal.dot(&offset);
        let on_disc = nearest.point + shortened(along, RADIUS * spacing);
        let band = if spacing > COARSE * self.longest_side {
            BAND * spacing * (1.0 - flatness)
        } else {
            0.0
        };
        let point = on_disc + shortened(query - on_disc, band);
        SurfacePoint {
            point,
            distance_squared: (query - point).norm_squared(),
            location: nearest.location,
        }
    }

    fn sample(&self, n: usize, rng: &mut SeededRng) -> Vec<SurfaceSample> {
        let total = self.cumulative.last().copied().unwrap_or(0.0);
        if total <= 0.0 {
            return self.cloud.sample(n, rng);
        }
        let points = self.cloud.points();
        let mut sample = || {
            let at = rng.uniform() * total;
            let row = self.cumulative.partition_point(|&c| c <= at);
            let index = row.min(points.len() - 1) as u32;
            SurfaceSample {
                point: points[index as usize],
                location: Location::Point { index },
            }
        };
        (0..n).map(|_| sample()).collect()
    }

    fn vertices(&self) -> Vec<Point3> {
        self.cloud.vertices()
    }

    fn normal(&self, location: &Location) -> Option<Vector3> {
        self.cloud.normal(location)
    }

    fn normal_sign(&self) -> NormalSign {
        self.cloud.normal_sign()
    }

    fn is_on_boundary(&self, location: &Location) -> bool {
        self.cloud.is_on_boundary(location)
    }

    fn bounds(&self) -> Aabb {
        self.cloud.bounds()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;

    fn ball() -> SurfelCloud {
        let points = shapes::icosphere(4).positions;
        SurfelCloud::new(Arc::new(PointCloud::new(points, None).unwrap()))
    }

    #[test]
    fn closest_points_lie_between_the_points_of_a_cloud() {
        // A disc of radius r leaves the unit sphere by r²/2: with a spacing of 0.1, by less than 0.005.
        let ball = ball();
        for query in [[0.3, 1.7, -0.4], [0.1, -0.2, 0.9], [2.0, 2.1, 2.2]].map(Point3::from) {
            let hit = ball.closest_point(&query);
            let distance = hit.distance_squared.sqrt();
            assert!((distance - (query.coords.norm() - 1.0).abs()).abs() < 5e-3);
            assert!((hit.point - query).norm_squared() == hit.distance_squared);
        }
    }

    #[test]
    fn samples_are_even_where_the_cloud_is_not() {
        let grid = |n: u32, x0: f64| {
            let at = move |k: u32| f64::from(k) / f64::from(n);
            (0..n).flat_map(move |i| (0..n).map(move |j| Point3::new(x0 + at(i), at(j), 0.0)))
        };
        let points: Vec<Point3> = grid(60, 0.0).chain(grid(20, 1.0)).collect();
        let cloud = SurfelCloud::new(Arc::new(PointCloud::new(points, None).unwrap()));
        let samples = cloud.sample(4000, &mut SeededRng::new(1));
        let dense = samples.iter().filter(|s| s.point.x < 1.0).count();
        // Half of the area; by point it would be nine tenths. 0.5 ± 6 σ, and rims count a little more.
        assert!((1700..2300).contains(&dense), "{dense}");
    }
}
