//! The shapes that a source took before, as what to expect of the next one.

mod completion;

use mesh_core::{
    Aabb, Landmark, Point3, Positions, SurfacePoint, TargetSurface, Vector3, VertexId,
};
use mesh_init::PointPair;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

use crate::initial::ENOUGH_TO_STAND;
use crate::{Pair, Similarity};
pub(crate) use completion::Completion;

/// Variance of a mode, as a share of the largest, below which it is noise.
const LEAST_VARIANCE: f64 = 1e-4;
/// How far a landmark or a closest point may miss, in longest sides of the mean: what modes are weighed against.
const MISS: f64 = 0.02;
/// Vertices whose closest points are looked at.
const N_LOOKED_AT: usize = 400;
/// Rounds with landmarks alone, and rounds with closest points.
const ROUNDS: [usize; 2] = [5, 15];

/// The mean of the shapes that a source took, and the modes in which they differ.
///
/// Each shape is laid over the first by the best similarity; `x(c) = m + Σ c_k φ_k` with `φ_k = D w_k / √(N − 1)`, D the
/// deviations from the mean m and `w_k` the eigenvectors of `Dᵀ D`, so that each `c_k` has variance 1 over the shapes. A single
/// shape has no mode.
#[derive(Clone, Debug)]
pub struct Population {
    mean: Positions,
    /// Strongest first.
    modes: Vec<Vec<Vector3>>,
    side: f64,
}

/// A place on the shapes and where it should come to.
struct Pull {
    /// On the mean.
    mean: Point3,
    /// What each mode does to it.
    modes: Vec<Vector3>,
    /// In the target's coordinates.
    to: Point3,
    /// How much it counts, > 0.
    weight: f64,
}

impl Population {
    /// The population of these shapes, one position per vertex of the source each; none of no shape.
    ///
    /// # Panics
    /// If one has another number of vertices.
    pub fn of(shapes: &[Positions]) -> Option<Self> {
        let first = shapes.first()?;
        let laid_over = |shape: &Positions| {
            let similarity = overlay(shape, first);
            shape.map(|p| similarity.apply(p))
        };
        let laid_over: Vec<Positions> = shapes.iter().map(laid_over).collect();
        let n = shapes.len() as f64;
        let mean: Positions = (0..first.len())
            .map(|v| {
                let v = VertexId::new(v);
                let sum = laid_over.iter().map(|shape| shape[v].coords);
                Point3::from(sum.sum::<Vector3>() / n)
            })
            .collect();
        let deviations: Vec<Vec<Vector3>> = laid_over
            .iter()
            .map(|shape| shape.iter().zip(mean.iter()).map(|(p, m)| p - m).collect())
            .collect();
        let side = Aabb::of(mean.iter()).longest_side();
        Some(Self {
            modes: modes(&deviations),
            mean,
            side,
        })
    }

    /// How many vertices each shape has.
    pub fn n_vertices(&self) -> usize {
        self.mean.len()
    }

    /// How many modes there are.
    pub fn n_modes(&self) -> usize {
        self.modes.len()
    }

    /// The shape of the population that fits a pair best, in the target's coordinates: where a drape may start
    /// ([`Transfer::with_prior`](crate::Transfer::with_prior)).
    ///
    /// `min Σ w_j |T q_j − x_j(c)|² / σ² + |c|²` over the coefficients c and the similarity T from the target to the population,
    /// with σ a fiftieth of the longest side: first over landmarks q_j, weighted as they are, then also over the closest points
    /// of vertices, w by how far that is beside the others; none on an open boundary. With fewer than three landmarks the target is taken to stand as the shapes do.
    ///
    /// # Panics
    /// If the source has another number of vertices than the shapes.
    pub fn fit(&self, pair: &Pair) -> Positions {
        self.fit_near(pair, &self.mean)
    }

