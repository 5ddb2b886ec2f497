//! The last stage, second part: no surface runs through another that did not at rest.

mod carry;
mod crossing;
mod fit;
mod push;

use mesh_core::{Aabb, Positions, TriangleBvh, Triangulation, UnionFind, UnitFrame, VertexId};
use mesh_loss::LocalShape;

use crate::repair::{grown, Broken, Judge, Reach, Surroundings};
use carry::Carrier;
use crossing::triangles_at;
pub(crate) use crossing::{Detector, Ground};
pub(crate) use fit::Fit;
use push::push_apart;

/// A patch grows to so many rings around what crosses, one size after the other.
const RINGS: &[usize] = &[0, 1, 3, 7];
const WIDE_RINGS: &[usize] = &[0, 4, 12];
/// A patch where more pairs cross is left as it is: it does not come free without moving far.
const MAX_PAIRS: usize = 60;
/// Of the ways to free a patch the one is taken that moves no vertex far; others are tried until this share of the largest
/// motion is enough, ...
const ENOUGH: f64 = 0.16;
/// ... or a patch of so many rings came free.
const WIDE: usize = 4;
/// So often what crosses is pushed apart and the patch relaxed, for each size.
const TURNS: usize = 12;
/// So often a patch that came free is moved back towards where it was, ...
const RETURNS: usize = 30;
/// ... each vertex by this share of what is left at most: all at once, so that both sides of a contact give way.
const RETURN: f64 = 0.15;
/// What is farther than this share of the largest motion from where it was after half of the turns goes to the surface that
/// was there instead.
const STUCK: f64 = 0.055;
/// So often vertices that get in the way stay behind, before nothing moves back.
const STAYS: usize = 6;
/// What is farther from a patch than this share of the longest side cannot get in its way; no vertex is moved farther.
const MAX_MOTION: f64 = 0.03;

/// A shape without the crossings that could be taken out of it.
pub(crate) struct Untangled {
    pub(crate) positions: Positions,
    /// What is folded or skinny there.
    pub(crate) broken: Broken,
    /// The triangles that still cross and did not at rest: pairs of rows, the lower first, in order.
    pub(crate) left: Vec<[usize; 2]>,
}

/// The triangles that cross at `x` and did not at rest: pairs of rows, the lower first, in order.
pub(crate) fn crossings(
    triangulation: &Triangulation,
    rest: &Positions,
    x: &Positions,
) -> Vec<[usize; 2]> {
    let ground = Ground {
        triangulation,
        rest,
    };
    in_full(&Detector::new(ground, x).all_crossings(ground, x))
}

/// Where a surface goes that runs through itself, in the middle of a run.
pub(crate) fn parted(
    triangulation: &std::sync::Arc<Triangulation>,
    rest: &Positions,
    x: &Positions,
    held: &[VertexId],
) -> Positions {
    let judge = Judge::new(triangulation, rest);
    let broken = judge.broken(x);
    let mut held = held.to_vec();
    held.sort_unstable();
    untangle(&judge, (x.clone(), broken), &held, None).positions
}

fn in_full(pairs: &[[u32; 2]]) -> Vec<[usize; 2]> {
    pairs.iter().map(|pair| pair.map(|t| t as usize)).collect()
}

