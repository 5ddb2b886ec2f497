//! Which places of two shapes have a counterpart on the other, and distances over these alone.

use mesh_core::sampling::{SeededRng, TriangleSampler};
use mesh_core::{
    Location, Point3, Positions, SurfacePoint, TargetSurface, TriangleBvh, Triangulation, Vector3,
    VertexData, VertexId,
};

use crate::config::EvaluationConfig;
use crate::distances::{DirectedDistances, SurfaceDistances, TargetKind};
use crate::normalize::common_frame;

/// Which places of a draped mesh and of its target have a counterpart on the other.
#[derive(Clone, Debug, PartialEq)]
pub struct Counterparts {
    /// The vertices that were drawn to the target.
    pub of_vertices: VertexData<bool>,
    /// Whether the mesh goes on where the target ends: its places whose closest point lies on the target's open
    /// boundary then have no counterpart.
    pub target_ends: bool,
    /// Whether the target goes on where the mesh ends: likewise.
    pub mesh_ends: bool,
}

/// Distances over what has a counterpart, and how much has none.
#[derive(Clone, Debug, PartialEq)]
pub struct CountedDistances {
    /// Distances both ways.
    pub distances: SurfaceDistances,
    /// The share of the mesh's random places that were left out, 0..=1.
    pub mesh_left_out: f64,
    /// The share of the target's places that were left out, 0..=1.
    pub target_left_out: f64,
    /// The largest distance over everything, left out or not: [`crate::hausdorff_sampled`] of all.
    pub hausdorff_of_all: f64,
}

/// A place with its distance, and whether it has a counterpart.
type Measured = (f64, bool);

impl Counterparts {
    /// Everything has one.
    pub fn all(n_vertices: usize) -> Self {
        Self {
            of_vertices: VertexData::new(n_vertices, true),
            target_ends: false,
            mesh_ends: false,
        }
    }

    /// Whether a vertex with this closest point of the target has a counterpart.
    pub fn has_vertex(&self, v: VertexId, hit: &SurfacePoint, target: &dyn TargetSurface) -> bool {
        self.of_vertices[v] && !(self.target_ends && target.is_on_boundary(&hit.location))
    }

    /// Distances from every place that has a counterpart: those of [`SurfaceDistances::measure`], without the others.
    ///
    /// A triangle none of whose corners was drawn to the target has none, nor has a place of the target that is closest
    /// to such a one.
    /// Degenerate input: no distance at all where nothing has a counterpart.
    pub fn distances(
        &self,
        triangulation: &Triangulation,
        draped: &Positions,
        target: &dyn TargetSurface,
        config: &EvaluationConfig,
    ) -> CountedDistances {
        let mut rng = SeededRng::new(config.seed);
        let case = Case {
            counterparts: self,
            triangulation,
            draped,
            target,
            bvh: TriangleBvh::new(triangulation.corners(draped).collect()),
            unit: 1.0 / common_frame(target).scale,
        };
        let mesh_samples = case.to_target_of_samples(config.n_samples, &mut rng);
        let (points, corners) = match TargetKind::of(target) {
            TargetKind::Surface => {
                let samples = target.sample(config.n_samples, &mut rng);
                let points = samples.iter().map(|s| s.point).collect();
                (points, target.vertices())
            }
            TargetKind::Cloud => (target.vertices(), Vec::new()),
        };
        let target_samples = case.to_draped(&points);
        let mesh_vertices = case.to_target_of_vertices();
        let target_vertices = case.to_draped(&corners);
        let all = [
            &mesh_samples,
            &mesh_vertices,
            &target_samples,
            &target_vertices,
        ];
        let lengths = all.into_iter().flatten().map(|(length, _)| *length);
        CountedDistances {
            mesh_left_out: left_out(&mesh_samples),
            target_left_out: left_out(&target_samples),
            hausdorff_of_all: lengths.fold(0.0, f64::max),
            distances: SurfaceDistances {
                to_target: DirectedDistances {
                    of_samples: counted(&mesh_samples),
                    of_vertices: counted(&mesh_vertices),
                },
                to_draped: DirectedDistances {
                    of_samples: counted(&target_samples),
                    of_vertices: counted(&target_vertices),
                },
            },
        }
    }
}

struct Case<'a> {
    counterparts: &'a Counterparts,
    triangulation: &'a Triangulation,
    draped: &'a Positions,
    target: &'a dyn TargetSurface,
    bvh: TriangleBvh,
    unit: f64,
}