    /// As [`Self::fit`]; with fewer than three landmarks the target is taken to stand as `near` does, a shape of the source in
    /// its coordinates.
    ///
    /// # Panics
    /// As [`Self::fit`].
    pub fn fit_near(&self, pair: &Pair, near: &Positions) -> Positions {
        assert_eq!(pair.source.rest().len(), self.mean.len(), "one source");
        let followed = pair.landmarks.iter().filter(|l| l.is_followed());
        let marks: Vec<Pull> = followed.map(|l| self.pull_to(l)).collect();
        let mut fitted = Fitted::new(self, overlay(&self.mean, near));
        if marks.len() >= ENOUGH_TO_STAND {
            for _ in 0..ROUNDS[0] {
                fitted.improve(&marks.iter().collect::<Vec<_>>(), self.side);
            }
        }
        let target = pair.target.draped_over().as_ref();
        for _ in 0..ROUNDS[1] {
            let near = self.pulls_to_closest(&fitted, target);
            let all: Vec<&Pull> = marks.iter().chain(&near).collect();
            fitted.improve(&all, self.side);
        }
        fitted.placed(self)
    }

    fn shape(&self, coefficients: &DVector<f64>) -> Positions {
        let mut shape = self.mean.clone();
        for (mode, c) in self.modes.iter().zip(coefficients.iter()) {
            for (p, d) in shape.as_mut_slice().iter_mut().zip(mode) {
                *p += d * *c;
            }
        }
        shape
    }

    fn pull_to(&self, landmark: &Landmark) -> Pull {
        let place = &landmark.source;
        let moved = |mode: &Vec<Vector3>| {
            let corners = place.vertices.iter().zip(place.weights);
            corners.map(|(v, weight)| mode[v.index()] * weight).sum()
        };
        Pull {
            mean: place.position(&self.mean),
            modes: self.modes.iter().map(moved).collect(),
            to: landmark.target,
            weight: landmark.weight,
        }
    }

    /// Vertices spread over the source, each with the closest point of the target: none where that lies on its open boundary,
    /// and the less the farther it is beside the others, `(1 + d² / d̄²)⁻²` with their median d̄.
    fn pulls_to_closest(&self, fitted: &Fitted, target: &dyn TargetSurface) -> Vec<Pull> {
        let shape = self.shape(&fitted.coefficients);
        let every = self.mean.len().div_ceil(N_LOOKED_AT);
        let rows = (0..self.mean.len()).step_by(every).map(VertexId::new);
        let rows: Vec<VertexId> = rows.collect();
        let placed = rows.iter().map(|&v| fitted.similarity.apply(&shape[v]));
        let hits = target.closest_points(&placed.collect::<Vec<_>>());
        let within: Vec<(VertexId, SurfacePoint)> = (rows.into_iter().zip(hits))
            .filter(|(_, hit)| !target.is_on_boundary(&hit.location))
            .collect();
        let scale = middle(within.iter().map(|(_, hit)| hit.distance_squared).collect());
        let scale = scale.max((MISS * target.bounds().longest_side()).powi(2));
        let pulls = within.iter().map(|(v, hit)| Pull {
            to: hit.point,
            weight: (1.0 + hit.distance_squared / scale).powi(-2),
            ..self.pull_of(*v)
        });
        pulls.collect()
    }

    /// A pull on a vertex, to where it is on the mean.
    fn pull_of(&self, v: VertexId) -> Pull {
        Pull {
            mean: self.mean[v],
            modes: self.modes.iter().map(|mode| mode[v.index()]).collect(),
            to: self.mean[v],
            weight: 1.0,
        }
    }
}

/// A shape of the population on its way to a target.
struct Fitted {
    coefficients: DVector<f64>,
    /// From the population to the target.
    similarity: Similarity,
}

impl Fitted {
    /// The mean, where a map puts it.
    fn new(population: &Population, similarity: Similarity) -> Self {
        Self {
            coefficients: DVector::zeros(population.modes.len()),
            similarity,
        }
    }

    /// The shape in the target's coordinates.
    fn placed(&self, population: &Population) -> Positions {
        let shape = population.shape(&self.coefficients);
        shape.map(|p| self.similarity.apply(p))
    }