/// Takes crossings out of a shape, patch by patch: what crosses is pushed apart to the sides where it was at rest, while its
/// surroundings relax towards the shape that they had at rest, until nothing crosses; then every vertex goes back towards
/// where it was as far as nothing crosses or folds. So a patch moves no more than it must.
///
/// A patch that does not come free stays as it was. The vertices of `held`, in order, stay where they are.
pub(crate) fn untangle(
    judge: &Judge<'_>,
    (x, broken): (Positions, Broken),
    held: &[VertexId],
    fit: Option<Fit<'_>>,
) -> Untangled {
    let ground = Ground {
        triangulation: judge.triangulation(),
        rest: judge.rest(),
    };
    let triangulation = ground.triangulation;
    let mut detector = Detector::new(ground, &x);
    let mut left = detector.all_crossings(ground, &x);
    let (mut positions, mut broken) = (x, broken);
    if !left.is_empty() {
        let mut untangler = Untangler {
            ground,
            held,
            fit,
            detector,
            shape: LocalShape::new(triangulation, ground.rest),
            carrier: Carrier::new(triangulation, ground.rest),
            surroundings: Surroundings::new(judge),
            judge,
            limit: fit.as_ref().map_or(f64::INFINITY, |fit| fit.worst(&positions)),
            size: UnitFrame::principal(positions.as_slice()).scale,
            reach: param("MOTION", MAX_MOTION) * UnitFrame::principal(positions.as_slice()).scale,
        };
        for (apart, rings) in [(1, RINGS), (4, WIDE_RINGS)] {
            for patch in patches(triangulation, &left, apart) {
                let n = left.iter().filter(|pair| is_at(triangulation, &patch, pair)).count();
                let t = std::time::Instant::now();
                let free = untangler.freed(&positions, &patch, &left, &broken, rings);
                if verbose() {
                    eprintln!("\n== rings {rings:?}: {} vertices, {n} pairs, freed {} {:?}", patch.len(), free.is_some(), t.elapsed());
                }
                if let Some(free) = free {
                    (positions, broken) = free;
                }
            }
            left = untangler.detector.all_crossings(ground, &positions);
            if left.is_empty() {
                break;
            }
        }
    }
    Untangled {
        positions,
        broken,
        left: in_full(&left),
    }
}

fn verbose() -> bool {
    std::env::var("VERBOSE").is_ok()
}

fn param(name: &str, default: f64) -> f64 {
    std::env::var(name).map_or(default, |v| v.parse().unwrap_or(default))
}

/// Vertices within `rings` edges of the triangles that cross: those of each pair, and what touches, are one patch. Each
/// ascending.
fn patches(triangulation: &Triangulation, pairs: &[[u32; 2]], rings: usize) -> Vec<Vec<VertexId>> {
    let corners = |row: u32| triangulation.triangles()[row as usize];
    let mut sets = UnionFind::new(triangulation.n_vertices());
    let mut crossing = Vec::new();
    for &[one, two] in pairs {
        let (s, t) = (corners(one), corners(two));
        for v in s.into_iter().chain(t) {
            sets.union(s[0].index(), v.index());
            crossing.push(v);
        }
    }
    crossing.sort_unstable();
    crossing.dedup();
    let mut is_in = vec![false; triangulation.n_vertices()];
    for v in grown(triangulation, &crossing, rings) {
        is_in[v.index()] = true;
    }
    for [a, b] in triangulation.edges().iter().map(|e| e.map(VertexId::index)) {
        if is_in[a] && is_in[b] {
            sets.union(a, b);
        }
    }
    let rows = sets.sets(|row| is_in[row]);
    let ids = |rows: Vec<usize>| rows.into_iter().map(VertexId::new).collect();
    rows.into_iter().map(ids).collect()
}

/// Whether a pair of triangles is one of a patch.
fn is_at(triangulation: &Triangulation, patch: &[VertexId], pair: &[u32; 2]) -> bool {
    let v = triangulation.triangles()[pair[0] as usize][0];
    patch.binary_search(&v).is_ok()
}

/// Takes patches apart, one at a time.
struct Untangler<'a> {
    ground: Ground<'a>,
    held: &'a [VertexId],
    fit: Option<Fit<'a>>,
    /// Of all triangles.
    detector: Detector,
    shape: LocalShape,
    carrier: Carrier<'a>,
    judge: &'a Judge<'a>,
    surroundings: Surroundings<'a>,
    reach: f64,
    size: f64,
    limit: f64,
}