impl Case<'_> {
    fn to_target_of_samples(&self, n: usize, rng: &mut SeededRng) -> Vec<Measured> {
        let (rows, points) = sample_by_area(self.triangulation, self.draped, n, rng);
        let hits = self.target.closest_points(&points);
        let measured = rows.into_iter().zip(&hits).map(|(row, hit)| {
            let is_beyond = self.counterparts.target_ends && self.is_at_end(hit);
            (self.length(hit), self.has_triangle(row) && !is_beyond)
        });
        measured.collect()
    }

    fn to_target_of_vertices(&self) -> Vec<Measured> {
        let vertices: Vec<VertexId> = self.triangulation.used_vertices().collect();
        let points: Vec<Point3> = vertices.iter().map(|&v| self.draped[v]).collect();
        let hits = self.target.closest_points(&points);
        let measured = vertices.iter().zip(&hits).map(|(&v, hit)| {
            let has = self.counterparts.has_vertex(v, hit, self.target);
            (self.length(hit), has)
        });
        measured.collect()
    }

    fn to_draped(&self, points: &[Point3]) -> Vec<Measured> {
        let hits = self.bvh.closest_points(points);
        let measured = hits.iter().map(|hit| {
            let Location::Triangle { index, barycentric } = hit.location else {
                return (self.length(hit), true);
            };
            let boundary = self.triangulation.boundary();
            let is_beyond = self.counterparts.mesh_ends && boundary.contains(index, &barycentric);
            (
                self.length(hit),
                self.has_triangle(index as usize) && !is_beyond,
            )
        });
        measured.collect()
    }

    fn has_triangle(&self, row: usize) -> bool {
        let corners = self.triangulation.triangles()[row];
        corners.iter().any(|&v| self.counterparts.of_vertices[v])
    }

    fn is_at_end(&self, hit: &SurfacePoint) -> bool {
        self.target.is_on_boundary(&hit.location)
    }

    fn length(&self, hit: &SurfacePoint) -> f64 {
        hit.distance_squared.sqrt() * self.unit
    }
}

fn counted(measured: &[Measured]) -> Vec<f64> {
    let counted = measured.iter().filter(|(_, counts)| *counts);
    counted.map(|(length, _)| *length).collect()
}

fn left_out(measured: &[Measured]) -> f64 {
    let n = measured.iter().filter(|(_, counts)| !counts).count();
    n as f64 / measured.len().max(1) as f64
}

/// `n` points, uniform by area, one in each of `n` equal shares of the area, with the rows of their triangles; over
/// triangles alike if none has area.
fn sample_by_area(
    triangulation: &Triangulation,
    x: &Positions,
    n: usize,
    rng: &mut SeededRng,
) -> (Vec<usize>, Vec<Point3>) {
    let corners: Vec<[Point3; 3]> = triangulation.corners(x).collect();
    let areas = mesh_core::measure::triangle_areas(triangulation, x);
    let places = TriangleSampler::new(areas).sample(n, rng).into_iter();
    places
        .map(|(row, weights)| {
            let weighted = (0..3).map(|k| corners[row][k].coords * weights[k]);
            (row, Point3::from(weighted.sum::<Vector3>()))
        })
        .unzip()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hausdorff_sampled;
    use mesh_core::{shapes, TriangleSoup};

    const CONFIG: EvaluationConfig = EvaluationConfig {
        n_samples: 2000,
        seed: 3,
    };

    /// A grid of the unit square of which the target is the left half.
    #[test]
    fn what_the_target_lacks_is_left_out_and_counted() {
        let (mesh, x) = shapes::open_grid(8, 8).into_halfedge().unwrap();
        let t = Triangulation::new(&mesh, &x);
        let mut half = shapes::open_grid(8, 8);
        half.positions.iter_mut().for_each(|p| p.x *= 0.5);
        let target = TriangleSoup::new(half).unwrap();

        let all = Counterparts::all(x.len());
        let whole = all.distances(&t, &x, &target, &CONFIG);
        assert!((hausdorff_sampled(&whole.distances) - 0.5).abs() < 1e-9);
        assert_eq!((whole.mesh_left_out, whole.target_left_out), (0.0, 0.0));

        let partial = Counterparts {
            target_ends: true,
            ..all
        };
        let counted = partial.distances(&t, &x, &target, &CONFIG);
        assert!(hausdorff_sampled(&counted.distances) < 1e-9);
        assert_eq!(
            counted.hausdorff_of_all,
            hausdorff_sampled(&whole.distances)
        );
        // One sample per equal share of the area: the half is met to within a row of them.
        assert!((counted.mesh_left_out - 0.5).abs() < 0.02);
        assert_eq!(counted.target_left_out, 0.0);
    }

    #[test]
    fn the_other_way_round_and_where_nothing_was_drawn() {
        let (mesh, mut x) = shapes::open_grid(8, 8).into_halfedge().unwrap();
        let t = Triangulation::new(&mesh, &x);
        let target = TriangleSoup::new(shapes::open_grid(8, 8)).unwrap();
        x.as_mut_slice().iter_mut().for_each(|p| p.x *= 0.5);
        let partial = Counterparts {
            mesh_ends: true,
            ..Counterparts::all(x.len())
        };
        let counted = partial.distances(&t, &x, &target, &CONFIG);
        assert!(hausdorff_sampled(&counted.distances) < 1e-9);
        assert!((counted.target_left_out - 0.5).abs() < 0.05);

        let none = Counterparts {
            of_vertices: VertexData::new(x.len(), false),
            ..partial
        };
        let counted = none.distances(&t, &x, &target, &CONFIG);
        assert_eq!(counted.distances.to_target.all().count(), 0);
        assert_eq!((counted.mesh_left_out, counted.target_left_out), (1.0, 1.0));
    }
}