    /// One round: the similarity for these coefficients, then the coefficients for this similarity.
    fn improve(&mut self, pulls: &[&Pull], side: f64) {
        let place = |pull: &Pull, c: &DVector<f64>| {
            let moved = pull.modes.iter().zip(c.iter()).map(|(mode, c)| mode * *c);
            pull.mean + moved.sum::<Vector3>()
        };
        let pairs = |c: &DVector<f64>| -> Vec<PointPair> {
            let pair = |pull: &&Pull| PointPair {
                weight: pull.weight,
                ..PointPair::new(place(pull, c), pull.to)
            };
            pulls.iter().map(pair).collect()
        };
        let pairs_now = pairs(&self.coefficients).into_iter();
        let back = pairs_now.map(|p| PointPair {
            source: p.target,
            target: p.source,
            ..p
        });
        let back = Similarity::fit(&back.collect::<Vec<_>>());

        let n = self.coefficients.len();
        let mut normal = DMatrix::identity(n, n) * (MISS * side).powi(2);
        let mut right = DVector::zeros(n);
        for pull in pulls {
            let miss = back.apply(&pull.to) - pull.mean;
            for (i, a) in pull.modes.iter().enumerate() {
                right[i] += pull.weight * a.dot(&miss);
                for (j, b) in pull.modes.iter().enumerate() {
                    normal[(i, j)] += pull.weight * a.dot(b);
                }
            }
        }
        if let Some(solved) = normal.cholesky() {
            self.coefficients = solved.solve(&right);
        }
        self.similarity = Similarity::fit(&pairs(&self.coefficients));
    }
}

