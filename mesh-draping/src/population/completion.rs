//! What a target does not show, taken from the shapes that a source took before.

use mesh_core::{Positions, Vector3, VertexId};
use mesh_operators::{cotan_laplacian, FixedSolve, FixedSolveScratch};

use super::{overlay, Fitted, Population, Pull, N_LOOKED_AT, ROUNDS};
use crate::initial::ENOUGH_TO_STAND;
use crate::{Similarity, Source};
use mesh_init::PointPair;

/// A result whose part that the target did not show was completed.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Completion {
    /// One position per vertex of the source, in the target's coordinates.
    pub(crate) positions: Positions,
    /// How many vertices were moved.
    pub(crate) n_moved: usize,
    /// How much of the way they went, 0..=1.
    pub(crate) trust: f64,
}

impl Population {
    /// The result `draped` of `source`, with the vertices that were not `seen` where the population expects them.
    ///
    /// The shape y of the population that fits the seen vertices best tells the form of the others; what y misses at the edge
    /// of the seen fades into them as a harmonic field h: `x = draped + t (y + h − draped)`. They go as much of the way as the
    /// population explains of what is seen beyond what the rest shape, laid over it, does: `t = 1 − (e_y / e_rest)²`, with the
    /// roots of the mean squared misses e.
    ///
    /// None where all or next to nothing is seen, or the population explains no more than the rest shape. Pieces of the source
    /// of which nothing is seen stay.
    pub(crate) fn completed(
        &self,
        source: &Source,
        draped: &Positions,
        is_seen: impl Fn(VertexId) -> bool,
    ) -> Option<Completion> {
        let groups = source.triangulation().connected_groups(|_| true);
        let partly = groups.iter().filter(|g| g.iter().any(|&v| is_seen(v)));
        let unseen: Vec<VertexId> = partly.flatten().copied().filter(|&v| !is_seen(v)).collect();
        let seen: Vec<VertexId> = draped.ids().filter(|&v| is_seen(v)).collect();
        if unseen.is_empty() || seen.len() < ENOUGH_TO_STAND.max(self.n_modes()) {
            return None;
        }
        let expected = self.fit_to(&seen, draped);
        let trust = trust(
            &seen,
            draped,
            [&expected, &laid_over(source, &seen, draped)],
        )?;

        let mut is_held = vec![true; draped.len()];
        unseen.iter().for_each(|v| is_held[v.index()] = false);
        let held: Vec<VertexId> = draped.ids().filter(|v| is_held[v.index()]).collect();
        let laplacian = cotan_laplacian(source.triangulation(), source.rest());
        let solve = FixedSolve::new(&laplacian, &held).ok()?;
        let misses = draped.iter().zip(&expected).map(|(p, y)| p - y);
        let mut field: Vec<Vector3> = misses.collect();
        solve.solve_in_place(&mut field, &mut FixedSolveScratch::default());

        let mut positions = draped.clone();
        for &v in &unseen {
            let goal = expected[v] + field[v.index()];
            positions[v] += (goal - draped[v]) * trust;
        }
        Some(Completion {
            positions,
            n_moved: unseen.len(),
            trust,
        })
    }

    /// The shape of the population that fits a shape of the source best at these vertices, in its coordinates.
    fn fit_to(&self, seen: &[VertexId], shape: &Positions) -> Positions {
        let every = seen.len().div_ceil(N_LOOKED_AT);
        let pull = |&v: &VertexId| Pull {
            to: shape[v],
            ..self.pull_of(v)
        };
        let pulls: Vec<Pull> = seen.iter().step_by(every).map(pull).collect();
        let pulls: Vec<&Pull> = pulls.iter().collect();
        let mut fitted = Fitted::new(self, overlay(&self.mean, shape));
        for _ in 0..ROUNDS.into_iter().sum() {
            fitted.improve(&pulls, self.side);
        }
        fitted.placed(self)
    }
}

/// The rest shape laid over a result at these vertices.
fn laid_over(source: &Source, seen: &[VertexId], draped: &Positions) -> Positions {
    let rest = source.rest();
    let pairs = seen.iter().map(|&v| PointPair::new(rest[v], draped[v]));
    let map = Similarity::fit(&pairs.collect::<Vec<_>>());
    rest.map(|p| map.apply(p))
}

/// How much better the first shape explains a result at these vertices than the second; none where it is no better.
fn trust(seen: &[VertexId], draped: &Positions, shapes: [&Positions; 2]) -> Option<f64> {
    let [expected, plain] = shapes.map(|shape| {
        let misses = seen.iter().map(|&v| (shape[v] - draped[v]).norm_squared());
        misses.sum::<f64>()
    });
    (expected < plain).then(|| 1.0 - expected / plain)
}

#[cfg(test)]
mod tests {
    use super::super::tests::{egg, population};
    use super::*;
    use crate::Seams;
    use mesh_core::shapes;

    fn source() -> Source {
        Source::of_soup(shapes::quad_sphere(6), Seams::EXACT).expect("a mesh")
    }

    /// What is right in front, and as the rest shape is behind.
    fn half_right(right: &Positions) -> Positions {
        let rest = source().rest().clone();
        let ids = rest.ids();
        let half = ids.map(|v| if rest[v].x > 0.0 { right[v] } else { rest[v] });
        half.collect()
    }

    fn worst(a: &Positions, b: &Positions) -> f64 {
        let misses = a.iter().zip(b).map(|(a, b)| (a - b).norm());
        misses.fold(0.0, f64::max)
    }

    #[test]
    fn what_is_not_seen_is_as_the_population_expects_it() {
        let right = Positions::from(egg(1.25, 1.1).positions);
        let draped = half_right(&right);
        let rest = source().rest().clone();
        let found = population().completed(&source(), &draped, |v| rest[v].x > 0.0);
        let found = found.expect("half of it is not seen");
        assert!(found.trust > 0.8 && found.trust <= 1.0, "{}", found.trust);
        let (before, after) = (worst(&draped, &right), worst(&found.positions, &right));
        assert!(after < 0.25 * before, "{before} {after}");
        for v in draped.ids().filter(|&v| rest[v].x > 0.0) {
            assert_eq!(found.positions[v], draped[v], "what is seen stays");
        }
    }

    #[test]
    fn nothing_is_completed_where_all_is_seen_or_nothing_is_explained() {
        let right = Positions::from(egg(1.25, 1.1).positions);
        let whole = population().completed(&source(), &right, |_| true);
        assert_eq!(whole, None);
        let none = population().completed(&source(), &right, |_| false);
        assert_eq!(none, None);
        // The rest shape itself, which the eggs do not explain better than it does.
        let rest = source().rest().clone();
        let plain = population().completed(&source(), &rest, |v| rest[v].x > 0.0);
        assert_eq!(plain, None);
    }
}