impl Untangler<'_> {
    /// The positions with a patch that does not cross any more, and what is folded or skinny then; none where it does not
    /// come free. `known` are the pairs that cross at `x`.
    fn freed(
        &self,
        x: &Positions,
        patch: &[VertexId],
        known: &[[u32; 2]],
        broken: &Broken,
        rings: &[usize],
    ) -> Option<(Positions, Broken)> {
        let mut best: Option<(f64, Positions)> = None;
        let good = param("GOOD", 0.005) * self.size;
        let limit = self.limit.clamp(param("GOOD", 0.005) * self.size, param("LIMIT", 0.01) * self.size);
        for &rings in rings {
            let mut case = Case::new(self, x, patch, known, broken, rings);
            for start in [Start::AsItIs, Start::Carried] {
                if verbose() {
                    eprint!("\n {rings} {start:?} {} free:", case.free.len());
                }
                let t = std::time::Instant::now();
                let Some(mut moved) = case.pulled_apart(start) else {
                    continue;
                };
                if verbose() { eprint!(" {:?}", t.elapsed()); }
                let t = std::time::Instant::now();
                if self.fit.is_none() {
                    let far = case.free.iter().map(|&v| (moved[v] - x[v]).norm());
                    let far = far.fold(0.0, f64::max);
                    if verbose() { eprint!(" far {:.4}", far / self.size); }
                    if far <= self.reach {
                        let broken = self.judge.broken(&moved);
                        return Some((moved, broken));
                    }
                    continue;
                }
                let before = self.fit.as_ref().map(|fit| fit.excess(self.ground, &case.rows, [x, &moved]));
                case.give_back(&mut moved);
                if verbose() { eprint!(" back {:?}", t.elapsed()); }
                let far = case.free.iter().map(|&v| (moved[v] - x[v]).norm());
                let far = far.fold(0.0, f64::max);
                let excess = self.fit.as_ref().map_or(far, |fit| fit.excess(self.ground, &case.rows, [x, &moved]));
                if verbose() {
                    eprint!(" far {:.4} excess {:.4} -> {:.4}", far / self.size, before.unwrap_or(0.0) / self.size, excess / self.size);
                }
                if far <= self.reach && best.as_ref().is_none_or(|(least, _)| excess < *least) {
                    best = Some((excess, moved));
                }
                if best.as_ref().is_some_and(|(least, _)| *least <= good) {
                    break;
                }
            }
            if best.as_ref().is_some_and(|(least, _)| *least <= good) {
                break;
            }
        }
        best.filter(|(least, _)| *least <= limit).map(|(_, moved)| {
            let broken = self.judge.broken(&moved);
            (moved, broken)
        })
    }
}

/// From where a patch is pulled apart.
#[derive(Clone, Copy, Debug)]
enum Start {
    /// From where it is.
    AsItIs,
    /// From where its surroundings carry it.
    Carried,
}

/// A patch with its surroundings up to a number of rings.
struct Case<'a, 'u> {
    all: &'u Untangler<'a>,
    /// Where everything was.
    x: &'u Positions,
    /// What may move, ascending.
    free: Vec<VertexId>,
    /// The triangles that it moves.
    rows: Vec<u32>,
    detector: Detector,
    near: Reach,
    /// What crosses elsewhere.
    others: Vec<[u32; 2]>,
    broken: &'u Broken,
    /// Vertices of what is folded or skinny already.
    is_broken: Vec<VertexId>,
}

impl<'a, 'u> Case<'a, 'u> {
    fn new(
        all: &'u Untangler<'a>,
        x: &'u Positions,
        patch: &[VertexId],
        known: &[[u32; 2]],
        broken: &'u Broken,
        rings: usize,
    ) -> Self {
        let mut free = grown(all.ground.triangulation, patch, rings);
        free.retain(|v| all.held.binary_search(v).is_err());
        let bounds = around(&free, x, all.reach);
        let others = known.iter().copied();
        let others = others.filter(|pair| !is_at(all.ground.triangulation, patch, pair));
        Self {
            rows: triangles_at(all.ground.triangulation, &free),
            detector: all.detector.within(all.ground, &bounds, x),
            near: all.surroundings.reach(&free),
            others: others.collect(),
            is_broken: all.judge.vertices(broken),
            all,
            x,
            free,
            broken,
        }
    }

    /// What crosses at `y` and is no matter of another patch.
    fn crossings(&mut self, y: &Positions) -> Vec<[u32; 2]> {
        let mut pairs = self.detector.crossings(self.all.ground, y, &self.rows);
        pairs.retain(|pair| self.others.binary_search(pair).is_err());
        pairs
    }