/// The value in the middle; 0 of none.
fn middle(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// The similarity that best lays a shape over another.
fn overlay(shape: &Positions, other: &Positions) -> Similarity {
    assert_eq!(shape.len(), other.len(), "shapes of one source");
    let pairs = shape.iter().zip(other.iter());
    let pair = |(&source, &target)| PointPair::new(source, target);
    Similarity::fit(&pairs.map(pair).collect::<Vec<_>>())
}

/// The modes of deviations from a mean, strongest first, each as long as its deviation is on average.
fn modes(deviations: &[Vec<Vector3>]) -> Vec<Vec<Vector3>> {
    let n = deviations.len();
    let dot = |a: &[Vector3], b: &[Vector3]| a.iter().zip(b).map(|(a, b)| a.dot(b)).sum::<f64>();
    let gram = DMatrix::from_fn(n, n, |i, j| dot(&deviations[i], &deviations[j]));
    let eigen = SymmetricEigen::new(gram);
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
    let strongest = order.first().map_or(0.0, |&k| eigen.eigenvalues[k]);
    let kept = order
        .into_iter()
        .filter(|&k| eigen.eigenvalues[k] > LEAST_VARIANCE * strongest);
    let scale = 1.0 / ((n as f64 - 1.0).max(1.0)).sqrt();
    let mode = |k: usize| {
        let mut mode = vec![Vector3::zeros(); deviations[0].len()];
        for (deviation, weight) in deviations.iter().zip(eigen.eigenvectors.column(k).iter()) {
            for (sum, d) in mode.iter_mut().zip(deviation) {
                *sum += d * (weight * scale);
            }
        }
        mode
    };
    kept.map(mode).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Seams, Source, Target};
    use mesh_core::{shapes, PolygonSoup};

    /// A ball drawn out along two axes.
    pub(super) fn egg(y: f64, z: f64) -> PolygonSoup {
        let mut soup = shapes::quad_sphere(6);
        for p in &mut soup.positions {
            *p = Point3::new(p.x, y * p.y, z * p.z);
        }
        soup
    }

    pub(super) fn population() -> Population {
        let eggs = [(1.0, 1.0), (1.4, 1.0), (1.0, 1.3), (1.4, 1.3), (1.2, 0.8)];
        let shapes = eggs.map(|(y, z)| Positions::from(egg(y, z).positions));
        Population::of(&shapes).expect("five shapes")
    }

    pub(super) fn pair(y: f64, z: f64) -> Pair {
        Pair {
            source: Source::of_soup(shapes::quad_sphere(6), Seams::EXACT).expect("a mesh"),
            target: Target::of_soup(egg(y, z)).expect("a target"),
            landmarks: Vec::new(),
        }
    }

    #[test]
    fn two_ways_to_differ_are_two_modes_beside_their_noise() {
        let population = population();
        let variances = population.modes.iter();
        let variances: Vec<f64> = variances
            .map(|mode| mode.iter().map(Vector3::norm_squared).sum())
            .collect();
        // Scale is taken out of a similarity only to first order: a third mode is what is left.
        assert!(variances.len() >= 2 && variances.windows(2).all(|w| w[0] >= w[1]));
        let rest: f64 = variances[2..].iter().sum();
        assert!(rest < 0.02 * variances[1], "{variances:?}");
    }

    #[test]
    fn a_shape_between_those_that_are_known_is_found_without_a_landmark() {
        let pair = pair(1.25, 1.1);
        let fitted = population().fit(&pair);
        let right = &pair.target.soup().positions;
        let misses = fitted.iter().zip(right).map(|(a, b)| (a - b).norm());
        let worst = misses.fold(0.0, f64::max);
        assert!(worst < 0.03, "{worst}");
    }

    #[test]
    fn landmarks_find_a_shape_that_stands_elsewhere() {
        let mut pair = pair(1.25, 1.1);
        let away = |p: &Point3| Point3::new(5.0 - 2.0 * p.y, 2.0 * p.x, 2.0 * p.z + 1.0);
        let mut moved = pair.target.soup().clone();
        moved.positions.iter_mut().for_each(|p| *p = away(p));
        let rows = (0..moved.positions.len()).step_by(9);
        pair.landmarks = rows
            .map(|row| Landmark::new(VertexId::new(row), moved.positions[row]))
            .collect();
        pair.target = Target::of_soup(moved.clone()).unwrap();
        let fitted = population().fit(&pair);
        let misses = fitted.iter().zip(&moved.positions);
        let worst = misses.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        assert!(worst < 0.06, "{worst}");
    }

    /// The closest points of what the scan does not show lie all on its edge.
    #[test]
    fn a_scan_of_one_side_does_not_draw_the_other_to_its_edge() {
        let mut pair = pair(1.25, 1.1);
        let right = pair.target.soup().positions.clone();
        let mut scan = egg(1.25, 1.1);
        let is_seen = |row: &u32| scan.positions[*row as usize].x > -0.1;
        let faces = scan.faces.iter().filter(|face| face.iter().all(is_seen));
        scan.faces = faces.cloned().collect();
        let rest = pair.source.rest();
        let front = rest.ids().filter(|&v| rest[v].x > 0.3).step_by(5);
        pair.landmarks = front.map(|v| Landmark::new(v, right[v.index()])).collect();
        pair.target = Target::of_soup(scan).unwrap();
        let fitted = population().fit(&pair);
        let misses = fitted.iter().zip(&right).map(|(a, b)| (a - b).norm());
        let worst = misses.fold(0.0, f64::max);
        assert!(worst < 0.06, "{worst}");
    }

    /// Two landmarks of half the weight count as one.
    #[test]
    fn landmarks_count_by_their_weight() {
        let mut pair = pair(1.25, 1.1);
        let at = |row: usize| pair.target.soup().positions[row] * 1.1;
        let rows = (0..pair.target.soup().positions.len()).step_by(30);
        pair.landmarks = rows
            .map(|row| Landmark::new(VertexId::new(row), at(row)))
            .collect();
        let once = population().fit(&pair);
        let halves = pair.landmarks.iter().map(|l| Landmark {
            weight: 0.5,
            ..l.clone()
        });
        pair.landmarks = halves.clone().chain(halves).collect();
        let twice = population().fit(&pair);
        for (a, b) in once.iter().zip(&twice) {
            assert!((a - b).norm() < 1e-9);
        }
    }

    #[test]
    fn one_shape_has_no_mode_and_none_is_no_population() {
        assert!(Population::of(&[]).is_none());
        let one = Population::of(&[Positions::from(egg(1.0, 1.0).positions)]).unwrap();
        assert_eq!(one.n_modes(), 0);
        let fitted = one.fit(&pair(1.0, 1.0));
        assert_eq!(fitted.len(), one.mean.len());
    }
}
