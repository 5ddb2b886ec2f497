//! What a target does not show, taken from the shapes that a source took before.

use mesh_core::{Landmark, Point3, Positions, Vector3, VertexId};
use mesh_operators::{cotan_laplacian, FixedSolve, FixedSolveScratch};

use super::{overlay, Fitted, Population, Pull, N_LOOKED_AT, ROUNDS};
use crate::initial::ENOUGH_TO_STAND;
use crate::{Pair, Similarity, Source};
use mesh_init::PointPair;

/// Landmarks tell more of what the target does not show than a seen vertex does.
const OF_A_LANDMARK: f64 = 10.0;
/// What is so near a landmark stays, in longest sides of the population: a single vertex that is held makes a spike.
const HELD_AROUND: f64 = 0.015;

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
    /// The result `draped` of `pair`, with the vertices that were not `seen` where the population expects them. Those about a
    /// landmark count as seen.
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
        pair: &Pair,
        draped: &Positions,
        is_seen: impl Fn(VertexId) -> bool,
    ) -> Option<Completion> {
        let source = &pair.source;
        let marks: Vec<&Landmark> = pair.landmarks.iter().filter(|l| l.is_followed()).collect();
        let is_marked = self.about(&marks);
        let is_seen = |v: VertexId| is_seen(v) || is_marked[v.index()];
        let groups = source.triangulation().connected_groups(|_| true);
        let partly = groups.iter().filter(|g| g.iter().any(|&v| is_seen(v)));
        let unseen: Vec<VertexId> = partly.flatten().copied().filter(|&v| !is_seen(v)).collect();
        let seen: Vec<VertexId> = draped.ids().filter(|&v| is_seen(v)).collect();
        if unseen.is_empty() || seen.len() < ENOUGH_TO_STAND.max(self.n_modes()) {
            return None;
        }
        let expected = self.fit_to(&seen, &marks, draped);
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

    /// Which vertices of the mean lie about a landmark.
    fn about(&self, marks: &[&Landmark]) -> Vec<bool> {
        let places = marks.iter().map(|l| l.source.position(&self.mean));
        let places: Vec<Point3> = places.collect();
        let limit = HELD_AROUND * self.side;
        let is_near = |p: &Point3| places.iter().any(|q| (p - q).norm() <= limit);
        self.mean.iter().map(is_near).collect()
    }

    /// The shape of the population that fits a shape of the source best at these vertices and at its landmarks, in its
    /// coordinates.
    fn fit_to(&self, seen: &[VertexId], marks: &[&Landmark], shape: &Positions) -> Positions {
        let every = seen.len().div_ceil(N_LOOKED_AT);
        let pull = |&v: &VertexId| Pull {
            to: shape[v],
            ..self.pull_of(v)
        };
        let mark = |l: &&Landmark| Pull {
            to: l.source.position(shape),
            weight: OF_A_LANDMARK * l.weight,
            ..self.pull_to(l)
        };
        let seen = seen.iter().step_by(every).map(pull);
        let pulls: Vec<Pull> = seen.chain(marks.iter().map(mark)).collect();
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
    use super::super::tests::{egg, pair, population};
    use super::*;

    /// What is right in front, and as the rest shape is behind.
    fn half_right(right: &Positions) -> Positions {
        let rest = pair(1.0, 1.0).source.rest().clone();
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
        let rest = pair(1.0, 1.0).source.rest().clone();
        let found = population().completed(&pair(1.0, 1.0), &draped, |v| rest[v].x > 0.0);
        let found = found.expect("half of it is not seen");
        assert!(found.trust > 0.8 && found.trust <= 1.0, "{}", found.trust);
        let (before, after) = (worst(&draped, &right), worst(&found.positions, &right));
        assert!(after < 0.25 * before, "{before} {after}");
        for v in draped.ids().filter(|&v| rest[v].x > 0.0) {
            assert_eq!(found.positions[v], draped[v], "what is seen stays");
        }
    }

    #[test]
    fn what_is_marked_stays_where_it_is() {
        let right = Positions::from(egg(1.25, 1.1).positions);
        let draped = half_right(&right);
        let mut pair = pair(1.0, 1.0);
        let rest = pair.source.rest().clone();
        let back = |a: &VertexId, b: &VertexId| rest[*a].x.total_cmp(&rest[*b].x);
        let marked = rest.ids().min_by(back).expect("a vertex");
        pair.landmarks = vec![Landmark::new(marked, draped[marked])];
        let found = population().completed(&pair, &draped, |v| rest[v].x > 0.0);
        assert_eq!(
            found.expect("the others move").positions[marked],
            draped[marked]
        );
    }

    #[test]
    fn nothing_is_completed_where_all_is_seen_or_nothing_is_explained() {
        let right = Positions::from(egg(1.25, 1.1).positions);
        let whole = population().completed(&pair(1.0, 1.0), &right, |_| true);
        assert_eq!(whole, None);
        let none = population().completed(&pair(1.0, 1.0), &right, |_| false);
        assert_eq!(none, None);
        // The rest shape itself, which the eggs do not explain better than it does.
        let rest = pair(1.0, 1.0).source.rest().clone();
        let plain = population().completed(&pair(1.0, 1.0), &rest, |v| rest[v].x > 0.0);
        assert_eq!(plain, None);
    }
}
