//! How far apart two surfaces are at worst (Eq. 7).

use crate::distances::{DirectedDistances, SurfaceDistances};

/// Largest distance between the two surfaces, either way.
///
/// `H = max { sup_x inf_y d(x, y), sup_y inf_x d(x, y) }`
///
/// Each `inf` is exact, over the true surface; each `sup` is over the vertices and the samples, so this comes from
/// below. Units: longest sides of the target's box; symmetric. 0 where nothing was measured.
/// Source: Mesh Draping, Eq. 7. Departures: the paper's weight 1e2 is [`crate::HAUSDORFF_WEIGHT`].
pub fn hausdorff_sampled(distances: &SurfaceDistances) -> f64 {
    let [one, other] = [&distances.to_target, &distances.to_draped].map(directed_hausdorff_sampled);
    one.max(other)
}

/// Largest distance one way.
pub fn directed_hausdorff_sampled(distances: &DirectedDistances) -> f64 {
    distances.all().fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worse_direction_counts_vertices_too() {
        let directed = |samples: &[f64], vertices: &[f64]| DirectedDistances {
            of_samples: samples.to_vec(),
            of_vertices: vertices.to_vec(),
        };
        let distances = SurfaceDistances {
            to_target: directed(&[0.1], &[0.2]),
            to_draped: directed(&[0.05, 0.3], &[]),
        };
        assert_eq!(hausdorff_sampled(&distances), 0.3);
        assert_eq!(directed_hausdorff_sampled(&distances.to_target), 0.2);
    }
}
