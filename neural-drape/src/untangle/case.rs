//! One try to free a patch.

use mesh_core::{Aabb, Point3, Positions, VertexId};

use super::contour::shorten;
use super::crossing::{triangles_at, Detector};
use super::{is_at, n_pairs, Untangled, Untangler, HOPELESS};
use crate::repair::{flatten, grown, Broken, Reach};

/// A patch leaves the box around it and its start by no more than this share of the longest side.
const MARGIN: f64 = 0.06;
/// So often what crosses is pulled apart and the patch relaxed, ...
const TURNS: usize = 60;
/// ... but no more once so many turns brought nothing.
const PATIENCE: usize = 20;
/// So often, in turns, what folds is flattened, ...
const FLATTEN_EVERY: usize = 6;
/// ... by so many sweeps, ...
const FLATTENINGS: usize = 4;
/// ... with a ring more each time that this many were in vain.
const FLATTENINGS_PER_RING: usize = 3;
/// So often a patch that came free is moved back towards where it was, in the second half to the target, ...
const RETURNS: usize = 20;
/// ... each vertex by this share of what is left at most: all at once, so that both sides of a contact give way.
const RETURN: f64 = 0.2;
/// A vertex farther from the target than this share of the longest side goes there instead.
const STUCK: f64 = 0.003;
/// So often vertices that get in the way stay behind, before nothing moves back.
const STAYS: usize = 3;

/// From where a patch is pulled apart.
#[derive(Clone, Copy, Debug)]
pub(super) enum Start {
    /// From where it is.
    AsItIs,
    /// From where its surroundings carry it.
    Carried,
}

/// What a try came to.
pub(super) struct Candidate {
    pub(super) positions: Positions,
    /// What still crosses of the patch, in order.
    pub(super) left: Vec<[u32; 2]>,
    /// How far from the target the patch came, where it was nearer.
    pub(super) excess: f64,
}

/// A patch with its surroundings up to a number of rings.
pub(super) struct Case<'a, 'u> {
    all: &'u Untangler<'a>,
    /// Where everything was.
    x: &'u Positions,
    /// From where the patch is pulled apart.
    start: Positions,
    /// What is seen of all that the patch may meet; it stays within.
    bounds: Aabb,
    broken: &'u Broken,
    /// What may move, ascending.
    free: Vec<VertexId>,
    /// The triangles that it moves.
    rows: Vec<u32>,
    detector: Detector,
    near: Reach,
    /// What crosses elsewhere.
    others: Vec<[u32; 2]>,
    /// How many pairs cross in the patch.
    n_pairs: usize,
    /// How many vertices were moved, each time counted.
    pub(super) work: usize,
}

impl<'a, 'u> Case<'a, 'u> {
    /// A patch with so many rings around it; none where nothing can carry it.
    pub(super) fn new(
        all: &'u Untangler<'a>,
        shape: &'u Untangled,
        patch: &[VertexId],
        (rings, start): (usize, Start),
    ) -> Option<Self> {
        let (x, triangulation) = (&shape.positions, all.ground.triangulation);
        let mut free = grown(triangulation, patch, rings);
        free.retain(|v| all.held.binary_search(v).is_err());
        let mut y = x.clone();
        if matches!(start, Start::Carried) && !all.carrier.carry(&mut y, &free) {
            return None;
        }
        let bounds = around(&free, [x, &y], MARGIN * all.size);
        let others = shape.left.iter().copied();
        Some(Self {
            rows: triangles_at(triangulation, &free),
            detector: all.detector.within(all.ground, &bounds, x),
            near: all.surroundings.reach(&free),
            others: others
                .filter(|pair| !is_at(triangulation, patch, pair))
                .collect(),
            n_pairs: n_pairs(triangulation, patch, &shape.left),
            broken: &shape.broken,
            start: y,
            all,
            x,
            bounds,
            free,
            work: 0,
        })
    }

    /// What the patch comes to, near enough to the target and better than `best`; none where it does not.
    pub(super) fn candidate(&mut self, best: Option<&Candidate>) -> Option<Candidate> {
        let (all, x) = (self.all, self.x);
        let (mut y, left) = self.pulled_apart()?;
        if best.is_some_and(|best| best.left.len() < left.len()) {
            return None;
        }
        let is_hopeless =
            |case: &Self, y| all.excess(&case.rows, &case.free, [x, y]) > HOPELESS * all.limit;
        if !self.is_within_bounds(&y) || is_hopeless(self, &y) {
            return None;
        }
        self.give_back(&mut y, &left);
        let excess = all.excess(&self.rows, &self.free, [x, &y]);
        let is_better = |best: &Candidate| (left.len(), excess) < (best.left.len(), best.excess);
        let is_near = excess <= all.limit && self.is_within_bounds(&y);
        (is_near && best.is_none_or(is_better)).then_some(Candidate {
            positions: y,
            left,
            excess,
        })
    }

    fn is_within_bounds(&self, y: &Positions) -> bool {
        let Aabb { min, max } = self.bounds;
        let is_in = |v: &VertexId| (0..3).all(|k| (min[k]..=max[k]).contains(&y[*v][k]));
        self.free.iter().all(is_in)
    }

