//! Which landmarks are exchanged, by how far they are from each other along both shapes.

use mesh_core::Landmark;
use mesh_init::{GuideInput, LandmarkWays};

use crate::stand_in::StandIn;
use crate::Pair;

/// Sources with more vertices than this are measured on a stand-in of so many.
const N_VERTICES: usize = 3000;
/// Share of the misfit that exchanging two landmarks must leave, at most. Surfaces that touch make ways shorter than they
/// are: with 0.95 two of forty clean sets of animals and people were called exchanged, with 0.92 none.
const EXCHANGE_GAIN: f64 = 0.92;
/// Ways are compared where at least this share of the pairs of landmarks is joined on both shapes.
const JOINED: f64 = 0.5;

/// How well the ways between landmarks agree: the mean of `|ln(s/t) − m|` over the pairs of landmarks that a way of length
/// s joins on the source and one of length t on the target, where m is the mean of `ln(s/t)`.
///
/// Poses change no such length, and a scale changes m alone.
pub(super) struct Ways {
    /// Logarithms of the lengths; not finite where no way leads.
    source: Vec<Vec<f64>>,
    target: Vec<Vec<f64>>,
    mean: f64,
}

/// A sum over pairs of landmarks, and of how many.
#[derive(Clone, Copy, Debug, Default)]
struct Misfit {
    sum: f64,
    n: usize,
}

impl Ways {
    /// None where too few landmarks are joined on both shapes to compare.
    pub(super) fn of(pair: &Pair) -> Option<Self> {
        let is_dense = pair.source.rest().len() > N_VERTICES;
        let stand_in = is_dense.then(|| StandIn::with_vertices(pair, N_VERTICES).ok());
        let stand_in = stand_in.flatten();
        let pair = stand_in.as_ref().map_or(pair, |s| &s.pair);
        let followed = Landmark::marked(&pair.landmarks).filter(|l| l.is_followed());
        let marked: Vec<Landmark> = followed.cloned().collect();
        let ways = LandmarkWays::new(GuideInput {
            triangulation: pair.source.triangulation(),
            rest: pair.source.rest(),
            landmarks: &marked,
            target: pair.target.draped_over().as_ref(),
        });
        Self::new(&ways)
    }

    fn new(ways: &LandmarkWays) -> Option<Self> {
        let logs = |rows: &[Vec<f64>]| -> Vec<Vec<f64>> {
            let row = |row: &Vec<f64>| row.iter().map(|d| d.ln()).collect();
            rows.iter().map(row).collect()
        };
        let mut ways = Self {
            source: logs(&ways.on_source),
            target: logs(&ways.on_target),
            mean: 0.0,
        };
        let n = ways.source.len();
        let all = (0..n).flat_map(|k| (0..n).map(move |l| [k, l]));
        let ratios: Vec<f64> = all.filter_map(|at| ways.ratio(at, at)).collect();
        ways.mean = ratios.iter().sum::<f64>() / ratios.len().max(1) as f64;
        let n_pairs = n * n.saturating_sub(1);
        (ratios.len() as f64 > JOINED * n_pairs as f64).then_some(ways)
    }

    /// `ln(s/t)` of two landmarks, `places` taking their places on the target.
    fn ratio(&self, [k, l]: [usize; 2], places: [usize; 2]) -> Option<f64> {
        let ratio = self.source[k][l] - self.target[places[0]][places[1]];
        (k != l && ratio.is_finite()).then_some(ratio)
    }

    /// The two landmarks whose exchange makes the ways agree best, if it does so by enough.
    pub(super) fn exchanged(&self) -> Option<[usize; 2]> {
        let n = self.source.len();
        let whole = (0..n).map(|k| self.misfit_at(k, |p| p)).sum::<Misfit>();
        let pairs = (0..n).flat_map(|j| (0..j).map(move |i| [i, j]));
        let after = pairs.map(|[i, j]| {
            let swapped = move |p: usize| match p {
                _ if p == i => j,
                _ if p == j => i,
                _ => p,
            };
            let before = self.misfit_of([i, j], |p| p);
            let after = self.misfit_of([i, j], swapped);
            let changed = Misfit {
                sum: whole.sum - before.sum + after.sum,
                n: whole.n - before.n + after.n,
            };
            (changed.mean(), [i, j])
        });
        let (best, exchanged) = after.min_by(|a, b| a.0.total_cmp(&b.0))?;
        (best < EXCHANGE_GAIN * whole.mean()).then_some(exchanged)
    }

    /// Exchanges the places of two landmarks on the target.
    pub(super) fn exchange(&mut self, [i, j]: [usize; 2]) {
        self.target.swap(i, j);
        self.target.iter_mut().for_each(|row| row.swap(i, j));
    }

    /// Over the pairs that have landmark `k` first.
    fn misfit_at(&self, k: usize, place: impl Fn(usize) -> usize) -> Misfit {
        let others = 0..self.source.len();
        let ratios = others.filter_map(|l| self.ratio([k, l], [place(k), place(l)]));
        ratios.map(|ratio| Misfit::of(ratio - self.mean)).sum()
    }

    /// Over the pairs with one of two landmarks in them.
    fn misfit_of(&self, both: [usize; 2], place: impl Fn(usize) -> usize + Copy) -> Misfit {
        let first: Misfit = both.iter().map(|&k| self.misfit_at(k, place)).sum();
        let others = (0..self.source.len()).filter(|k| !both.contains(k));
        let second = others.flat_map(|k| both.map(|l| self.ratio([k, l], [place(k), place(l)])));
        let second = second.flatten().map(|ratio| Misfit::of(ratio - self.mean));
        [first, second.sum()].into_iter().sum()
    }
}

impl Misfit {
    fn of(difference: f64) -> Self {
        Self {
            sum: difference.abs(),
            n: 1,
        }
    }

    fn mean(self) -> f64 {
        self.sum / self.n.max(1) as f64
    }
}

impl std::iter::Sum for Misfit {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::default(), |a, b| Self {
            sum: a.sum + b.sum,
            n: a.n + b.n,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Five places on a line, the target twice as long and a little uneven.
    fn ways(target: [f64; 5]) -> Ways {
        let along = |x: [f64; 5]| {
            let row = |a: f64| x.iter().map(|b: &f64| (a - b).abs()).collect();
            x.iter().map(|&a| row(a)).collect()
        };
        let ways = LandmarkWays {
            on_source: along([0.0, 1.0, 3.0, 6.0, 10.0]),
            on_target: along(target),
        };
        Ways::new(&ways).unwrap()
    }

    #[test]
    fn exchanged_places_are_found_whatever_the_scale() {
        assert_eq!(ways([0.0, 2.1, 6.0, 12.3, 20.0]).exchanged(), None);
        let mut spoiled = ways([0.0, 12.3, 6.0, 2.1, 20.0]);
        assert_eq!(spoiled.exchanged(), Some([1, 3]));
        spoiled.exchange([1, 3]);
        assert_eq!(spoiled.exchanged(), None);
    }

    #[test]
    fn landmarks_that_no_way_joins_are_not_compared() {
        let apart = vec![vec![f64::INFINITY; 5]; 5];
        let ways = LandmarkWays {
            on_source: apart.clone(),
            on_target: apart,
        };
        assert!(Ways::new(&ways).is_none());
    }
}