    /// Vertices of what is folded or skinny at `y` and was not.
    fn newly_broken(&self, y: &Positions) -> Vec<VertexId> {
        let judge = self.all.judge;
        let broken = judge.broken_after(self.broken, y, &self.near);
        let mut vertices = judge.vertices(&broken);
        vertices.retain(|v| self.is_broken.binary_search(v).is_err());
        vertices
    }

    /// Where nothing crosses and nothing is newly folded; none where it does not come to that.
    fn pulled_apart(&mut self, start: Start) -> Option<Positions> {
        let mut y = self.x.clone();
        let is_started = match start {
            Start::AsItIs => true,
            Start::Carried => {
                self.all.carrier.carry(&mut y, &self.free)
            }
        };
        (is_started && self.pull_apart(&mut y)).then_some(y)
    }

    /// Pushes and relaxes until nothing crosses and nothing is newly folded; whether it comes to that.
    fn pull_apart(&mut self, y: &mut Positions) -> bool {
        let (mut least, mut since) = (usize::MAX, 0);
        for _turn in 0..param("TURNS", TURNS as f64) as usize {
            let pairs = self.crossings(y);
            if std::env::var("VERBOSE2").is_ok() {
                let n = self.newly_broken(y).len();
                eprint!(" [{} {n}]", pairs.len());
            }
            let folded = self.newly_broken(y);
            let n = pairs.len() + folded.len();
            since += 1;
            if n < least {
                (least, since) = (n, 0);
            }
            if since > param("PATIENCE", 12.0) as usize {
                if verbose() { eprint!(" gave up at {_turn} with {n}, {least}"); }
                return false;
            }
            if n == 0 {
                if verbose() { eprint!(" {_turn} turns"); }
                return true;
            }
            push_apart(
                self.all.ground.triangulation,
                &pairs,
                y,
                &self.free,
            );
            let every = param("EVERY", 6.0) as usize;
            if _turn % every == every - 1 {
                let rings = 1 + _turn / every / 3;
                let mut folded = grown(self.all.ground.triangulation, &folded, rings);
                folded.retain(|v| self.free.binary_search(v).is_ok());
                for _ in 0..param("FLAT", 4.0) as usize {
                    flatten(self.all.ground.triangulation, y, &folded);
                }
            }
            for _ in 0..param("RELAX", 1.0) as usize {
                self.all.shape.relax(y, &self.free);
            }
        }
        false
    }

    /// Moves every vertex back towards where it was, as far as nothing crosses or folds.
    fn give_back(&mut self, y: &mut Positions) {
        let mut shares = vec![RETURN; self.free.len()];
        for turn in 0..RETURNS {
            let mut moved = y.clone();
            for (&v, share) in self.free.iter().zip(&shares) {
                let way = self.x[v] - y[v];
                moved[v] = y[v] + way * *share;
                if turn >= RETURNS / 2 {
                    if let Some(fit) = &self.all.fit {
                        let hit = fit.target.closest_point(&y[v]);
                        if hit.distance_squared.sqrt() > param("STUCK", 0.003) * self.all.size {
                            moved[v] = y[v] + (hit.point - y[v]) * *share;
                        }
                    }
                }
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

/// Moves each vertex once, in their order, to the mean of its neighbours.
fn flatten(triangulation: &Triangulation, x: &mut Positions, free: &[VertexId]) {
    for &v in free {
        let around = triangulation.vertex_neighbours(v);
        let sum: mesh_core::Vector3 = around.iter().map(|&w| x[w].coords).sum();
        if !around.is_empty() {
            x[v] = (sum / around.len() as f64).into();
        }
    }
}

/// The box around some vertices, larger by `margin` on every side.
fn around(vertices: &[VertexId], x: &Positions, margin: f64) -> Aabb {
    let points: Vec<_> = vertices.iter().map(|&v| x[v]).collect();
    let mut bounds = Aabb::of(&points);
    bounds.min.iter_mut().for_each(|c| *c -= margin);
    bounds.max.iter_mut().for_each(|c| *c += margin);
    bounds
}