    /// What crosses at `y` and is no matter of another patch.
    fn crossings(&mut self, y: &Positions) -> Vec<[u32; 2]> {
        self.work += self.free.len();
        let mut pairs = self.detector.crossings(self.all.ground, y, &self.rows);
        pairs.retain(|pair| self.others.binary_search(pair).is_err());
        pairs
    }

    /// Vertices of what is folded or skinny at `y` and was not.
    fn newly_broken(&self, y: &Positions) -> Vec<VertexId> {
        let judge = self.all.judge;
        let broken = judge.broken_after(self.broken, y, &self.near);
        judge.vertices(&broken.without(self.broken))
    }

    /// The shape, of those that the patch goes through, in which least of it crosses and nothing is newly folded, with the
    /// pairs that cross there; none where that is not less than half of what crossed.
    fn pulled_apart(&mut self) -> Option<(Positions, Vec<[u32; 2]>)> {
        let all = self.all;
        let mut y = self.start.clone();
        let mut best = None;
        let (mut n_left, mut least, mut n_in_vain) = (self.n_pairs / 2 + 1, usize::MAX, 0);
        for turn in 1..=TURNS {
            let pairs = self.crossings(&y);
            let folded = self.newly_broken(&y);
            if folded.is_empty() && pairs.len() < n_left {
                n_left = pairs.len();
                best = Some((y.clone(), pairs.clone()));
            }
            n_in_vain += 1;
            let n_wrong = pairs.len() + folded.len();
            if n_wrong < least {
                (least, n_in_vain) = (n_wrong, 0);
            }
            if n_left == 0 || n_in_vain > PATIENCE {
                break;
            }
            shorten(all.ground.triangulation, &pairs, &mut y, &self.free);
            if turn % FLATTEN_EVERY == 0 {
                let rings = 1 + turn / (FLATTEN_EVERY * FLATTENINGS_PER_RING);
                self.flatten(&mut y, &folded, rings);
            }
            all.shape.relax(&mut y, &self.free);
        }
        best
    }

    /// Moves what is within so many rings of `folded` to the mean of its neighbours.
    fn flatten(&self, y: &mut Positions, folded: &[VertexId], rings: usize) {
        let triangulation = self.all.ground.triangulation;
        let mut around = grown(triangulation, folded, rings);
        around.retain(|v| self.free.binary_search(v).is_ok());
        for _ in 0..FLATTENINGS {
            flatten(triangulation, y, &around);
        }
    }

    /// Moves every vertex back towards where it was, and those that are stuck to the target, as far as nothing crosses but
    /// `left` and nothing folds.
    fn give_back(&mut self, y: &mut Positions, left: &[[u32; 2]]) {
        self.others.extend(left);
        self.others.sort_unstable();
        let mut shares = vec![RETURN; self.free.len()];
        for turn in 0..RETURNS {
            let mut moved = y.clone();
            for (&v, share) in self.free.iter().zip(&shares) {
                let stuck = (turn >= RETURNS / 2).then(|| self.place_of_stuck(v, &y[v]));
                let goal = stuck.flatten().unwrap_or(self.x[v]);
                moved[v] = y[v] + (goal - y[v]) * *share;
            }
            if self.settle(y, &mut moved, &mut shares) {
                for (&v, share) in self.free.iter().zip(&mut shares) {
                    if moved[v] != y[v] {
                        *share = (*share * 2.0).min(RETURN);
                    }
                }
                *y = moved;
            } else {
                shares.iter_mut().for_each(|share| *share *= 0.5);
            }
        }
    }

    /// Where on the target a vertex at `point` belongs that is attracted and far from it.
    fn place_of_stuck(&self, v: VertexId, point: &Point3) -> Option<Point3> {
        let fit = self.all.fit.filter(|fit| fit.attraction[v] > 0.0)?;
        let hit = fit.target.closest_point(point);
        let is_far = hit.distance_squared.sqrt() > STUCK * self.all.size;
        is_far.then_some(hit.point)
    }

    /// Takes back the moves of vertices that get in the way, until none does; they try half of it next time. Whether it
    /// comes to that.
    fn settle(&mut self, y: &Positions, moved: &mut Positions, shares: &mut [f64]) -> bool {
        for _ in 0..STAYS {
            let crossing = self.crossings(moved);
            let triangles = self.all.ground.triangulation.triangles();
            let corners = crossing.as_flattened().iter();
            let mut stay: Vec<VertexId> = corners.flat_map(|&t| triangles[t as usize]).collect();
            stay.extend(self.newly_broken(moved));
            if stay.is_empty() {
                return true;
            }
            stay.sort_unstable();
            stay.dedup();
            for v in stay {
                if let Ok(row) = self.free.binary_search(&v) {
                    if moved[v] != y[v] {
                        moved[v] = y[v];
                        shares[row] *= 0.5;
                    }
                }
            }
        }
        false
    }
}

/// The box around some vertices in two shapes, larger by `margin` on every side.
fn around(vertices: &[VertexId], shapes: [&Positions; 2], margin: f64) -> Aabb {
    let points = shapes.map(|x| vertices.iter().map(|&v| x[v]));
    let mut bounds = Aabb::of(&points.into_iter().flatten().collect::<Vec<_>>());
    bounds.min.iter_mut().for_each(|c| *c -= margin);
    bounds.max.iter_mut().for_each(|c| *c += margin);
    bounds
}
