//! Even random places on triangles.

use super::SeededRng;

/// A triangle's row and the weights of its corners, each ≥ 0, summing to 1.
pub type TrianglePlace = (usize, [f64; 3]);

/// Draws places on triangles, each triangle as often as its weight says.
///
/// Places are stratified: the k-th of n falls into the k-th of n equal shares of the total weight, and within its
/// triangle it follows the R₂ sequence with a random shift. Each is uniform by itself; together they are more even than
/// independent ones, so that a mean over them is less noisy, and they come in the order of the triangles.
///
/// Source: Roberts 2018, "The unreasonable effectiveness of quasirandom sequences" (R₂).
///
/// ```
/// use mesh_core::sampling::{SeededRng, TriangleSampler};
/// let sampler = TriangleSampler::new([1.0, 3.0]);
/// let places = sampler.sample(400, &mut SeededRng::new(0));
/// assert_eq!(places.iter().filter(|(triangle, _)| *triangle == 0).count(), 100);
/// ```
#[derive(Clone, Debug)]
pub struct TriangleSampler {
    cumulative: Vec<f64>,
}

/// 1/g and 1/g² with g³ = g + 1.
const R2: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];

impl TriangleSampler {
    /// A sampler for triangles of these weights (areas, or all the same), each ≥ 0 and finite; where none is positive,
    /// all count the same.
    pub fn new(weights: impl IntoIterator<Item = f64>) -> Self {
        let mut total = 0.0;
        let mut cumulative: Vec<f64> = weights
            .into_iter()
            .map(|weight| {
                total += weight;
                total
            })
            .collect();
        if total <= 0.0 {
            for (row, sum) in cumulative.iter_mut().enumerate() {
                *sum = (row + 1) as f64;
            }
        }
        Self { cumulative }
    }

    /// `n` places, in the order of the triangles; none where there is no triangle.
    pub fn sample(&self, n: usize, rng: &mut SeededRng) -> Vec<TrianglePlace> {
        let Some((&total, last)) = self
            .cumulative
            .last()
            .zip(self.cumulative.len().checked_sub(1))
        else {
            return Vec::new();
        };
        let mut point = [rng.uniform(), rng.uniform()];
        let mut triangle = 0;
        (0..n)
            .map(|k| {
                let at = total * (k as f64 + rng.uniform()) / n as f64;
                triangle = self.first_beyond(at, triangle).min(last);
                point = [0, 1].map(|i| wrapped(point[i] + R2[i]));
                (triangle, uniform_weights(point[0], point[1]))
            })
            .collect()
    }

    /// The first row from `start` on whose sum is beyond `at`, found in steps that double.
    fn first_beyond(&self, at: f64, start: usize) -> usize {
        let (mut start, mut step) = (start, 1);
        while self
            .cumulative
            .get(start + step)
            .is_some_and(|&sum| sum <= at)
        {
            start += step;
            step *= 2;
        }
        let end = (start + step + 1).min(self.cumulative.len());
        start + self.cumulative[start..end].partition_point(|&sum| sum <= at)
    }
}

/// `x` in 0..2 without its whole part.
fn wrapped(x: f64) -> f64 {
    if x < 1.0 {
        x
    } else {
        x - 1.0
    }
}

/// From a uniform point of the unit square to a uniform point of a triangle.
fn uniform_weights(r: f64, s: f64) -> [f64; 3] {
    let root = r.sqrt();
    [1.0 - root, root * (1.0 - s), root * s]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_triangle_gives_no_place() {
        let mut rng = SeededRng::new(0);
        assert!(TriangleSampler::new([]).sample(5, &mut rng).is_empty());
    }

    #[test]
    fn without_weight_all_count_the_same() {
        let mut rng = SeededRng::new(0);
        let rows: Vec<usize> = TriangleSampler::new([0.0; 4])
            .sample(8, &mut rng)
            .iter()
            .map(|place| place.0)
            .collect();
        assert_eq!(rows, [0, 0, 1, 1, 2, 2, 3, 3]);
    }

    #[test]
    fn the_mean_place_is_the_centroid() {
        let mut rng = SeededRng::new(7);
        let places = TriangleSampler::new([1.0]).sample(3000, &mut rng);
        for k in 0..3 {
            let mean = places.iter().map(|(_, w)| w[k]).sum::<f64>() / 3000.0;
            assert!((mean - 1.0 / 3.0).abs() < 2e-3, "{mean}");
        }
        assert!(places.iter().all(|(_, w)| w.iter().all(|&x| x >= 0.0)));
    }
}
